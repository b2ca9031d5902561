// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/sensor_clock.hpp"

#include <algorithm>
#include <cmath>

namespace lidarena::sensor {

namespace {
constexpr double kMaxJitter = 0.45;  // of the period: the stamps of two neighbors keep their order
}

SensorClock::SensorClock(double offset_s, double drift, double stamp_jitter_s, Time period,
                         const std::string& name, std::uint64_t seed)
    : offset_(from_seconds(offset_s)),
      drift_(drift),
      jitter_s_(stamp_jitter_s),
      max_jitter_s_(kMaxJitter * to_seconds(period)),
      random_(seed, stream_of((name + "/clock").c_str())) {}

std::int64_t SensorClock::scaled(std::int64_t ns) const {
  return ns + std::llround(drift_ * static_cast<double>(ns));
}

Time SensorClock::reading(Time t) const { return offset_ + Time{scaled(t.count())}; }

Time SensorClock::stamp(std::uint64_t index, Time t) const {
  if (jitter_s_ == 0.0) return std::max(Time{0}, reading(t));
  const double error = jitter_s_ * random_.normals(index)[0];
  return std::max(Time{0},
                  reading(t) + from_seconds(std::clamp(error, -max_jitter_s_, max_jitter_s_)));
}

Time SensorClock::true_time(Time reading) const {
  return Time{std::llround(static_cast<double>((reading - offset_).count()) / (1.0 + drift_))};
}

}  // namespace lidarena::sensor
