// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/kd_tree.hpp"

#include <algorithm>
#include <cmath>

namespace lidarena::map {

/// State of a nearest-neighbor search: the best points so far, sorted. Points farther away than the
/// last entry are discarded.
struct KdTree::Search {
  Eigen::Vector3f query;
  std::span<Neighbor> best;
  std::size_t count = 0;
  /// Squared distance from the query to the region being searched, per axis.
  std::array<float, 3> away{};

  float bound() const { return best.back().squared_distance; }
  void offer(const Leaf& leaf);
  void keep(const Eigen::Vector3f& point, float squared);
};

void KdTree::Search::keep(const Eigen::Vector3f& point, float squared) {
  std::size_t place = std::min(count, best.size() - 1);
  for (; place > 0 && best[place - 1].squared_distance > squared; --place) {
    best[place] = best[place - 1];
  }
  best[place] = {point, squared};
  count = std::min(count + 1, best.size());
}

void KdTree::Search::offer(const Leaf& leaf) {
  std::array<float, kLeafSize> squared;
  const auto& [x, y, z] = leaf.coordinates;
  for (std::size_t i = 0; i < kLeafSize; ++i) {  // all slots, used or not: no branch
    const float dx = x[i] - query.x();
    const float dy = y[i] - query.y();
    const float dz = z[i] - query.z();
    squared[i] = dx * dx + (dy * dy + dz * dz);
  }
  constexpr std::uint32_t kGroup = 4;  // most groups have no point that is near enough
  for (std::uint32_t first = 0; first < leaf.count; first += kGroup) {
    const float* const group = squared.data() + first;
    if (!(std::min(std::min(group[0], group[1]), std::min(group[2], group[3])) < bound())) continue;
    const std::uint32_t end = std::min(first + kGroup, leaf.count);
    for (std::uint32_t i = first; i < end; ++i) {
      if (squared[i] < bound()) keep(leaf.point(i), squared[i]);
    }
  }
}

void KdTree::build(std::vector<Eigen::Vector3f> points) {
  clear();
  for (const Eigen::Vector3f& point : points) bounds_.extend(point);
  if (!points.empty()) root_ = build(std::span(points));
}

void KdTree::clear() {
  splits_.clear();
  leaves_.clear();
  free_splits_.clear();
  free_leaves_.clear();
  bounds_.setEmpty();
  root_ = kNone;
}

void KdTree::insert(const Eigen::Vector3f& point) {
  bounds_.extend(point);
  if (root_ == kNone) root_ = allocate(leaves_, free_leaves_) | kLeafBit;
  root_ = insert(root_, point);
}

bool KdTree::insert_downsampled(const Eigen::Vector3f& point, float voxel) {
  const Eigen::Vector3f corner = (point / voxel).array().floor() * voxel;
  // The upper faces belong to the next cell.
  const Eigen::Vector3f last = (corner.array() + voxel).unaryExpr([](float x) {
    return std::nextafter(x, -std::numeric_limits<float>::infinity());
  });
  const Eigen::AlignedBox3f cell(corner.cwiseMin(point), last.cwiseMax(point));
  const Eigen::Vector3f center = corner.array() + 0.5F * voxel;
  Eigen::Vector3f winner = point;
  float smallest = (point - center).squaredNorm();
  bool is_new = true;
  std::size_t others = 0;
  visit(root_, cell, [&](const Eigen::Vector3f& other) {
    ++others;
    const float squared = (other - center).squaredNorm();
    if (squared > smallest) return;
    smallest = squared;
    winner = other;
    is_new = false;
  });
  if (others == 1 && !is_new) return false;
  if (others > 0) remove(cell);
  insert(winner);
  return is_new;
}

std::size_t KdTree::remove(const Eigen::AlignedBox3f& box) {
  const std::size_t before = size();
  root_ = remove(root_, box, bounds_);
  return before - size();
}

std::uint32_t KdTree::size_of(Index node) const {
  if (node == kNone) return 0;
  return is_leaf(node) ? leaf(node).count : splits_[node].size;
}

template <class Node>
KdTree::Index KdTree::allocate(std::vector<Node>& nodes, std::vector<Index>& free) {
  if (free.empty()) {
    nodes.emplace_back();
    return static_cast<Index>(nodes.size() - 1);
  }
  const Index index = free.back();
  free.pop_back();
  nodes[index] = Node{};
  return index;
}

void KdTree::release(Index node) {
  if (node == kNone) return;
  if (is_leaf(node)) {
    free_leaves_.push_back(node & ~kLeafBit);
    return;
  }
  release(splits_[node].left);
  release(splits_[node].right);
  free_splits_.push_back(node);
}

/// Whether a subtree with a child of `larger` points is out of balance. Small subtrees are exempt:
/// they cannot be balanced to better than a leaf or two.
bool KdTree::is_unbalanced(std::uint32_t larger, std::uint32_t size) const {
  return size > 4 * kLeafSize &&
         static_cast<float>(larger) > options_.balance * static_cast<float>(size);
}

/// Splits at the median along the longest side of the points' bounding box, then both halves
/// likewise.
KdTree::Index KdTree::build(std::span<Eigen::Vector3f> points) {
  if (points.size() <= kLeafSize) {
    const Index index = allocate(leaves_, free_leaves_);
    for (const Eigen::Vector3f& point : points) leaves_[index].add(point);
    return index | kLeafBit;
  }
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : points) box.extend(point);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::size_t middle = points.size() / 2;
  std::nth_element(
      points.begin(), points.begin() + static_cast<std::ptrdiff_t>(middle), points.end(),
      [axis](const Eigen::Vector3f& a, const Eigen::Vector3f& b) { return a[axis] < b[axis]; });
  Split split;
  split.axis = static_cast<std::int32_t>(axis);
  split.high = points[middle][axis];
  split.low = points[0][axis];
  for (const Eigen::Vector3f& p : points.first(middle)) split.low = std::max(split.low, p[axis]);
  split.size = split.peak = static_cast<std::uint32_t>(points.size());
  split.left = build(points.first(middle));
  split.right = build(points.subspan(middle));
  const Index index = allocate(splits_, free_splits_);
  splits_[index] = split;
  return index;
}

