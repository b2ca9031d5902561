// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/keyframes.hpp"

#include <algorithm>
#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::lio_sam {
namespace {

constexpr double kLivoxInterval = 1.0;  // s, maximum age of the last keyframe

/// A keyframe's points in the world.
std::vector<Eigen::Vector3f> in_world(const Keyframe& keyframe,
                                      const std::vector<Eigen::Vector3f>& points) {
  std::vector<Eigen::Vector3f> placed;
  map::append_placed(keyframe.world_from_lidar, points, placed);
  return placed;
}

}  // namespace

bool is_keyframe(const Keyframe& last, Time stamp, const Pose& world_from_lidar,
                 const Config& config) {
  if (config.sensor == Sensor::kLivox && to_seconds(stamp - last.stamp) > kLivoxInterval)
    return true;
  const Pose last_from_this = last.world_from_lidar.inverse() * world_from_lidar;
  const Eigen::Vector3d rotation = so3::log(last_from_this.linear());
  return rotation.cwiseAbs().maxCoeff() >= config.keyframe_rotation_rad ||
         last_from_this.translation().norm() >= config.keyframe_translation_m;
}

void FeatureMap::follow(const std::vector<Keyframe>& keyframes, Time now) {
  std::vector<map::KeyframePlace> places(keyframes.size());
  std::transform(keyframes.begin(), keyframes.end(), places.begin(), [](const Keyframe& k) {
    return map::KeyframePlace{k.stamp, k.world_from_lidar.translation()};
  });
  const std::vector<std::uint32_t> chosen =
      map::surrounding(places, places.back().position, now, extent_);
  const auto revision_of = [&](std::uint32_t i) { return keyframes[i].revision; };
  edges_.select(chosen, revision_of, [&](std::uint32_t i) {
    return in_world(keyframes[i], keyframes[i].features.edges);
  });
  surfaces_.select(chosen, revision_of, [&](std::uint32_t i) {
    return in_world(keyframes[i], keyframes[i].features.surfaces);
  });
}

}  // namespace lidarena::odometry::lio_sam
