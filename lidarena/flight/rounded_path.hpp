// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace lidarena {

/// A straight line or an arc of a circle.
struct PathPiece {
  Eigen::Vector3d begin = Eigen::Vector3d::Zero();
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();  ///< unit, at `begin`
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    ///< unit, towards the arc's center
  double curvature = 0.0;                              ///< 1/m; 0 for a line
  double length = 0.0;                                 ///< m
  bool from_stop = false;                              ///< the path turns on the spot at `begin`
};

/// A polyline with rounded corners, by arc length.
class RoundedPath {
 public:
  explicit RoundedPath(std::vector<PathPiece> pieces);

  double length() const { return begins_.back(); }
  Eigen::Vector3d point(double s) const;      ///< s in [0, length()]; ends are held
  Eigen::Vector3d direction(double s) const;  ///< unit; at a turn on the spot, the new direction
  std::span<const PathPiece> pieces() const { return pieces_; }

 private:
  std::size_t piece_at(double s) const;

  std::vector<PathPiece> pieces_;
  std::vector<double> begins_;  ///< arc length at each piece's begin, and the whole length
};

/// The polyline through `waypoints` with each corner replaced by the arc that leaves it by at most
/// `tolerance` m and uses at most half of the segments that meet there. A corner too sharp for that
/// becomes a stop.
RoundedPath round_corners(std::span<const Eigen::Vector3d> waypoints, double tolerance);

/// Throws InputError (naming `place`) unless there are two or more waypoints and neighbors lie
/// apart.
void check_waypoints(std::span<const Eigen::Vector3d> waypoints, const std::string& place);

}  // namespace lidarena
