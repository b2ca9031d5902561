// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/sensor/lidar.hpp"
#include "lidarena/sensor/light_paths.hpp"
#include "lidarena/sensor/normal_pairs.hpp"

/// What the two source files of Lidar share: one aims and casts rays, one makes points of hits.
namespace lidarena::sensor {

/// Purposes of a ray's random numbers; each further echo uses the next kDraws values.
enum LidarDraw : std::uint32_t { kRange, kDetection, kAngle, kSpin, kDraws };

inline std::uint32_t draw_of(LidarDraw draw, std::size_t echo) {
  return draw + kDraws * static_cast<std::uint32_t>(echo);
}

/// Distance from a beam's origin at which its ray starts: 0, except in kOfficial. That mode
/// reproduces a fault of the official plugin: rays start at the minimum range, and the range is
/// measured from there.
inline double start_offset(const SensorConfig& config) {
  return config.mode == ScanMode::kOfficial ? config.min_range_m : 0.0;
}

/// Whether points have times, and those of their shots.
inline bool has_own_times(ScanMode mode) {
  return mode == ScanMode::kRolling || mode == ScanMode::kFrozen;
}

/// What a return is of, in the world frame.
struct Lidar::Seen {
  Eigen::Vector3f direction;  ///< unit, from the beam's origin
  double distance = 0.0;      ///< m, in that direction
  Eigen::Vector3f normal;
  std::uint32_t triangle = 0;  ///< or a class, see PointTruth
  double cosine = 1.0;         ///< of the incidence
  double reflectivity = 0.5;
};

/// Working data of a block of shots of a scan.
struct Lidar::Block {
  Time begin{0};       ///< of the scan
  double drift = 0.0;  ///< bias of all ranges in the scan, m
  std::span<const Beam> shots;
  std::uint64_t first_ray = 0;  ///< number of the first shot since the sensor's start
  Point* points = nullptr;      ///< space for the maximum number of points
  PointTruth* truth = nullptr;  ///< same size, or nullptr
  std::size_t count = 0;        ///< number of points so far
  // Reused from block to block to avoid reallocation.
  std::vector<std::uint32_t> places;  ///< index in `rays` of each shot's first sub-ray
  std::vector<world::Ray> rays;       ///< in casting order
  std::vector<world::Hit> hits;
  NormalPairs range_noise;      ///< of the first echoes; two consecutive shots share a pair
  NormalPairs direction_noise;  ///< to the left and upwards, by shot
  // Of the current shot.
  double axis_to_origin = 0.0;  ///< m; ranges are measured from the sensor's axis
  std::vector<Echo> parts;      ///< Echo::sub_ray beyond the sub-rays counts in `beyond`
  std::vector<PathEnd> ends;
  std::vector<Seen> beyond;
  std::vector<Air::Return> air;
  std::vector<world::Ray> glare;  ///< beside the beam
  std::vector<world::Hit> glare_hits;
  std::vector<Echo> halo;
  std::vector<Echo> echoes;
};

}  // namespace lidarena::sensor
