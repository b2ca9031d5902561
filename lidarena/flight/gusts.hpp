// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

#include "lidarena/flight/quadrotor_config.hpp"

namespace lidarena::flight {

/// Velocity of the air as a pure and infinitely smooth function of time: the mean wind plus, on
/// each axis, a sum of sines whose frequencies sample the longitudinal Dryden spectrum
///   S(w) = 2 s^2 T / (pi (1 + (T w)^2))   (MIL-F-8785C, with T = L / V),
/// with standard deviation s and correlation time T. One frequency is drawn from each of kWaves
/// bands of equal variance (spectral representation, Shinozuka, Jan 1972), up to kCutoff, because
/// faster gusts are smaller than the body. Wind and gusts are faded in over the first second.
class Gusts {
 public:
  static constexpr std::size_t kWaves = 32;
  static constexpr double kCutoff = 30.0;  ///< rad/s; 2 % of the variance lies above it at T = 1 s
  static constexpr double kFade = 1.0;     ///< s, duration of the fade-in

  explicit Gusts(const GustConfig& config);

  /// Velocity of the air in the world frame, m/s; zero for t <= 0.
  Eigen::Vector3d at(double t_s) const;
  bool still() const { return still_; }

 private:
  struct Wave {
    double frequency, phase;  ///< rad/s, rad
  };
  std::array<std::array<Wave, kWaves>, 3> waves_{};
  Eigen::Vector3d wind_;
  double amplitude_;
  bool still_;
};

}  // namespace lidarena::flight
