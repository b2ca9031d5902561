// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/flight/flight.hpp"
#include "lidarena/sensor/sensor_config.hpp"

namespace lidarena::sensor {

/// Thrust of the rotors relative to that in hover.
double relative_thrust(const flight::Motion& motion);

/// Vibration of the airframe at the IMU, a function of time: the tones of ImuConfig, and a process
/// with a continuous spectrum. That is a sum of sines in kLines strata of the band, with random
/// frequencies and phases (spectral representation of Shinozuka, Deodatis 1991). The sines'
/// amplitudes follow the spectrum at the present speed of the rotors, so the process is an
/// evolutionary one (Priestley 1965):
///   S(f) = floor / (high - low) + (1 - floor) / 2 * (N(f; r, spread r) + N(f; b r, spread b r)),
/// where r = rotor_hz * sqrt(thrust) and b is the number of blades. Its variance is that of
/// BroadbandConfig, times thrust^2.
class Vibration {
 public:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  static constexpr std::size_t kLines = 128;

  /// Thrust relative to hover, and the lines' amplitudes at it, in units of the RMS.
  struct Gains {
    double thrust = 1.0;
    std::vector<double> lines;
  };
  /// Shift (m) and small rotation (rad) of the IMU, x y z each, IMU frame; and their derivatives.
  struct Shift {
    Vector6 value = Vector6::Zero();
    Vector6 rate = Vector6::Zero();
  };

  /// `name` (the IMU's id and "/imu") keys the phases.
  Vibration(const ImuConfig& config, const std::string& name, std::uint64_t seed);

  bool empty() const { return tones_.empty() && lines_.empty(); }
  Gains gains(double thrust) const;
  /// Adds what the IMU feels of the vibration at `t`, m/s^2 and rad/s.
  void add(Time t, const Gains& gains, Eigen::Vector3d& accel, Eigen::Vector3d& gyro) const;
  /// The shift whose second derivative, and the rotation whose first derivative, is what add()
  /// adds; without the parts by which gains change within a cycle.
  Shift shift(Time t, const Gains& gains) const;

 private:
  /// A sine on each axis: amplitude * sin(2 pi (frequency t + phase)).
  struct Line {
    Line(double frequency, const std::array<double, 6>& cycles);
    double frequency_hz;
    std::array<double, 6> phases;          ///< cycles
    std::array<double, 6> cosines, sines;  ///< of the phases
  };

  void draw_tones(const std::string& name, std::uint64_t seed);
  void draw_lines(const std::string& name, std::uint64_t seed);

  std::vector<VibrationTone> tones_;
  std::vector<Line> tone_lines_;
  BroadbandConfig broadband_;
  std::vector<Line> lines_;
};

}  // namespace lidarena::sensor
