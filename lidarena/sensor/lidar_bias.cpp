// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/lidar_bias.hpp"

#include <algorithm>
#include <cmath>

#include "lidarena/base/angle.hpp"
#include "lidarena/base/random.hpp"

namespace lidarena::sensor {
namespace {

constexpr double kLeastCosine = 0.08715574;  // of 85 deg
constexpr double kLeastReflectivity = 0.01;  // where the bias by reflectivity ends
constexpr double kUsualReflectivity = 0.5;   // for which LiDARs are calibrated here
enum BiasDraw : std::uint32_t { kUnit, kChannel, kDirection };

}  // namespace

LidarBias::LidarBias(const BiasConfig& config, const std::string& id, std::uint64_t seed,
                     std::size_t channels)
    : config_(config),
      has_ranges_(config.unit_m > 0.0 || config.channel_m > 0.0 || config.incidence_m != 0.0 ||
                  config.reflectivity_m != 0.0) {
  const CounterRandom random(seed, stream_of((id + "/bias").c_str()));
  const double unit = config.unit_m * random.normals(0, kUnit)[0];
  for (std::size_t i = 0; i < channels; ++i) {
    of_channel_.push_back(unit + config.channel_m * random.normals(i, kChannel)[0]);
    if (config.direction_deg == 0.0) continue;
    const auto [left, up] = random.normals(i, kDirection);
    directions_.emplace_back(
        (kDegree * config.direction_deg * Eigen::Vector2d(left, up)).cast<float>());
  }
}

double LidarBias::range(std::uint16_t channel, double cos_incidence, double reflectivity) const {
  const double cosine = std::clamp(cos_incidence, kLeastCosine, 1.0);
  const double share = std::max(reflectivity, kLeastReflectivity) / kUsualReflectivity;
  return of_channel_[channel] + config_.incidence_m * (1.0 / cosine - 1.0) -
         config_.reflectivity_m * std::log10(share);
}

}  // namespace lidarena::sensor
