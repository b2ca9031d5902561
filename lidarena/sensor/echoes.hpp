// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/sensor/return_config.hpp"

namespace lidarena {

/// What one sub-ray of a beam brought back, or one pulse as the receiver sees it: the parts that it
/// cannot tell apart.
struct Echo {
  double range;   ///< m, as the sensor counts; of several parts, weighted by their signals
  double energy;  ///< share of the beam's, times the surface's backscatter(); sum of the parts
  double signal;  ///< see SignalModel; sum of the parts
  std::uint32_t sub_ray = 0;  ///< the one with the strongest signal
};

/// Directions of a beam's sub-rays around its axis, in units of the Gaussian profile's sigma:
/// (horizontal, vertical), all of one energy. Radii are the profile's quantiles at (i + 1/2) / n,
/// angles the golden angle apart (Vogel 1979).
std::vector<Eigen::Vector2d> sub_ray_offsets(int count);

/// The sub-ray's direction: the unit `axis` turned by (angles.x, angles.y), small, rad, to its left
/// and upwards.
Eigen::Vector3d turned_aside(const Eigen::Vector3d& axis, const Eigen::Vector2d& angles);

/// Replaces `echoes` by the pulses that `parts` make, nearest first: sorted by range, parts belong
/// together as long as each follows the one before within `pulse_length` meters. Sorts `parts`.
void merge_echoes(std::span<Echo> parts, double pulse_length, std::vector<Echo>& echoes);

/// Puts the echoes of a shot, nearest first, in the order in which they are reported, and drops
/// those beyond the count.
void choose_echoes(const ReturnConfig& config, std::vector<Echo>& echoes);

}  // namespace lidarena
