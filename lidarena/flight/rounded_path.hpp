// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace lidarena::flight {

/// A straight line segment or a circular arc.
struct PathPiece {
  Eigen::Vector3d begin = Eigen::Vector3d::Zero();
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();  ///< unit, at `begin`
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    ///< unit, towards the arc's center
  double curvature = 0.0;                              ///< 1/m; 0 for a line
  double length = 0.0;                                 ///< m
  bool from_stop = false;                              ///< the path stops and turns at `begin`
};

/// A polyline with rounded corners, parameterized by arc length (m).
class RoundedPath {
 public:
  explicit RoundedPath(std::vector<PathPiece> pieces);

  double length() const { return begins_.back(); }
  Eigen::Vector3d point(double s) const;      ///< s is clamped to [0, length()]
  Eigen::Vector3d direction(double s) const;  ///< unit; at a stop, the new direction
  std::span<const PathPiece> pieces() const { return pieces_; }

 private:
  std::size_t piece_at(double s) const;

  std::vector<PathPiece> pieces_;
  std::vector<double> begins_;  ///< arc length at the start of each piece, and the total length
};

/// The polyline through `waypoints` with each corner replaced by an arc that deviates from it by at
/// most `tolerance` (m) and uses at most half of each adjacent segment. A corner that is too sharp
/// for an arc becomes a stop.
RoundedPath round_corners(std::span<const Eigen::Vector3d> waypoints, double tolerance);

/// Throws InputError (place `place`) unless there are at least two waypoints and no waypoint
/// repeats the previous one.
void check_waypoints(std::span<const Eigen::Vector3d> waypoints, const std::string& place);

}  // namespace lidarena::flight
