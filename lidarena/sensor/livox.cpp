// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/livox.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "lidarena/base/angle.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena::sensor {
namespace {

constexpr std::size_t kMaxRotors = 3;

using Phases = std::array<Eigen::Vector2d, kMaxRotors>;  // (cos, sin)

double angle_of(const Rotor& rotor, double group) {
  double angle = kDegree * (rotor.phase_deg + rotor.step_deg * (group + rotor.sample_offset));
  if (rotor.modulation_rad != 0.0) {
    const double step = kDegree * rotor.modulation_step_deg;
    const double wave = std::sin(2.0 * step * (group + 0.5)) * step / std::sin(step);
    angle += rotor.modulation_rad * (wave + step);
  }
  return angle;
}

Phases phases_of(const LivoxModel& model, std::uint64_t group) {
  Phases phases;
  for (std::size_t i = 0; i < model.rotors.size(); ++i) {
    const double angle = angle_of(model.rotors[i], static_cast<double>(group) / model.shots_factor);
    phases[i] = {std::cos(angle), std::sin(angle)};
  }
  return phases;
}

Eigen::Vector3d direction(const LivoxModel& model, const Phases& phases, std::size_t emitter) {
  return model.lidar_from_chain *
         trace(model.surfaces, model.glass_index, phases, model.emitters[emitter]);
}

}  // namespace

Eigen::Vector3d livox_direction(const LivoxModel& model, std::uint64_t row) {
  const std::uint64_t emitters = model.emitters.size();
  return direction(model, phases_of(model, row / emitters),
                   static_cast<std::size_t>(row % emitters));
}

std::size_t rows_per_scan(double row_rate_hz, double rate_hz, std::size_t emitters,
                          const std::string& name) {
  const double rows = row_rate_hz / rate_hz;
  const bool whole = std::abs(rows - std::round(rows)) < 1e-9 * rows;
  const auto count = static_cast<std::size_t>(std::llround(rows));
  if (!whole || count < 1 || count % emitters != 0) {
    throw InputError(
        name, "a scan would not hold a whole number of laser groups",
        "choose rate_hz so that rows per second / rate_hz / emitters is a whole number");
  }
  return count;
}

std::int32_t row_dt_ns(std::size_t row, double row_rate_hz) {
  return static_cast<std::int32_t>(std::llround(1e9 * static_cast<double>(row) / row_rate_hz));
}

LivoxPattern::LivoxPattern(LivoxModel model, double rate_hz, const std::string& name)
    : model_(std::move(model)),
      period_(from_seconds(1.0 / rate_hz)),
      rows_per_scan_(rows_per_scan(model_.row_rate_hz, rate_hz, model_.emitters.size(), name)) {}

std::uint64_t LivoxPattern::repeats_after() const {
  const std::uint64_t groups = rows_per_scan_ / model_.emitters.size();
  return model_.repeat_groups / std::gcd(model_.repeat_groups, groups);
}

void LivoxPattern::beams(std::uint64_t index, std::vector<Beam>& out) const {
  const std::size_t emitters = model_.emitters.size();
  const std::uint64_t groups = rows_per_scan_ / emitters;
  out.resize(rows_per_scan_);
  for (std::uint64_t group = 0; group < groups; ++group) {
    // Reduced modulo the repetition period, so that long flights lose no precision.
    const Phases phases = phases_of(model_, (index * groups + group) % model_.repeat_groups);
    for (std::size_t emitter = 0; emitter < emitters; ++emitter) {
      const std::size_t row = group * emitters + emitter;
      out[row].direction = direction(model_, phases, emitter).cast<float>();
      out[row].dt_ns = row_dt_ns(row, model_.row_rate_hz);
      out[row].ring = static_cast<std::uint16_t>(emitter);
      out[row].origin.setZero();
    }
  }
}

}  // namespace lidarena::sensor
