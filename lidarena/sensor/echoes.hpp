// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "lidarena/sensor/return_config.hpp"

namespace lidarena::sensor {

inline constexpr double kGoldenAngle =
    std::numbers::pi * (3.0 - 2.23606797749978969);  ///< rad, pi (3 - sqrt 5)

/// Return of one sub-ray of a beam, or one pulse as the receiver sees it: the sum of the returns
/// (parts) that it cannot separate.
struct Echo {
  double range;   ///< m, from the sensor's axis; mean over the parts, weighted by signal
  double energy;  ///< share of the beam's energy times backscatter(); sum of the parts
  double signal;  ///< see SignalModel; sum of the parts
  std::uint32_t sub_ray = 0;  ///< the part (sub-ray) with the strongest signal
  bool is_stray = false;      ///< of the air or of a halo: it uses no random number of others
};

/// Offsets of a beam's sub-rays from its axis, (horizontal, vertical), in units of the Gaussian
/// profile's sigma; all sub-rays have the same energy. Radii are the profile's quantiles at
/// (i + 1/2) / n; successive angles differ by the golden angle (Vogel 1979).
std::vector<Eigen::Vector2d> sub_ray_offsets(int count);

/// Angle, rad, within which the share `u` of the light is that scatters within a LiDAR, half of it
/// within `half_angle`:
///   u = 1 - 1 / sqrt(1 + 3 (angle / half_angle)^2),
/// a profile with wide wings (Moffat, "A theoretical investigation of focal stellar images", 1969,
/// with the exponent 3/2), such as scattering surfaces have. The spread is the same everywhere in a
/// scene, as in Gump et al., "Ghosts in the point clouds" (CVPR 2026).
double glare_angle(double half_angle, double u);

/// Direction of a sub-ray: the unit vector `axis` rotated by the small angles (angles.x, angles.y),
/// rad, to its left and upwards.
Eigen::Vector3d deflected(const Eigen::Vector3d& axis, const Eigen::Vector2d& angles);

/// The same in single precision for angles of at most some mrad: 1e-7 of the direction.
Eigen::Vector3f slightly_deflected(const Eigen::Vector3f& axis, float left, float up);

/// Sorts `parts` by range and merges them into pulses, which replace `echoes`, nearest first. A
/// part belongs to the pulse of the previous part if it lies at most `pulse_length` meters behind
/// it.
void merge_echoes(std::span<Echo> parts, double pulse_length, std::vector<Echo>& echoes);

/// Sorts the echoes of a shot, given nearest first, into reporting order and drops those beyond
/// config.count.
void choose_echoes(const ReturnConfig& config, std::vector<Echo>& echoes);

}  // namespace lidarena::sensor
