// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/flight/flight.hpp"

namespace lidarena {

/// A recorded trajectory flown again: through every recorded pose at its instant, twice
/// continuously differentiable in position and rotation. Time 0 is the first pose.
///
/// Velocity and acceleration at a pose are those of the polynomial through it and its four nearest
/// neighbors in the row (for the rotation: of rotation vectors relative to that pose); between two
/// poses a quintic Hermite polynomial joins them. Between samples h apart of a smooth motion the
/// position is off by O(h^5) and the acceleration by O(h^3); noise of s meters in the recording
/// becomes noise of about 3 s / h^2 in the acceleration, so thin a noisy recording first (thinned).
/// A recording that begins or ends in motion does so here too: outside, the body rests there.
class ReplayFlight final : public Flight {
 public:
  /// Throws InputError (place `name`) below two poses.
  explicit ReplayFlight(const Trajectory& recording, const std::string& name = "recording");

  Motion at(Time t) const override;
  Pose pose_at(Time t) const override;
  Time duration() const override { return ends_.back(); }

 private:
  using Coefficients = Eigen::Matrix<double, 3, 6>;  ///< column i: coefficient of u^i

  struct Piece {
    Eigen::Matrix3d world_from_begin;  ///< rotation at the piece's begin
    Coefficients position;             ///< m, world frame
    Coefficients rotation;             ///< rotation vector in the begin's frame, rad
    Time begin;
    double length_s;
  };
  const Piece& piece_at(Time t) const;

  std::vector<Piece> pieces_;
  std::vector<Time> ends_;  ///< of each piece, increasing
};

}  // namespace lidarena
