// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/local_map.hpp"

#include <limits>

namespace lidarena::odometry::arena_lio {
namespace {

enum class Insertion { kPlain, kThinned, kNone };

/// How to insert a point, by its neighbors (FAST-LIO2, section V-E; the shortcuts are the published
/// program's): if the nearest one is outside the cell on every axis, the cell is empty; if any one
/// is nearer to the cell's center, the point is not needed.
Insertion insertion_of(const Eigen::Vector3f& point, const Match& match, float voxel) {
  if (match.found == 0) return Insertion::kThinned;
  const Eigen::Vector3f center = ((point / voxel).array().floor() + 0.5F) * voxel;
  const Eigen::Vector3f away = (match.neighbors[0].point - center).cwiseAbs();
  if ((away.array() > 0.5F * voxel).all()) return Insertion::kPlain;
  const float own = (point - center).squaredNorm();
  for (std::size_t i = 0; i < match.found; ++i) {
    if ((match.neighbors[i].point - center).squaredNorm() < own) return Insertion::kNone;
  }
  return Insertion::kThinned;
}

}  // namespace

void add_scan(std::span<const Eigen::Vector3f> points, const std::vector<Match>& matches,
              float voxel, map::KdTree& map) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Insertion insertion =
        matches.empty() ? Insertion::kThinned : insertion_of(points[i], matches[i], voxel);
    if (insertion == Insertion::kPlain) map.insert(points[i]);
    if (insertion == Insertion::kThinned) map.insert_downsampled(points[i], voxel);
  }
}

void MapWindow::follow(const Eigen::Vector3f& sensor, map::KdTree& map) {
  if ((sensor - center_).cwiseAbs().maxCoeff() < 0.25F * radius_) return;
  center_ = sensor;
  constexpr float kFar = std::numeric_limits<float>::max();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::AlignedBox3f below(Eigen::Vector3f::Constant(-kFar), Eigen::Vector3f::Constant(kFar));
    Eigen::AlignedBox3f above = below;
    below.max()[axis] = center_[axis] - radius_;
    above.min()[axis] = center_[axis] + radius_;
    map.remove(below);
    map.remove(above);
  }
}

}  // namespace lidarena::odometry::arena_lio
