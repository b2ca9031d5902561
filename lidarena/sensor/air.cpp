// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/air.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lidarena/base/angle.hpp"

namespace lidarena::sensor {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDropDensity = 8e6;      // m^-4, of Marshall and Palmer
constexpr double kDropSlope = 4100.0;     // 1/m at 1 mm/h, of the same
constexpr double kDropLidarRatio = 18.8;  // sr
constexpr double kContrast = 0.05;        // at the end of the visibility (WMO)
constexpr double kOverlapBegin = 0.9;     // share of overlap_m, as Hahner et al. have it
constexpr double kAperture = 0.01;        // m, diameter of the beam where it leaves
constexpr double kDropStep = 0.05;        // m, cells of the drops
enum AirDraw : std::uint32_t { kFog, kDrop, kDiameter };

}  // namespace

FirstEvent::FirstEvent(double start, double step, const std::vector<double>& probabilities)
    : start_(start), step_(step) {
  for (const double p : probabilities) nearer_.push_back(nearer_.back() + p * (1 - nearer_.back()));
}

double FirstEvent::probability(double range) const {
  const auto last = nearer_.size() - 1;
  const double at = std::clamp((range - start_) / step_, 0.0, static_cast<double>(last));
  const auto cell = static_cast<std::size_t>(at);
  if (cell == last) return nearer_.back();
  const double part = at - static_cast<double>(cell);
  return nearer_[cell] + part * (nearer_[cell + 1] - nearer_[cell]);
}

std::optional<double> FirstEvent::range(double uniform, double until) const {
  const auto end = std::ranges::upper_bound(nearer_, uniform);
  if (end == nearer_.end()) return std::nullopt;
  const double part = (uniform - *(end - 1)) / (*end - *(end - 1));
  const double range = start_ + step_ * (static_cast<double>(end - nearer_.begin() - 1) + part);
  if (range >= until) return std::nullopt;
  return range;
}

Air::Air(const NoiseConfig& noise, const SignalModel& signal, double min_range, double max_range,
         const std::string& id, std::uint64_t seed)
    : config_(noise.air),
      beam_(noise.beam),
      signal_(signal),
      random_(seed, stream_of((id + "/air").c_str())) {
  if (config_.visibility_m > 0.0) fog_extinction_ = -std::log(kContrast) / config_.visibility_m;
  extinction_ = fog_extinction_;
  if (config_.rain_mm_h > 0.0) {
    slope_ = kDropSlope * std::pow(config_.rain_mm_h, -0.21);
    extinction_ += kPi * kDropDensity / std::pow(slope_, 3);
  }
  if (config_.visibility_m > 0.0) fog_ = fog_events(min_range, max_range);
  if (config_.rain_mm_h > 0.0) drops_ = drop_events(min_range, max_range);
}

double Air::passed(double range) const { return std::exp(-2.0 * extinction_ * range); }

/// Share of the emitted beam that the receiver sees.
double Air::overlap(double range) const {
  if (config_.overlap_m == 0.0) return 1.0;
  const double share = range / config_.overlap_m;
  return std::clamp((share - kOverlapBegin) / (1.0 - kOverlapBegin), 0.0, 1.0);
}

double Air::fog_energy(double range) const {
  const double backscatter = fog_extinction_ / config_.lidar_ratio_sr;
  return kPi * backscatter * beam_.pulse_length_m * overlap(range) * passed(range);
}

FirstEvent Air::fog_events(double min_range, double max_range) const {
  const double noise_alone = signal_.detection_probability(0.0);
  const double step = beam_.pulse_length_m;
  std::vector<double> by_fog;
  for (double range = min_range + 0.5 * step; range < max_range; range += step) {
    const double found = signal_.detection_probability(signal_.signal(fog_energy(range), range));
    by_fog.push_back(std::max(0.0, (found - noise_alone) / (1.0 - noise_alone)));
  }
  return {min_range, step, by_fog};
}

/// m^2, of the ellipse at half maximum.
double Air::beam_area(double range) const {
  const double width = kAperture + kDegree * beam_.width_deg * range;
  const double height = kAperture + kDegree * beam_.height_deg * range;
  return 0.25 * kPi * width * height;
}

/// Energy of the return of a drop, over the square of its diameter in m. A hard target with the
/// reflectivity p returns p / pi per sr.
double Air::drop_energy(double range) const {
  const double per_sr = 2.0 * (0.25 * kPi) / kDropLidarRatio / beam_area(range);
  return kPi * per_sr * overlap(range) * passed(range);
}

/// Diameter, m, of the smallest drop that is seen; infinity if none is.
double Air::least_drop(double range) const {
  const double signal = signal_.signal(drop_energy(range), range);
  return signal > 0.0 ? 1.0 / std::sqrt(signal) : std::numeric_limits<double>::infinity();
}

FirstEvent Air::drop_events(double min_range, double max_range) const {
  std::vector<double> by_drop;
  for (double range = min_range + 0.5 * kDropStep; range < max_range; range += kDropStep) {
    const double seen = kDropDensity / slope_ * std::exp(-slope_ * least_drop(range));  // 1/m^3
    by_drop.push_back(-std::expm1(-seen * beam_area(range) * kDropStep));
  }
  return {min_range, kDropStep, by_drop};
}

void Air::add_returns(std::uint64_t ray, double until, std::vector<Return>& returns) const {
  if (const auto range = fog_.range(random_.uniform(ray, kFog), until))
    returns.push_back({*range, fog_energy(*range)});
  const auto range = drops_.range(random_.uniform(ray, kDrop), until);
  if (!range) return;
  // The diameters above any limit are distributed exponentially, too.
  const double above = -std::log1p(-random_.uniform(ray, kDiameter)) / slope_;
  const double diameter = least_drop(*range) + above;
  if (std::isfinite(diameter))
    returns.push_back({*range, diameter * diameter * drop_energy(*range)});
}

}  // namespace lidarena::sensor
