// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace lidarena {

/// A point of the tree and its squared distance (m^2) to the query.
struct Neighbour {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();
  float squared_distance = std::numeric_limits<float>::infinity();
};

/// A k-d tree of points (m) that grows, shrinks and stays balanced, after Cai, Xu, Zhang,
/// "ikd-Tree: An Incremental K-D Tree for Robotic Applications" (arXiv 2102.10808). A removed point
/// stays as a label until its subtree is rebuilt; a subtree is rebuilt as soon as it leans or half
/// of it is labels (scapegoat tree). Unlike there, a subtree that a box covers whole is given back
/// at once, which costs no more than its insertion did and needs no labels to push down; and
/// rebuilding is done in place, by the thread that inserts. Depends on the order of the operations
/// alone. Points must be finite.
class KdTree {
 public:
  struct Options {
    float balance = 0.6F;        ///< rebuild when one child has more of a subtree than this share
    float removed_share = 0.5F;  ///< rebuild when more of a subtree than this is labels
    std::uint32_t small = 10;    ///< subtrees up to this size are left alone
  };
  KdTree() = default;
  explicit KdTree(const Options& options) : options_(options) {}

  /// Replaces everything.
  void build(std::vector<Eigen::Vector3f> points);
  void insert(const Eigen::Vector3f& point);
  /// Of the points in the cell of a grid with edge `voxel` and of `point`, keeps the one nearest to
  /// the cell's centre and removes the others. True when that is `point`.
  bool insert_thinned(const Eigen::Vector3f& point, float voxel);
  /// Removes the points in a closed box; returns how many.
  std::size_t remove(const Eigen::AlignedBox3f& box);
  void clear();

  /// The nearest points within `max_distance` of `query`, nearest first, as many as `out` holds;
  /// returns how many were found.
  std::size_t nearest(const Eigen::Vector3f& query, std::span<Neighbour> out,
                      float max_distance = std::numeric_limits<float>::infinity()) const;
  /// Appends the points in a closed box.
  void collect(const Eigen::AlignedBox3f& box, std::vector<Eigen::Vector3f>& out) const;
  std::vector<Eigen::Vector3f> points() const;

  std::size_t size() const { return root_ == kNone ? 0 : valid(root_); }
  bool empty() const { return size() == 0; }
  std::size_t depth() const { return depth(root_); }
  std::uint64_t memory_bytes() const;

 private:
  using Index = std::uint32_t;
  static constexpr Index kNone = std::numeric_limits<Index>::max();

  struct Node {
    Eigen::Vector3f point;
    Eigen::AlignedBox3f box;  ///< around the subtree's points that are not removed
    Index left = kNone;       ///< smaller along the axis, on which equal ones may lie anywhere
    Index right = kNone;
    std::uint32_t size = 1;    ///< nodes of the subtree
    std::uint32_t labels = 0;  ///< of these, removed
    std::uint8_t axis = 0;
    bool removed = false;
  };

  std::uint32_t valid(Index node) const { return nodes_[node].size - nodes_[node].labels; }
  Index allocate(const Eigen::Vector3f& point, std::uint8_t axis);
  void release(Index subtree);
  void pull_up(Index node);
  bool leans(Index node) const;
  Index balanced(Index node);
  Index rebuilt(Index node);
  Index build(std::span<Eigen::Vector3f> points);
  Index insert(Index node, const Eigen::Vector3f& point, std::uint8_t axis);
  Index remove(Index node, const Eigen::AlignedBox3f& box, std::size_t& count);
  template <class Visit>
  void visit(Index node, const Eigen::AlignedBox3f& box, const Visit& visit_point) const;
  void search(Index node, const Eigen::Vector3f& query, std::span<Neighbour> best,
              std::size_t& count) const;
  std::size_t depth(Index node) const;

  Options options_;
  std::vector<Node> nodes_;
  std::vector<Index> free_;
  std::vector<Eigen::Vector3f> scratch_;  ///< points of a subtree that is rebuilt
  Index root_ = kNone;
};

}  // namespace lidarena
