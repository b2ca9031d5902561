// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "lidarena/base/point_truth.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/evaluation/map/lidar_poses.hpp"
#include "lidarena/evaluation/map/signed_distance.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::evaluation {

/// The part of the mesh that the flight's rays really hit, and from which side.
struct ObservedSurface {
  static constexpr double kVoxel_m = 0.02;
  /// True hits, the first of each 2 cm voxel: m, offsets from the mesh's center (center_of()).
  std::vector<Eigen::Vector3f> hits;
  /// One per triangle. Free space is on the side that the rays came from; unknown for a triangle
  /// with more than 5 % of its hits from the other side.
  std::vector<FreeSide> free_side;
  std::size_t returns = 0;   ///< number of processed returns
  std::size_t off_mesh = 0;  ///< first hits of voxels that do not lie on this mesh; left out
};

/// From the true hits that the simulator recorded for each return.
ObservedSurface observe(ScanTruthSource& truth, const world::World& world,
                        const Parallel& parallel);

/// A return in the LiDAR's frame at its own instant.
struct TimedReturn {
  Time stamp{0};
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m
};

/// The returns of which a map with origins was made, by the motion that placed them.
std::vector<TimedReturn> returns_of(const dataset::Cloud& map, const BodyMotion& motion,
                                    const Pose& body_from_lidar);

/// From the measurements only: each return's ray, placed by the true motion, is cast again. Returns
/// whose ray hits the mesh more than 0.5 m from the measured range count as off the mesh.
ObservedSurface observe(std::span<const TimedReturn> returns, const Pose& body_from_lidar,
                        const Trajectory& truth, const world::World& world,
                        const Parallel& parallel);

}  // namespace lidarena::evaluation
