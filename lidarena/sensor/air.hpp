// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/sensor/return_config.hpp"
#include "lidarena/sensor/signal_model.hpp"

namespace lidarena::sensor {

/// The first of events that occur along a ray independently of each other. The range is divided
/// into cells, in each of which an event has a probability; within a cell it is anywhere.
class FirstEvent {
 public:
  FirstEvent() = default;
  /// Cells of `step` m, the first one from `start` m on.
  FirstEvent(double start, double step, const std::vector<double>& probabilities);

  /// Probability of an event nearer than `range`.
  double probability(double range) const;
  /// Range of the first event for a uniform number in [0, 1); empty if it is not below `until`.
  std::optional<double> range(double uniform, double until) const;

 private:
  double start_ = 0.0, step_ = 1.0;
  std::vector<double> nearer_{0.0};  ///< probability of an event before the begin of each cell
};

/// Air with fog or dust, and rain. The two-way transmission is exp(-2 a r) (Beer, Lambert).
///
/// Fog, dust: many small particles, a soft target (Rasshofer, Spies, Spies, "Influences of weather
/// phenomena on automotive laser radar systems", Advances in Radio Science 2011; Hahner et al.,
/// "Fog simulation on real LiDAR point clouds", ICCV 2021). a = ln(20) / visibility. The part
/// within a pulse length L at the range r returns as much as a diffuse target with the reflectivity
/// pi b L, b = a / lidar_ratio (1/m/sr); where its signal exceeds the receiver's threshold, it is a
/// return. The probability is that of SignalModel without the share that has no signal.
///
/// Rain: few large drops with the diameters of Marshall, Palmer, "The distribution of raindrops
/// with size" (Journal of Meteorology 1948), n(D) = 8e6 m^-4 exp(-c D), c = 4100 m^-1 R^-0.21.
/// A drop takes twice its cross section from the beam, so a = pi 8e6 / c^3, and returns
/// 1 / 18.8 of that per sr (as water drops do: O'Connor et al., Journal of Atmospheric and Oceanic
/// Technology 2004). Drops within the beam are a Poisson process; a drop is seen if its signal is
/// at least 1. As in LISA (Kilic et al., "Lidar light scattering augmentation", 2021), with rates
/// in closed form.
class Air {
 public:
  /// A return before the target; energy as in Echo.
  struct Return {
    double range = 0.0;
    double energy = 0.0;
  };

  Air(const NoiseConfig& noise, const SignalModel& signal, double min_range, double max_range,
      const std::string& id, std::uint64_t seed);

  double extinction() const { return extinction_; }  ///< 1/m
  /// Share of the light that comes back from `range`.
  double passed(double range) const;
  /// Probability that fog, or a drop, is detected nearer than `range`.
  double fog_probability(double range) const { return fog_.probability(range); }
  double drop_probability(double range) const { return drops_.probability(range); }
  /// Appends the first return of fog and the first of a drop before `until`, m, of shot `ray`.
  void add_returns(std::uint64_t ray, double until, std::vector<Return>& returns) const;

 private:
  double overlap(double range) const;
  double fog_energy(double range) const;
  double drop_energy(double range) const;
  FirstEvent fog_events(double min_range, double max_range) const;
  FirstEvent drop_events(double min_range, double max_range) const;
  double beam_area(double range) const;
  double least_drop(double range) const;

  AirConfig config_;
  BeamConfig beam_;
  SignalModel signal_;
  CounterRandom random_;
  double slope_ = 0.0;  ///< c of the drops' diameters, 1/m
  double fog_extinction_ = 0.0;
  double extinction_ = 0.0;
  FirstEvent fog_, drops_;
};

}  // namespace lidarena::sensor
