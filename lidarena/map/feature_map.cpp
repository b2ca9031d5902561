// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/feature_map.hpp"

#include "lidarena/base/so3.hpp"
#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::map {

Features thinned(const Features& features, const FeatureVoxels& voxels) {
  return {voxel_means(features.edges, voxels.edge_size_m),
          voxel_means(features.surfaces, voxels.surface_size_m)};
}

bool has_moved(const Keyframe& keyframe, const Pose& world_from_lidar, double translation,
               double rotation) {
  const Pose moved = keyframe.world_from_lidar.inverse() * world_from_lidar;
  return moved.translation().norm() >= translation ||
         so3::log(moved.linear()).cwiseAbs().maxCoeff() >= rotation;
}

void move_to(const std::vector<Pose>& world_from_lidar, std::vector<Keyframe>& keyframes) {
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    keyframes[i].world_from_lidar = world_from_lidar[i];
    ++keyframes[i].revision;
  }
}

std::vector<Eigen::Vector3f> points_of(const std::vector<Keyframe>& keyframes) {
  std::vector<Eigen::Vector3f> points;
  for (const Keyframe& keyframe : keyframes) {
    append_transformed(keyframe.world_from_lidar, keyframe.features.edges, points);
    append_transformed(keyframe.world_from_lidar, keyframe.features.surfaces, points);
  }
  return points;
}

std::uint64_t memory_bytes(const std::vector<Keyframe>& keyframes) {
  std::uint64_t points = 0;
  for (const Keyframe& keyframe : keyframes)
    points += keyframe.features.edges.capacity() + keyframe.features.surfaces.capacity();
  return keyframes.size() * sizeof(Keyframe) + points * sizeof(Eigen::Vector3f);
}

void FeatureMap::follow(const std::vector<Keyframe>& keyframes, Time now,
                        const SubmapExtent& extent) {
  std::vector<KeyframePlace> places;
  for (const Keyframe& keyframe : keyframes)
    places.push_back({keyframe.stamp, keyframe.world_from_lidar.translation()});
  select(keyframes, surrounding(places, places.back().position, now, extent));
}

void FeatureMap::select(const std::vector<Keyframe>& keyframes,
                        const std::vector<std::uint32_t>& chosen) {
  const auto revision = [&](std::uint32_t i) { return keyframes[i].revision; };
  const auto placed = [&](std::vector<Eigen::Vector3f> Features::*kind) {
    return [&keyframes, kind](std::uint32_t i) {
      std::vector<Eigen::Vector3f> points;
      append_placed(keyframes[i].world_from_lidar, keyframes[i].features.*kind, points);
      return points;
    };
  };
  edges.select(chosen, revision, placed(&Features::edges));
  surfaces.select(chosen, revision, placed(&Features::surfaces));
}

}  // namespace lidarena::map
