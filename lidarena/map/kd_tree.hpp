// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "lidarena/map/neighbor.hpp"

namespace lidarena::map {

/// A k-d tree of points (m) with insertion and removal that stays balanced, after Cai, Xu, Zhang,
/// "ikd-Tree: An Incremental K-D Tree for Robotic Applications" (arXiv 2102.10808): it downsamples
/// while inserting, removes boxes, and rebuilds a subtree as soon as that is out of balance or has
/// lost half of its points (scapegoat tree). Unlike in the ikd-Tree, points are stored in the
/// leaves, up to 16 each, so that removed points need no mark: until the next rebuild, a removal
/// leaves only splits that could be tighter and leaves with free slots. The calling thread rebuilds
/// in place. The result depends only on the order of the operations. Points must be finite.
class KdTree {
 public:
  struct Options {
    float balance = 0.7F;        ///< rebuild when a child has more than this share of the points
    float removed_share = 0.5F;  ///< rebuild when more than this share of the points is removed
  };
  KdTree() = default;
  explicit KdTree(const Options& options) : options_(options) {}

  /// Replaces all points.
  void build(std::vector<Eigen::Vector3f> points);
  void insert(const Eigen::Vector3f& point);
  /// Inserts with downsampling: of `point` and the points in its cell of a grid with voxel size
  /// `voxel` (m), keeps the one nearest to the cell's center and removes the others. True if that
  /// is `point`.
  bool insert_downsampled(const Eigen::Vector3f& point, float voxel);
  /// Removes the points in a closed box; returns how many.
  std::size_t remove(const Eigen::AlignedBox3f& box);
  void clear();

  /// Writes the points nearest to `query`, within `max_distance` (m), to `out`, nearest first, at
  /// most as many as it holds; returns how many were found.
  std::size_t nearest(const Eigen::Vector3f& query, std::span<Neighbor> out,
                      float max_distance = std::numeric_limits<float>::infinity()) const;
  /// Appends the points in a closed box.
  void collect(const Eigen::AlignedBox3f& box, std::vector<Eigen::Vector3f>& out) const;
  std::vector<Eigen::Vector3f> points() const;

  std::size_t size() const { return size_of(root_); }
  bool empty() const { return size() == 0; }
  /// Nodes on the longest path from the root to a leaf, both counted.
  std::size_t depth() const { return depth(root_); }
  std::uint64_t memory_bytes() const;

 private:
  /// Index of a split, or of a leaf if kLeafBit is set.
  using Index = std::uint32_t;
  static constexpr Index kNone = std::numeric_limits<Index>::max();
  static constexpr Index kLeafBit = Index{1} << 31U;
  static constexpr std::uint32_t kLeafSize = 16;

  struct Split {
    float low = 0.0F;   ///< upper bound of coordinates on the left side
    float high = 0.0F;  ///< lower bound of those on the right side; low <= high
    Index left = kNone;
    Index right = kNone;
    std::uint32_t size = 0;  ///< number of points below
    std::uint32_t peak = 0;  ///< largest size since it was built
    std::int32_t axis = 0;
  };
  struct Leaf {
    std::array<std::array<float, kLeafSize>, 3> coordinates;  ///< by axis
    std::uint32_t count = 0;
    Eigen::Vector3f point(std::uint32_t i) const {
      return {coordinates[0][i], coordinates[1][i], coordinates[2][i]};
    }
    void add(const Eigen::Vector3f& p) {
      coordinates[0][count] = p.x();
      coordinates[1][count] = p.y();
      coordinates[2][count] = p.z();
      ++count;
    }
  };
  struct Search;

  static bool is_leaf(Index node) { return (node & kLeafBit) != 0; }
  Leaf& leaf(Index node) { return leaves_[node & ~kLeafBit]; }
  const Leaf& leaf(Index node) const { return leaves_[node & ~kLeafBit]; }
  std::uint32_t size_of(Index node) const;
  template <class Node>
  static Index allocate(std::vector<Node>& nodes, std::vector<Index>& free);
  void release(Index node);
  bool is_unbalanced(std::uint32_t larger, std::uint32_t size) const;
  Index build(std::span<Eigen::Vector3f> points);
  Index rebuilt(Index node, const Eigen::Vector3f* added);
  Index insert(Index node, const Eigen::Vector3f& point);
  Index remove(Index node, const Eigen::AlignedBox3f& box, const Eigen::AlignedBox3f& bounds);
  Index remove_from_leaf(Index leaf, const Eigen::AlignedBox3f& box);
  template <class Visit>
  void visit(Index node, const Eigen::AlignedBox3f& box, const Visit& visit_point) const;
  void search(Index node, Search& query) const;
  std::size_t depth(Index node) const;

  Options options_;
  std::vector<Split> splits_;
  std::vector<Leaf> leaves_;
  std::vector<Index> free_splits_;
  std::vector<Index> free_leaves_;
  std::vector<Eigen::Vector3f> scratch_;  ///< points of a subtree being rebuilt
  Eigen::AlignedBox3f bounds_;  ///< box around all points since clear(), removed ones included
  Index root_ = kNone;
};

}  // namespace lidarena::map