KdTree::Index KdTree::rebuilt(Index node, const Eigen::Vector3f* added) {
  scratch_.clear();
  visit(node, bounds_, [&](const Eigen::Vector3f& point) { scratch_.push_back(point); });
  if (added != nullptr) scratch_.push_back(*added);
  release(node);
  return build(std::span(scratch_));
}

KdTree::Index KdTree::insert(Index node, const Eigen::Vector3f& point) {
  if (is_leaf(node)) {
    if (leaf(node).count == kLeafSize) return rebuilt(node, &point);
    leaf(node).add(point);
    return node;
  }
  Split& split = splits_[node];
  const float x = point[split.axis];
  const bool left = x - split.low < split.high - x;  // the nearer side gets the point
  const Index child = left ? split.left : split.right;
  // The topmost subtree that would be out of balance is rebuilt, including the point.
  if (is_unbalanced(size_of(child) + 1, split.size + 1)) return rebuilt(node, &point);
  split.peak = std::max(split.peak, ++split.size);
  if (left) {
    split.low = std::max(split.low, x);
  } else {
    split.high = std::min(split.high, x);
  }
  const Index grown = insert(child, point);
  (left ? splits_[node].left : splits_[node].right) = grown;
  return node;
}

/// Removes the points of a leaf that lie in the box; returns kNone if none is left.
KdTree::Index KdTree::remove_from_leaf(Index node, const Eigen::AlignedBox3f& box) {
  Leaf& points = leaf(node);
  const Leaf before = points;
  points.count = 0;
  for (std::uint32_t i = 0; i < before.count; ++i) {
    const Eigen::Vector3f point = before.point(i);
    if (!box.contains(point)) points.add(point);
  }
  if (points.count > 0) return node;
  release(node);
  return kNone;
}

