// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/base/time.hpp"
#include "lidarena/map/submap.hpp"

/// Edges and surfaces, the features of LOAM and LIO-SAM, of scans and of the map around a sensor.
namespace lidarena::map {

/// Points of a scan for matching with the map (m, LiDAR frame).
struct Features {
  std::vector<Eigen::Vector3f> edges;
  std::vector<Eigen::Vector3f> surfaces;
};

/// Voxels in which features are averaged, in scans and in the map.
struct FeatureVoxels {
  double edge_size_m = 0.0;
  double surface_size_m = 0.0;
};
/// The features averaged in these voxels.
Features thinned(const Features& features, const FeatureVoxels& voxels);

/// A scan kept for the map.
struct Keyframe {
  Time stamp{0};
  Pose world_from_lidar = Pose::Identity();
  Features features;           ///< downsampled
  std::uint32_t revision = 0;  ///< number of changes of pose or features
};

/// Whether a LiDAR at `world_from_lidar` has moved since `keyframe` by a distance (m) or a rotation
/// about an axis (rad).
bool has_moved(const Keyframe& keyframe, const Pose& world_from_lidar, double translation,
               double rotation);

/// Moves the keyframes to these poses, one for each.
void move_to(const std::vector<Pose>& world_from_lidar, std::vector<Keyframe>& keyframes);

/// All edges and surface points, m, world.
std::vector<Eigen::Vector3f> points_of(const std::vector<Keyframe>& keyframes);

std::uint64_t memory_bytes(const std::vector<Keyframe>& keyframes);

/// Map with which a scan is matched: edges and surfaces of keyframes.
struct FeatureMap {
  Submap edges;
  Submap surfaces;

  explicit FeatureMap(const FeatureVoxels& voxels)
      : edges(voxels.edge_size_m), surfaces(voxels.surface_size_m) {}
  /// Selects the keyframes (there must be one) around the last one, for a scan at `now`.
  void follow(const std::vector<Keyframe>& keyframes, Time now, const SubmapExtent& extent);
  /// `chosen`: sorted indices of `keyframes`.
  void select(const std::vector<Keyframe>& keyframes, const std::vector<std::uint32_t>& chosen);
  std::size_t size() const { return edges.size() + surfaces.size(); }
  std::uint64_t memory_bytes() const { return edges.memory_bytes() + surfaces.memory_bytes(); }
};

}  // namespace lidarena::map
