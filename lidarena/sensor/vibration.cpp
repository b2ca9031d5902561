// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/vibration.hpp"

#include <cmath>
#include <numbers>

namespace lidarena::sensor {
namespace {

constexpr double kCycle = 2.0 * std::numbers::pi;  // rad
/// First of the random numbers of the stream "ID/imu" that are the tones' phases (see imu.cpp).
constexpr std::uint32_t kTonePhases = 20;
enum LineDraw : std::uint32_t { kFrequency, kPhases };

double normal_density(double x, double mean, double sigma) {
  const double z = (x - mean) / sigma;
  return std::exp(-0.5 * z * z) / (sigma * std::sqrt(kCycle));
}

/// Share of the variance per Hz at frequency `f` while the rotors turn `rotor_hz` times a second.
double spectrum(const BroadbandConfig& config, double rotor_hz, double f) {
  const double blades_hz = config.blades * rotor_hz;
  const double peaks = normal_density(f, rotor_hz, config.spread * rotor_hz) +
                       normal_density(f, blades_hz, config.spread * blades_hz);
  return config.floor_share / (config.high_hz - config.low_hz) +
         0.5 * (1.0 - config.floor_share) * peaks;
}

}  // namespace

double relative_thrust(const flight::Motion& motion) {
  const Eigen::Vector3d up(0.0, 0.0, flight::kGravity);
  return (motion.acceleration_world + up).norm() / flight::kGravity;
}

Vibration::Line::Line(double frequency, const std::array<double, 6>& cycles)
    : frequency_hz(frequency), phases(cycles) {
  for (std::size_t axis = 0; axis < 6; ++axis) {
    cosines[axis] = std::cos(kCycle * phases[axis]);
    sines[axis] = std::sin(kCycle * phases[axis]);
  }
}

Vibration::Vibration(const ImuConfig& config, const std::string& name, std::uint64_t seed)
    : tones_(config.vibration), broadband_(config.broadband) {
  draw_tones(name, seed);
  if (!broadband_.accel_rms.isZero() || !broadband_.gyro_rms.isZero()) draw_lines(name, seed);
}

void Vibration::draw_tones(const std::string& name, std::uint64_t seed) {
  const CounterRandom random(seed, stream_of(name.c_str()));
  for (std::size_t i = 0; i < tones_.size(); ++i) {
    std::array<double, 6> phases;
    for (std::uint32_t axis = 0; axis < 6; ++axis)
      phases[axis] = random.uniform(i, kTonePhases + axis);
    tone_lines_.emplace_back(tones_[i].frequency_hz, phases);
  }
}

void Vibration::draw_lines(const std::string& name, std::uint64_t seed) {
  const CounterRandom random(seed, stream_of((name + "/broadband").c_str()));
  const double step = (broadband_.high_hz - broadband_.low_hz) / kLines;
  for (std::size_t i = 0; i < kLines; ++i) {
    const double place = static_cast<double>(i) + random.uniform(i, kFrequency);
    std::array<double, 6> phases;
    for (std::uint32_t axis = 0; axis < 6; ++axis) phases[axis] = random.uniform(i, kPhases + axis);
    lines_.emplace_back(broadband_.low_hz + step * place, phases);
  }
}

Vibration::Gains Vibration::gains(double thrust) const {
  Gains gains{thrust, {}};
  const double rotor_hz = broadband_.rotor_hz * std::sqrt(thrust);
  const double step = (broadband_.high_hz - broadband_.low_hz) / kLines;
  for (const Line& line : lines_) {  // a sine of amplitude a has the variance a^2 / 2
    const double share = step * spectrum(broadband_, rotor_hz, line.frequency_hz);
    gains.lines.push_back(thrust * std::sqrt(2.0 * share));
  }
  return gains;
}

void Vibration::add(Time t, const Gains& gains, Eigen::Vector3d& accel,
                    Eigen::Vector3d& gyro) const {
  const double seconds = to_seconds(t);
  for (std::size_t i = 0; i < tones_.size(); ++i) {
    // The force of an unbalanced propeller grows with the square of its speed, as its thrust does.
    const double gain = tones_[i].grows_with_thrust ? gains.thrust : 1.0;
    const double cycles = tone_lines_[i].frequency_hz * seconds;
    const auto wave = [&](std::size_t axis) {
      return std::sin(kCycle * (cycles + tone_lines_[i].phases[axis]));
    };
    accel +=
        gain * tones_[i].accel_amplitude.cwiseProduct(Eigen::Vector3d(wave(0), wave(1), wave(2)));
    gyro +=
        gain * tones_[i].gyro_amplitude.cwiseProduct(Eigen::Vector3d(wave(3), wave(4), wave(5)));
  }
  if (lines_.empty()) return;
  Vector6 sum = Vector6::Zero();
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const Line& line = lines_[i];
    const double angle = kCycle * line.frequency_hz * seconds;
    const double sine = gains.lines[i] * std::sin(angle);
    const double cosine = gains.lines[i] * std::cos(angle);
    for (int axis = 0; axis < 6; ++axis)
      sum[axis] += sine * line.cosines[axis] + cosine * line.sines[axis];
  }
  accel += broadband_.accel_rms.cwiseProduct(sum.head<3>());
  gyro += broadband_.gyro_rms.cwiseProduct(sum.tail<3>());
}

Vibration::Shift Vibration::shift(Time t, const Gains& gains) const {
  Shift shift;
  // a sin(w t + p) is the second derivative of -a / w^2 sin, and the first one of -a / w cos.
  const auto add = [&](const Line& line, double gain, const Eigen::Vector3d& accel,
                       const Eigen::Vector3d& gyro) {
    const double w = kCycle * line.frequency_hz;
    const double sine = std::sin(w * to_seconds(t)), cosine = std::cos(w * to_seconds(t));
    for (int i = 0; i < 6; ++i) {
      const double in_phase = sine * line.cosines[i] + cosine * line.sines[i];
      const double ahead = cosine * line.cosines[i] - sine * line.sines[i];
      if (i < 3) {
        shift.value[i] -= gain * accel[i] / (w * w) * in_phase;
        shift.rate[i] -= gain * accel[i] / w * ahead;
      } else {
        shift.value[i] -= gain * gyro[i - 3] / w * ahead;
        shift.rate[i] += gain * gyro[i - 3] * in_phase;
      }
    }
  };
  for (std::size_t i = 0; i < tones_.size(); ++i) {
    add(tone_lines_[i], tones_[i].grows_with_thrust ? gains.thrust : 1.0, tones_[i].accel_amplitude,
        tones_[i].gyro_amplitude);
  }
  for (std::size_t i = 0; i < lines_.size(); ++i)
    add(lines_[i], gains.lines[i], broadband_.accel_rms, broadband_.gyro_rms);
  return shift;
}

}  // namespace lidarena::sensor