/// `bounds`: box around all points of the subtree.
KdTree::Index KdTree::remove(Index node, const Eigen::AlignedBox3f& box,
                             const Eigen::AlignedBox3f& bounds) {
  if (node == kNone || !box.intersects(bounds)) return node;
  if (box.contains(bounds)) {
    release(node);
    return kNone;
  }
  if (is_leaf(node)) return remove_from_leaf(node, box);
  const Split split = splits_[node];
  Eigen::AlignedBox3f lower = bounds;
  Eigen::AlignedBox3f upper = bounds;
  lower.max()[split.axis] = split.low;
  upper.min()[split.axis] = split.high;
  const Index left = remove(split.left, box, lower);
  const Index right = remove(split.right, box, upper);
  if (left == kNone || right == kNone) {  // one child is left: no split is needed
    free_splits_.push_back(node);
    return left == kNone ? right : left;
  }
  Split& changed = splits_[node];
  changed.left = left;
  changed.right = right;
  changed.size = size_of(left) + size_of(right);
  const bool hollow = static_cast<float>(changed.size) <
                      (1.0F - options_.removed_share) * static_cast<float>(changed.peak);
  const std::uint32_t larger = std::max(size_of(left), size_of(right));
  return hollow || is_unbalanced(larger, changed.size) ? rebuilt(node, nullptr) : node;
}

template <class Visit>
void KdTree::visit(Index node, const Eigen::AlignedBox3f& box, const Visit& visit_point) const {
  if (node == kNone) return;
  if (is_leaf(node)) {
    const Leaf& points = leaf(node);
    for (std::uint32_t i = 0; i < points.count; ++i) {
      const Eigen::Vector3f point = points.point(i);
      if (box.contains(point)) visit_point(point);
    }
    return;
  }
  const Split& split = splits_[node];
  if (box.min()[split.axis] <= split.low) visit(split.left, box, visit_point);
  if (box.max()[split.axis] >= split.high) visit(split.right, box, visit_point);
}

std::size_t KdTree::nearest(const Eigen::Vector3f& query, std::span<Neighbor> out,
                            float max_distance) const {
  if (out.empty() || root_ == kNone) return 0;
  const float bound = max_distance * max_distance;
  std::fill(out.begin(), out.end(), Neighbor{Eigen::Vector3f::Zero(), bound});
  Search state{query, out, 0, {}};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const float outside =
        std::max({bounds_.min()[axis] - query[axis], query[axis] - bounds_.max()[axis], 0.0F});
    state.away[static_cast<std::size_t>(axis)] = outside * outside;
  }
  search(root_, state);
  return state.count;
}

/// Searches the nearer side first, the other only if it can contain a nearer point (Arya, Mount,
/// "Algorithms for fast vector quantization", 1993: distances to regions by axis).
void KdTree::search(Index node, Search& state) const {
  if (is_leaf(node)) {
    state.offer(leaf(node));
    return;
  }
  const Split& split = splits_[node];
  const float x = state.query[split.axis];
  const float over_low = x - split.low;
  const float under_high = split.high - x;
  const bool left_first = over_low < under_high;
  search(left_first ? split.left : split.right, state);

  const float gap = left_first ? under_high : over_low;
  float& away = state.away[static_cast<std::size_t>(split.axis)];
  const float before = away;
  away = std::max(before, gap * gap);
  // Rounding errors of the sum must not exclude a point.
  constexpr float kRounding = 1.0F - 1e-6F;
  if (kRounding * (state.away[0] + state.away[1] + state.away[2]) < state.bound()) {
    search(left_first ? split.right : split.left, state);
  }
  away = before;
}

void KdTree::collect(const Eigen::AlignedBox3f& box, std::vector<Eigen::Vector3f>& out) const {
  visit(root_, box, [&](const Eigen::Vector3f& point) { out.push_back(point); });
}

std::vector<Eigen::Vector3f> KdTree::points() const {
  std::vector<Eigen::Vector3f> all;
  all.reserve(size());
  collect(bounds_, all);
  return all;
}

std::size_t KdTree::depth(Index node) const {
  if (node == kNone) return 0;
  if (is_leaf(node)) return 1;
  return 1 + std::max(depth(splits_[node].left), depth(splits_[node].right));
}

std::uint64_t KdTree::memory_bytes() const {
  return splits_.capacity() * sizeof(Split) + leaves_.capacity() * sizeof(Leaf) +
         (free_splits_.capacity() + free_leaves_.capacity()) * sizeof(Index) +
         scratch_.capacity() * sizeof(Eigen::Vector3f);
}

}  // namespace lidarena::map
