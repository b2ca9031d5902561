// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "lidarena/base/random.hpp"
#include "lidarena/base/time.hpp"
#include "lidarena/sensor/error_config.hpp"

namespace lidarena::sensor {

/// What a sensor's clock shows: offset + (1 + drift) * true time. A stamp has an error of its own
/// beside. Stamps are never negative, and increase from one measurement to the next.
class SensorClock {
 public:
  /// A clock without error.
  SensorClock() = default;
  /// Measurements follow each other every `period`; `name` is part of the jitter's key.
  SensorClock(double offset_s, double drift, double stamp_jitter_s, Time period,
              const std::string& name, std::uint64_t seed);

  /// Reading of the clock at true time `t`.
  Time reading(Time t) const;
  /// Stamp of measurement `index`, made at true time `t`.
  Time stamp(std::uint64_t index, Time t) const;
  /// Reading of a short duration.
  std::int32_t elapsed(std::int32_t ns) const {
    return drift_ == 0.0 ? ns : static_cast<std::int32_t>(scaled(ns));
  }
  /// The true time at which the clock shows `reading`, to 1 ns.
  Time true_time(Time reading) const;

 private:
  std::int64_t scaled(std::int64_t ns) const;

  Time offset_{0};
  double drift_ = 0.0;
  double jitter_s_ = 0.0;
  double max_jitter_s_ = 0.0;
  CounterRandom random_{0};
};

}  // namespace lidarena::sensor
