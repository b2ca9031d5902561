// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/estimation/inertial_state.hpp"
#include "lidarena/estimation/iterated_update.hpp"
#include "lidarena/estimation/least_squares.hpp"
#include "lidarena/estimation/plane_fit.hpp"
#include "lidarena/map/kd_tree.hpp"
#include "lidarena/odometry/fast_lio2/config.hpp"

namespace lidarena::odometry::fast_lio2 {

inline constexpr std::size_t kNeighbors = 5;
using Neighbors = std::array<map::Neighbor, kNeighbors>;

/// Variance (m^2) of the plane's position within the extent of its five points, whose distances
/// from it have the variance s^2 = `point_variance` (m^2): s^2 / 5 of the centroid, plus the
/// squared distance of the farthest point times the variance s^2 / w of the tilt about the
/// direction of largest spread, where w is the sum of the points' squared distances from that axis.
/// For points on one line the tilt is not observable, and the variance is large.
double plane_variance(const Neighbors& points, const estimation::Plane& plane,
                      double point_variance);

/// Match of one point of the scan.
struct Match {
  Neighbors neighbors;  ///< of the last search; the first `found` are valid
  std::size_t found = 0;
  std::optional<estimation::Plane> plane;  ///< none: the point is not used until the next search
  double weight = 1.0;                     ///< point variance / (point variance + plane variance)
  bool near_plane = false;  ///< the last search found a plane, even if the point is off it
};

/// Residual of one point: its distance from the plane and the row of the Jacobian (FAST-LIO2,
/// eq. 12-14).
struct PointResidual {
  double distance = 0.0;  ///< m, signed
  Eigen::Matrix<double, 1, estimation::kPointDof> row;
};
PointResidual point_residual(const Eigen::Vector3d& point, const estimation::Plane& plane,
                             const estimation::InertialState& state, bool extrinsics);

/// Residuals of a scan's points (m, LiDAR frame at the scan's end) against the map. Matches are
/// kept until the next search.
class PlaneResiduals {
 public:
  PlaneResiduals(std::span<const Eigen::Vector3f> points, const map::KdTree& map,
                 const Config& config, const Parallel& parallel);

  estimation::NormalEquations<estimation::kPointDof> operator()(
      const estimation::InertialState& state, bool search);
  const std::vector<Match>& matches() const { return matches_; }
  /// Number of points for which the last search found a plane, whether they lie on it or not.
  std::size_t near_planes() const;

 private:
  void find(const Eigen::Vector3f& in_world, Match& match) const;

  std::span<const Eigen::Vector3f> points_;
  const map::KdTree& map_;
  const Config& config_;
  const Parallel& parallel_;
  std::vector<Match> matches_;
};

}  // namespace lidarena::odometry::fast_lio2
