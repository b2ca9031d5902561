// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/group_search.hpp"

#include <algorithm>
#include <cmath>

namespace lidarena::world {

using Eigen::Vector3d;

namespace {

constexpr std::size_t kMaxGroup = 48;       // maximum number of points in a group
constexpr std::size_t kMinGroup = 4;        // smaller groups are searched point by point
constexpr std::size_t kMaxTriangles = 160;  // above this number, one search per point is faster

/// Number of points from the front of the list that fit into a box of edge `size` (m). A point that
/// is not finite forms a group of its own.
std::size_t group_length(std::span<const Vector3d> points, double size) {
  if (!points.front().allFinite()) return 1;
  Eigen::AlignedBox3d box(points.front());
  std::size_t length = 1;
  for (; length < std::min(points.size(), kMaxGroup); ++length) {
    if (!points[length].allFinite()) break;
    box.extend(points[length]);
    if (box.sizes().maxCoeff() > size) break;
  }
  return length;
}

/// Bound on the rounding error (m) of distances between a mesh and points within `radius` of
/// `center` in double arithmetic.
double rounding_at(const Vector3d& center, double radius) {
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  return 64.0 * kEpsilon * (center.lpNorm<Eigen::Infinity>() + radius);
}

}  // namespace

void GroupSearch::run(Points points, Results out) {
  std::size_t begin = 0;
  while (begin < points.size()) {
    const std::size_t length = group_length(points.subspan(begin), group_size_);
    search_group(points.subspan(begin, length), out.subspan(begin, length));
    begin += length;
  }
}

void GroupSearch::one_by_one(Points points, Results out) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    out[i] = tree_.nearest(points[i], max_distance_, last_);
    if (out[i].valid()) last_ = out[i].triangle;
  }
}

/// Let y be the surface point nearest to the group's center. For a point p of the group at distance
/// u(p) from y, the nearest triangle is at most u(p) from p, hence at most u(p) + |p - center| from
/// the center.
void GroupSearch::search_group(Points points, Results out) {
  if (points.size() < kMinGroup) return one_by_one(points, out);
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : points) box.extend(p);
  const Vector3d center = box.center();
  double radius = 0.0;
  for (const Vector3d& p : points) radius = std::max(radius, (p - center).norm());
  const ClosestPoint middle = tree_.nearest(center, max_distance_ + radius, last_);
  if (!middle.valid()) {
    std::fill(out.begin(), out.end(), ClosestPoint{});
    return;
  }
  last_ = middle.triangle;
  double reach = 0.0;
  for (const Vector3d& p : points) {
    const double offset = (p - center).norm();
    const double bound = std::min((p - middle.point).norm(), max_distance_);
    reach = std::max(reach, bound + offset);
  }
  const double rounding = rounding_at(center, reach);
  if (!gather(center, reach + rounding)) {
    const std::size_t half = points.size() / 2;
    search_group(points.first(half), out.first(half));
    search_group(points.subspan(half), out.subspan(half));
    return;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    out[i] = choose(points[i], (points[i] - center).norm(), rounding);
  }
}

bool GroupSearch::gather(const Vector3d& center, double radius) {
  if (!tree_.within(center, radius, kMaxTriangles, found_)) return false;
  std::sort(found_.begin(), found_.end(), [](const NearTriangle& a, const NearTriangle& b) {
    return a.distance < b.distance || (a.distance == b.distance && a.index < b.index);
  });
  frames_.clear();
  for (const NearTriangle& near : found_) {
    const auto& [a, b, c] = mesh_.triangles[near.index];
    frames_.emplace_back(mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]);
  }
  return true;
}

/// `offset`: distance of the point from the group's center. Distances are compared approximately
/// first; for candidates that may be nearest they are recomputed by closest_point_on_triangle.
ClosestPoint GroupSearch::choose(const Vector3d& point, double offset, double rounding) const {
  ClosestPoint best;
  double best2 = max_distance_ * max_distance_;
  double limit = (max_distance_ + rounding) * (max_distance_ + rounding);
  for (std::size_t i = 0; i < found_.size(); ++i) {
    const double min_distance = found_[i].distance - offset - rounding;
    if (min_distance > 0.0 && min_distance * min_distance > limit)
      break;  // all that follow are farther still
    if (frames_[i].squared_distance(point, limit) > limit) continue;
    const std::uint32_t triangle = found_[i].index;
    const auto& [a, b, c] = mesh_.triangles[triangle];
    const auto& v = mesh_.vertices;
    const Vector3d candidate = closest_point_on_triangle(point, v[a], v[b], v[c]);
    const double distance2 = (candidate - point).squaredNorm();
    if (distance2 > best2 || (distance2 == best2 && triangle >= best.triangle)) continue;
    best2 = distance2;
    best.point = candidate;
    best.triangle = triangle;
    limit = std::sqrt(distance2) + rounding;
    limit *= limit;
  }
  if (best.valid()) best.distance = std::sqrt(best2);
  return best;
}

}  // namespace lidarena::world
