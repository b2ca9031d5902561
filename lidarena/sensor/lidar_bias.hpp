// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "lidarena/sensor/error_config.hpp"

namespace lidarena::sensor {

/// Errors of one unit that stay the same from shot to shot. Those of the unit and of its channels
/// are drawn once from (seed, id); those by incidence and reflectivity are functions of the
/// surface:
///   incidence_m * (1 / cos(incidence) - 1), constant beyond 85 deg;
///   -reflectivity_m * log10(reflectivity / 0.5), constant below 1 %.
class LidarBias {
 public:
  LidarBias(const BiasConfig& config, const std::string& id, std::uint64_t seed,
            std::size_t channels);

  bool has_ranges() const { return has_ranges_; }
  bool has_directions() const { return !directions_.empty(); }

  /// Bias of a range, m.
  double range(std::uint16_t channel, double cos_incidence, double reflectivity) const;
  /// Angles to the left and upwards, rad, by which a channel's reported directions are off.
  const Eigen::Vector2f& direction(std::uint16_t channel) const { return directions_[channel]; }

 private:
  BiasConfig config_;
  bool has_ranges_;
  std::vector<double> of_channel_;  ///< m, with the bias of the unit
  std::vector<Eigen::Vector2f> directions_;
};

}  // namespace lidarena::sensor
