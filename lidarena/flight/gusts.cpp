// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/gusts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lidarena/base/random.hpp"

namespace lidarena::flight {

Gusts::Gusts(const GustConfig& config)
    : wind_(config.wind),
      amplitude_(config.gust_speed * std::sqrt(2.0 / kWaves)),
      still_(config.wind.isZero(0.0) && config.gust_speed == 0.0) {
  const CounterRandom random(config.seed, stream_of("gusts"));
  const double last = std::atan(config.correlation_time_s * kCutoff);
  std::uint64_t index = 0;
  for (auto& axis : waves_) {
    for (std::size_t k = 0; k < kWaves; ++k, ++index) {
      // integral of the spectrum from 0 to w: s^2 (2 / pi) atan(T w)
      const double share = (static_cast<double>(k) + random.uniform(index, 0)) / kWaves;
      axis[k] = {std::tan(share * last) / config.correlation_time_s,
                 2.0 * std::numbers::pi * random.uniform(index, 1)};
    }
  }
}

Eigen::Vector3d Gusts::at(double t_s) const {
  if (still_ || t_s <= 0.0) return Eigen::Vector3d::Zero();
  Eigen::Vector3d air = wind_;
  for (int i = 0; i < 3 && amplitude_ > 0.0; ++i) {
    for (const Wave& wave : waves_[static_cast<std::size_t>(i)]) {
      air[i] += amplitude_ * std::sin(wave.frequency * t_s + wave.phase);
    }
  }
  const double u = std::min(t_s / kFade, 1.0);
  return u * u * u * (10.0 - u * (15.0 - 6.0 * u)) * air;  // twice differentiable
}

}  // namespace lidarena::flight
