// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_slam/keyframes.hpp"

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::arena_slam {
namespace {

/// With more scans than one, a keyframe is renewed when it has these numbers of them.
bool is_renewal(int scans) { return scans == 4 || scans == 16 || scans == 64; }

}  // namespace

bool is_keyframe(const Keyframe& last, const Pose& world_from_lidar, const Config& config) {
  const Pose moved = last.world_from_lidar.inverse() * world_from_lidar;
  return moved.translation().norm() >= config.keyframe_translation_m ||
         so3::log(moved.linear()).cwiseAbs().maxCoeff() >= config.keyframe_rotation_rad;
}

void KeyframeMerger::begin(const Features& features) {
  all_ = features;
  scans_ = 1;
}

bool KeyframeMerger::add(const Features& features, const Pose& keyframe_from_lidar,
                         const Config& config) {
  if (scans_ >= config.scans_per_keyframe) return false;
  map::append_placed(keyframe_from_lidar, features.edges, all_.edges);
  map::append_placed(keyframe_from_lidar, features.surfaces, all_.surfaces);
  ++scans_;
  return is_renewal(scans_);
}

void FeatureMap::follow(const std::vector<Keyframe>& keyframes, Time now, const Config& config) {
  std::vector<map::KeyframePlace> places;
  for (const Keyframe& keyframe : keyframes)
    places.push_back({keyframe.stamp, keyframe.world_from_lidar.translation()});
  select(keyframes, map::surrounding(places, places.back().position, now,
                                     {config.submap_radius_m, config.submap_keyframe_spacing_m,
                                      config.submap_recent_s}));
}

void FeatureMap::select(const std::vector<Keyframe>& keyframes,
                        const std::vector<std::uint32_t>& chosen) {
  const auto revision = [&](std::uint32_t i) { return keyframes[i].revision; };
  const auto placed = [&](std::vector<Eigen::Vector3f> Features::*kind) {
    return [&keyframes, kind](std::uint32_t i) {
      std::vector<Eigen::Vector3f> points;
      map::append_placed(keyframes[i].world_from_lidar, keyframes[i].features.*kind, points);
      return points;
    };
  };
  edges.select(chosen, revision, placed(&Features::edges));
  surfaces.select(chosen, revision, placed(&Features::surfaces));
}

}  // namespace lidarena::odometry::arena_slam
