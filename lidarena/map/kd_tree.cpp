// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/kd_tree.hpp"

#include <algorithm>
#include <cmath>

namespace lidarena {

void KdTree::build(std::vector<Eigen::Vector3f> points) {
  clear();
  nodes_.reserve(points.size());
  root_ = build(std::span(points));
}

void KdTree::clear() {
  nodes_.clear();
  free_.clear();
  root_ = kNone;
}

void KdTree::insert(const Eigen::Vector3f& point) { root_ = insert(root_, point, 0); }

bool KdTree::insert_thinned(const Eigen::Vector3f& point, float voxel) {
  const Eigen::Vector3f corner = (point / voxel).array().floor() * voxel;
  // The upper faces belong to the next cell.
  const Eigen::Vector3f last = (corner.array() + voxel).unaryExpr([](float x) {
    return std::nextafter(x, -std::numeric_limits<float>::infinity());
  });
  const Eigen::AlignedBox3f cell(corner.cwiseMin(point), last.cwiseMax(point));
  const Eigen::Vector3f centre = corner.array() + 0.5F * voxel;
  Eigen::Vector3f winner = point;
  float smallest = (point - centre).squaredNorm();
  bool is_new = true;
  std::size_t others = 0;
  visit(root_, cell, [&](const Eigen::Vector3f& other) {
    ++others;
    const float squared = (other - centre).squaredNorm();
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
  std::size_t count = 0;
  root_ = remove(root_, box, count);
  return count;
}

KdTree::Index KdTree::allocate(const Eigen::Vector3f& point, std::uint8_t axis) {
  Node node;
  node.point = point;
  node.box = Eigen::AlignedBox3f(point);
  node.axis = axis;
  if (free_.empty()) {
    nodes_.push_back(node);
    return static_cast<Index>(nodes_.size() - 1);
  }
  const Index index = free_.back();
  free_.pop_back();
  nodes_[index] = node;
  return index;
}

void KdTree::release(Index subtree) {
  if (subtree == kNone) return;
  release(nodes_[subtree].left);
  release(nodes_[subtree].right);
  free_.push_back(subtree);
}

/// Brings a node's counts and box in step with its children's.
void KdTree::pull_up(Index index) {
  Node& node = nodes_[index];
  node.size = 1;
  node.labels = node.removed ? 1 : 0;
  node.box = node.removed ? Eigen::AlignedBox3f() : Eigen::AlignedBox3f(node.point);
  for (const Index child : {node.left, node.right}) {
    if (child == kNone) continue;
    node.size += nodes_[child].size;
    node.labels += nodes_[child].labels;
    node.box.extend(nodes_[child].box);
  }
}

bool KdTree::leans(Index index) const {
  const Node& node = nodes_[index];
  if (node.size <= options_.small) return node.labels == node.size;
  std::uint32_t larger = 0;
  for (const Index child : {node.left, node.right}) {
    if (child != kNone) larger = std::max(larger, nodes_[child].size);
  }
  const auto size = static_cast<float>(node.size);
  return static_cast<float>(larger) > options_.balance * (size - 1.0F) ||
         static_cast<float>(node.labels) > options_.removed_share * size;
}

KdTree::Index KdTree::balanced(Index node) { return leans(node) ? rebuilt(node) : node; }

KdTree::Index KdTree::rebuilt(Index node) {
  scratch_.clear();
  visit(node, nodes_[node].box, [&](const Eigen::Vector3f& point) { scratch_.push_back(point); });
  release(node);
  return build(std::span(scratch_));
}

/// Median along the longest side of the points' box, then both halves likewise.
KdTree::Index KdTree::build(std::span<Eigen::Vector3f> points) {
  if (points.empty()) return kNone;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : points) box.extend(point);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::size_t middle = points.size() / 2;
  std::nth_element(
      points.begin(), points.begin() + static_cast<std::ptrdiff_t>(middle), points.end(),
      [axis](const Eigen::Vector3f& a, const Eigen::Vector3f& b) { return a[axis] < b[axis]; });
  const Index node = allocate(points[middle], static_cast<std::uint8_t>(axis));
  const Index left = build(points.first(middle));
  const Index right = build(points.subspan(middle + 1));
  nodes_[node].left = left;
  nodes_[node].right = right;
  pull_up(node);
  return node;
}

KdTree::Index KdTree::insert(Index node, const Eigen::Vector3f& point, std::uint8_t axis) {
  if (node == kNone) return allocate(point, axis);
  const std::uint8_t own = nodes_[node].axis;
  const bool smaller = point[own] < nodes_[node].point[own];
  const Index child = insert(smaller ? nodes_[node].left : nodes_[node].right, point,
                             static_cast<std::uint8_t>((own + 1) % 3));
  (smaller ? nodes_[node].left : nodes_[node].right) = child;
  pull_up(node);
  return balanced(node);
}

KdTree::Index KdTree::remove(Index node, const Eigen::AlignedBox3f& box, std::size_t& count) {
  if (node == kNone || !box.intersects(nodes_[node].box)) return node;
  if (box.contains(nodes_[node].box)) {
    count += valid(node);
    release(node);
    return kNone;
  }
  if (!nodes_[node].removed && box.contains(nodes_[node].point)) {
    nodes_[node].removed = true;
    ++count;
  }
  const Index left = remove(nodes_[node].left, box, count);
  const Index right = remove(nodes_[node].right, box, count);
  nodes_[node].left = left;
  nodes_[node].right = right;
  pull_up(node);
  return balanced(node);
}

template <class Visit>
void KdTree::visit(Index index, const Eigen::AlignedBox3f& box, const Visit& visit_point) const {
  if (index == kNone || !box.intersects(nodes_[index].box)) return;
  const Node& node = nodes_[index];
  if (!node.removed && box.contains(node.point)) visit_point(node.point);
  visit(node.left, box, visit_point);
  visit(node.right, box, visit_point);
}

std::size_t KdTree::nearest(const Eigen::Vector3f& query, std::span<Neighbour> out,
                            float max_distance) const {
  if (out.empty() || root_ == kNone) return 0;
  const float bound = max_distance * max_distance;
  std::fill(out.begin(), out.end(), Neighbour{Eigen::Vector3f::Zero(), bound});
  std::size_t count = 0;
  search(root_, query, out, count);
  return count;
}

/// `best` is sorted; its last entry bounds what is still of interest.
void KdTree::search(Index index, const Eigen::Vector3f& query, std::span<Neighbour> best,
                    std::size_t& count) const {
  const Node& node = nodes_[index];
  if (!node.removed) {
    const float squared = (node.point - query).squaredNorm();
    if (squared < best.back().squared_distance) {
      std::size_t place = std::min(count, best.size() - 1);
      for (; place > 0 && best[place - 1].squared_distance > squared; --place) {
        best[place] = best[place - 1];
      }
      best[place] = {node.point, squared};
      count = std::min(count + 1, best.size());
    }
  }
  const auto distance = [&](Index child) {
    return child == kNone ? std::numeric_limits<float>::infinity()
                          : nodes_[child].box.squaredExteriorDistance(query);
  };
  const float left = distance(node.left);
  const float right = distance(node.right);
  const bool left_first = left <= right;
  const float near = left_first ? left : right;
  const float far = left_first ? right : left;
  if (near < best.back().squared_distance) {
    search(left_first ? node.left : node.right, query, best, count);
  }
  if (far < best.back().squared_distance) {
    search(left_first ? node.right : node.left, query, best, count);
  }
}

void KdTree::collect(const Eigen::AlignedBox3f& box, std::vector<Eigen::Vector3f>& out) const {
  visit(root_, box, [&](const Eigen::Vector3f& point) { out.push_back(point); });
}

std::vector<Eigen::Vector3f> KdTree::points() const {
  std::vector<Eigen::Vector3f> all;
  all.reserve(size());
  if (root_ != kNone) collect(nodes_[root_].box, all);
  return all;
}

std::size_t KdTree::depth(Index node) const {
  return node == kNone ? 0 : 1 + std::max(depth(nodes_[node].left), depth(nodes_[node].right));
}

std::uint64_t KdTree::memory_bytes() const {
  return nodes_.capacity() * sizeof(Node) + free_.capacity() * sizeof(Index) +
         scratch_.capacity() * sizeof(Eigen::Vector3f);
}

}  // namespace lidarena
