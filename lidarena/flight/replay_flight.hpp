// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/flight/flight.hpp"

namespace lidarena::flight {

/// Replay of a recorded trajectory: passes through every recorded pose at its instant and is twice
/// continuously differentiable in position and rotation. Time 0 is the first pose.
///
/// Velocity and acceleration at a pose are those of the polynomial through it and its four nearest
/// neighbors in time (for the rotation: of rotation vectors relative to that pose); two consecutive
/// poses are joined by a quintic Hermite polynomial. For samples h apart of a smooth motion the
/// error is O(h^5) in the position and O(h^3) in the acceleration. Noise of s meters in the
/// recording becomes noise of about 3 s / h^2 in the acceleration, so a noisy recording should be
/// thinned first (thinned). If a recording begins or ends in motion, so does the flight; outside
/// its duration the body rests at the first or last pose.
class ReplayFlight final : public Flight {
 public:
  /// Throws InputError (place `name`) when there are fewer than two poses.
  explicit ReplayFlight(const Trajectory& recording, const std::string& name = "recording");

  Motion at(Time t) const override;
  Pose pose_at(Time t) const override;
  Time duration() const override { return ends_.back(); }

 private:
  using Coefficients = Eigen::Matrix<double, 3, 6>;  ///< column i: coefficient of u^i

  struct Piece {
    Eigen::Matrix3d world_from_begin;  ///< rotation at the start of the piece
    Coefficients position;             ///< m, world frame
    Coefficients rotation;             ///< rotation vector in the frame at the start, rad
    Time begin;
    double length_s;
  };
  const Piece& piece_at(Time t) const;

  std::vector<Piece> pieces_;
  std::vector<Time> ends_;  ///< end of each piece, increasing
};

}  // namespace lidarena::flight
