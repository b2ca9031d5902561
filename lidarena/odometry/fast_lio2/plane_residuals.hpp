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

namespace lidarena::fast_lio2 {

inline constexpr std::size_t kNeighbors = 5;
using Neighbors = std::array<Neighbor, kNeighbors>;

/// How far (m^2) the plane may be off within the reach of its five points, which are off it by
/// `point_variance` (m^2): s^2 / 5 of the centroid, and over the distance of the farthest of them
/// the tilt s^2 / w about the direction in which they spread most, w the sum of their squared
/// distances from that line. Points on one line leave the tilt open.
double plane_variance(const Neighbors& points, const Plane& plane, double point_variance);

/// A point of the scan and what it was matched with.
struct Match {
  Neighbors neighbors;  ///< of the last search; the first `found` are valid
  std::size_t found = 0;
  std::optional<Plane> plane;  ///< none: does not count until the next search
  double weight = 1.0;         ///< variance of the point alone by that with its plane's
  bool near_plane = false;     ///< the last search found one, whether the point lies on it or not
};

/// The residual of one point: its distance from the plane and the row of the Jacobian
/// (FAST-LIO2, eq. 12-14).
struct PointResidual {
  double distance = 0.0;  ///< m, signed
  Eigen::Matrix<double, 1, kPointDof> row;
};
PointResidual point_residual(const Eigen::Vector3d& point, const Plane& plane,
                             const InertialState& state, bool extrinsics);

/// Residuals of a scan's points (m, LiDAR frame at the scan's end) against the map. Keeps the
/// matches from one search to the next.
class PlaneResiduals {
 public:
  PlaneResiduals(std::span<const Eigen::Vector3f> points, const KdTree& map, const Config& config,
                 const Parallel& parallel);

  NormalEquations<kPointDof> operator()(const InertialState& state, bool search);
  const std::vector<Match>& matches() const { return matches_; }
  /// Points that the last search found a plane for: they can agree with the map or not.
  double near_planes() const;

 private:
  void find(const Eigen::Vector3f& in_world, Match& match) const;

  std::span<const Eigen::Vector3f> points_;
  const KdTree& map_;
  const Config& config_;
  const Parallel& parallel_;
  std::vector<Match> matches_;
};

}  // namespace lidarena::fast_lio2
