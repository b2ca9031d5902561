// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace lidarena {

/// A ray against boxes: for each axis the near and the far side are known beforehand.
struct BoxTest {
  Eigen::Vector3d origin, inverse;
  std::array<bool, 3> backwards;

  BoxTest(const Eigen::Vector3d& centered, const Eigen::Vector3d& direction) : origin(centered) {
    constexpr double kParallel = 1e-30;  // a zero would make 0 * infinity of a box's side
    for (int axis = 0; axis < 3; ++axis) {
      const double size = std::max(std::abs(direction[axis]), kParallel);
      inverse[axis] = 1.0 / std::copysign(size, direction[axis]);
      backwards[axis] = direction[axis] < 0.0 || inverse[axis] < 0.0;
    }
  }

  /// Where the ray enters the box between `near` and `far`; infinity when it does not.
  double entry(const Eigen::AlignedBox3f& box, double near, double far) const {
    for (int axis = 0; axis < 3; ++axis) {
      const double low = (double{box.min()[axis]} - origin[axis]) * inverse[axis];
      const double high = (double{box.max()[axis]} - origin[axis]) * inverse[axis];
      near = std::max(near, backwards[axis] ? high : low);
      far = std::min(far, backwards[axis] ? low : high);
    }
    return near <= far ? near : std::numeric_limits<double>::infinity();
  }
};

/// A binary tree over boxes, split where the surface area heuristic finds it cheapest among bins
/// (Wald, "On fast construction of SAH-based bounding volume hierarchies", 2007), walked with a
/// small stack. The same boxes give the same tree.
class BoxTree {
 public:
  /// A box and what is in it.
  struct Node {
    Eigen::AlignedBox3f box;
    std::uint32_t first = 0;  ///< of `count` members, or of two neighboring nodes when 0
    std::uint32_t count = 0;
  };

  /// `boxes`: one for each member, at least one.
  explicit BoxTree(std::span<const Eigen::AlignedBox3f> boxes);
  /// The same tree around members that have moved.
  void refit(std::span<const Eigen::AlignedBox3f> boxes);

  /// Calls `meet(member)` for those whose leaf the ray enters between `near` and `far`, which
  /// `meet` may bring nearer, roughly from near to far.
  template <typename Meet>
  void walk(const BoxTest& ray, double near, const double& far, const Meet& meet) const {
    Stack stack;
    stack.push(nodes_.data(), ray.entry(nodes_[0].box, near, far));
    while (!stack.empty()) {
      const auto [node, entry] = stack.pop();
      if (!(entry <= far)) continue;
      if (node->count == 0) {
        const Node* child = &nodes_[node->first];
        stack.push_both(child, ray.entry(child[0].box, near, far),  //
                        child + 1, ray.entry(child[1].box, near, far));
        continue;
      }
      for (std::uint32_t i = node->first; i < node->first + node->count; ++i) meet(members_[i]);
    }
  }

  /// Calls `visit(member)` for those whose leaf is within sqrt(`reach2`) of the point; `reach2` is
  /// then what it returns.
  template <typename Visit>
  void visit_near(const Eigen::Vector3d& point, double reach2, const Visit& visit) const {
    const auto distance2 = [&](const Node& node) {
      return node.box.cast<double>().squaredExteriorDistance(point);
    };
    Stack stack;
    stack.push(nodes_.data(), distance2(nodes_[0]));
    while (!stack.empty()) {
      const auto [node, near2] = stack.pop();
      if (near2 > reach2) continue;
      if (node->count == 0) {
        const Node* child = &nodes_[node->first];
        stack.push_both(child, distance2(child[0]), child + 1, distance2(child[1]));
        continue;
      }
      for (std::uint32_t i = node->first; i < node->first + node->count; ++i) {
        reach2 = visit(members_[i]);
      }
    }
  }

  static constexpr std::size_t kCheapestDepth = 48;  ///< below, halves: then the depth is bounded
  static constexpr std::size_t kMostDepth = kCheapestDepth + 32;

 private:
  /// Nodes still to be looked into, each with how far away it begins.
  class Stack {
   public:
    bool empty() const { return size_ == 0; }
    void push(const Node* node, double near) { entries_[size_++] = {node, near}; }
    std::pair<const Node*, double> pop() { return entries_[--size_]; }
    /// The nearer of two comes to lie on top.
    void push_both(const Node* a, double near_a, const Node* b, double near_b) {
      if (near_a <= near_b) {
        std::swap(a, b);
        std::swap(near_a, near_b);
      }
      if (near_a < std::numeric_limits<double>::infinity()) push(a, near_a);
      if (near_b < std::numeric_limits<double>::infinity()) push(b, near_b);
    }

   private:
    std::array<std::pair<const Node*, double>, kMostDepth + 2> entries_;
    std::size_t size_ = 0;
  };

  std::vector<Node> nodes_;             ///< the root first; children behind their parents
  std::vector<std::uint32_t> members_;  ///< in the order of the leaves
};

}  // namespace lidarena
