// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/estimation/point_to_plane.hpp"
#include "lidarena/map/kd_tree.hpp"
#include "lidarena/odometry/arena_lio/config.hpp"

namespace lidarena::odometry::arena_lio {

inline constexpr std::size_t kNeighbors = 5;

/// The map's points near a point, as far as they were found.
struct Nearest {
  std::array<map::Neighbor, kNeighbors> points;
  std::size_t found = 0;
  std::span<const map::Neighbor> neighbors() const { return std::span(points).first(found); }
};

/// Variance (m^2) of the plane's position within the extent of its five points, whose distances
/// from it have the variance s^2 = `point_variance` (m^2): s^2 / 5 of the centroid, plus the
/// squared distance of the farthest point times the variance s^2 / w of the tilt about the
/// direction of largest spread, where w is the sum of the points' squared distances from that axis.
/// For points on one line the tilt is not observable, and the variance is large.
double plane_variance(const std::array<map::Neighbor, kNeighbors>& points,
                      const estimation::Plane& plane, double point_variance);

/// Residuals of a scan's points (m, LiDAR frame at the scan's end) against the map. Planes are kept
/// until the next search, except those that a point turned out to be off.
class PlaneResiduals {
 public:
  PlaneResiduals(std::span<const Eigen::Vector3f> points, const map::KdTree& map,
                 const Config& config, const Parallel& parallel);

  estimation::NormalEquations<estimation::kPointDof> operator()(
      const estimation::InertialState& state, bool search);
  std::span<const Nearest> nearest() const { return nearest_; }
  /// Number of points for which the last search found a plane, whether they lie on it or not.
  std::size_t near_planes() const { return near_planes_; }

 private:
  void find_planes(const Pose& world_from_lidar);
  std::optional<estimation::WeightedPlane> plane_of(const Nearest& nearest) const;

  std::span<const Eigen::Vector3f> points_;
  const map::KdTree& map_;
  const Config& config_;
  const Parallel& parallel_;
  std::vector<Nearest> nearest_;
  estimation::PointPlanes planes_;
  std::size_t near_planes_ = 0;
};

}  // namespace lidarena::odometry::arena_lio
