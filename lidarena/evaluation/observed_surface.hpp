// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/event.hpp"
#include "lidarena/dataset/point_truth.hpp"
#include "lidarena/evaluation/signed_distance.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {

/// The part of the mesh that the flight's rays really hit, and from which side.
struct ObservedSurface {
  static constexpr double kVoxel_m = 0.02;
  /// True hits, the first of each 2 cm voxel: m, offsets from the mesh's center (center_of()).
  std::vector<Eigen::Vector3f> hits;
  /// One a triangle. Free space is on the side that the rays came from; a triangle of which more
  /// than 5 % of the hits are on the other side has none.
  std::vector<FreeSide> free_side;
  std::size_t returns = 0;   ///< looked at
  std::size_t off_mesh = 0;  ///< of the voxels' first: not explained by this mesh, left out
};

/// From what the simulator noted of each return.
ObservedSurface observe(ScanTruthSource& truth, const World& world, const Parallel& parallel);

/// From the measurements alone: each return's ray, laid by the true motion, is cast again. Returns
/// whose ray meets the mesh more than 0.5 m from where they are count as off the mesh.
ObservedSurface observe(EventSource& events, const std::string& lidar_id,
                        const Pose& body_from_lidar, const Trajectory& truth, const World& world,
                        const Parallel& parallel);

}  // namespace lidarena
