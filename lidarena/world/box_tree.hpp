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

namespace lidarena::world {

/// Ray-box intersection test (slab method); what depends on the ray alone is precomputed.
struct BoxTest {
  Eigen::Vector3d origin, inverse;
  std::array<bool, 3> backwards;

  BoxTest(const Eigen::Vector3d& centered, const Eigen::Vector3d& direction) : origin(centered) {
    constexpr double kParallel = 1e-30;  // replaces zero, which would give 0 * infinity
    for (int axis = 0; axis < 3; ++axis) {
      const double size = std::max(std::abs(direction[axis]), kParallel);
      inverse[axis] = 1.0 / std::copysign(size, direction[axis]);
      backwards[axis] = direction[axis] < 0.0 || inverse[axis] < 0.0;
    }
  }

  /// Range at which the ray enters the box, limited to [near, far]; infinity when it misses the
  /// box within these limits.
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

/// A binary bounding volume hierarchy over boxes, built by the binned surface area heuristic
/// (Wald, "On fast construction of SAH-based bounding volume hierarchies", 2007) and traversed
/// with a small stack. The same boxes give the same tree.
class BoxTree {
 public:
  /// A leaf (`count` > 0: `count` members from index `first` on) or an inner node (`count` = 0: its
  /// children are the nodes `first` and `first` + 1).
  struct Node {
    Eigen::AlignedBox3f box;
    std::uint32_t first = 0;  ///< index of the first member or child
    std::uint32_t count = 0;
  };

  /// `boxes`: one box per member; at least one.
  explicit BoxTree(std::span<const Eigen::AlignedBox3f> boxes);
  /// Updates the boxes of the nodes after members have moved; the structure of the tree is kept.
  void refit(std::span<const Eigen::AlignedBox3f> boxes);

  /// Calls `on_hit(member)` for every member of a leaf whose box the ray enters between the ranges
  /// `near` and `far`, roughly in order of range. `on_hit` may reduce `far` to end the search
  /// sooner.
  template <typename OnHit>
  void walk(const BoxTest& ray, double near, const double& far, const OnHit& on_hit) const {
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
      for (std::uint32_t i = node->first; i < node->first + node->count; ++i) on_hit(members_[i]);
    }
  }

  /// Calls `visit(member)` for every member of a leaf whose box is within sqrt(`reach2`) of the
  /// point. Each call returns the new value of `reach2`.
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

  /// Down to this depth nodes are split by the surface area heuristic; deeper ones are split into
  /// halves of equal count, which bounds the depth of the tree.
  static constexpr std::size_t kSahDepth = 48;
  static constexpr std::size_t kMaxDepth = kSahDepth + 32;

 private:
  /// Nodes still to be visited, each with the distance to its box.
  class Stack {
   public:
    bool empty() const { return size_ == 0; }
    void push(const Node* node, double near) { entries_[size_++] = {node, near}; }
    std::pair<const Node*, double> pop() { return entries_[--size_]; }
    /// Pushes both nodes so that the nearer one is popped first; skips those at infinity.
    void push_both(const Node* a, double near_a, const Node* b, double near_b) {
      if (near_a <= near_b) {
        std::swap(a, b);
        std::swap(near_a, near_b);
      }
      if (near_a < std::numeric_limits<double>::infinity()) push(a, near_a);
      if (near_b < std::numeric_limits<double>::infinity()) push(b, near_b);
    }

   private:
    std::array<std::pair<const Node*, double>, kMaxDepth + 2> entries_;
    std::size_t size_ = 0;
  };

  std::vector<Node> nodes_;             ///< the root first; children after their parents
  std::vector<std::uint32_t> members_;  ///< in the order of the leaves
};

}  // namespace lidarena::world
