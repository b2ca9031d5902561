// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/keyframes.hpp"

#include <algorithm>

#include "lidarena/base/so3.hpp"
#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::lio_sam {
namespace {

void append(std::vector<Eigen::Vector3f>& all, const std::vector<Eigen::Vector3f>& points,
            const Pose& pose) {
  const Eigen::Isometry3f moved = pose.cast<float>();
  for (const Eigen::Vector3f& p : points) all.push_back(moved * p);
}

}  // namespace

bool is_keyframe(const Keyframe& last, Time stamp, const Pose& world_from_lidar,
                 const Config& config) {
  const Pose moved = last.world_from_lidar.inverse() * world_from_lidar;
  const bool old =
      config.keyframe_age_s > 0.0 && to_seconds(stamp - last.stamp) > config.keyframe_age_s;
  return old || moved.translation().norm() >= config.keyframe_distance_m ||
         so3::log(moved.linear()).cwiseAbs().maxCoeff() >= config.keyframe_angle_rad;
}

void KeyframeMerger::begin(const Features& features) {
  all_ = features;
  scans_ = 1;
}

bool KeyframeMerger::add(const Features& features, const Pose& keyframe_from_lidar,
                         const Config& config) {
  if (scans_ >= config.scans_per_keyframe) return false;
  append(all_.edges, features.edges, keyframe_from_lidar);
  append(all_.surfaces, features.surfaces, keyframe_from_lidar);
  ++scans_;
  return scans_ == 4 || scans_ == 16 || scans_ == 64;
}

std::vector<std::uint32_t> surrounding(const std::vector<Keyframe>& keyframes,
                                       const Eigen::Vector3d& position, Time now,
                                       const Config& config) {
  std::vector<std::uint32_t> near;
  std::vector<Eigen::Vector3f> places;
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const Eigen::Vector3d place = keyframes[i].world_from_lidar.translation();
    if ((place - position).norm() > config.submap_radius_m) continue;
    near.push_back(static_cast<std::uint32_t>(i));
    places.push_back(place.cast<float>());
  }
  std::vector<std::uint32_t> chosen;
  for (const std::uint32_t i : first_of_each_voxel(places, config.submap_density_m))
    chosen.push_back(near[i]);
  for (const std::uint32_t i : near) {
    if (to_seconds(now - keyframes[i].stamp) < config.submap_recent_s) chosen.push_back(i);
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

void Submap::select(const std::vector<Keyframe>& keyframes, std::vector<std::uint32_t> chosen,
                    std::uint64_t revision, const Config& config) {
  if (chosen == chosen_ && revision == revision_) return;
  chosen_ = std::move(chosen);
  revision_ = revision;
  Features all;
  for (const std::uint32_t i : chosen_) {
    append(all.edges, keyframes[i].features.edges, keyframes[i].world_from_lidar);
    append(all.surfaces, keyframes[i].features.surfaces, keyframes[i].world_from_lidar);
  }
  all = thinned(all, config);
  map_.edges.build(std::move(all.edges));
  map_.surfaces.build(std::move(all.surfaces));
}

std::uint64_t Submap::memory_bytes() const {
  return map_.edges.memory_bytes() + map_.surfaces.memory_bytes();
}

}  // namespace lidarena::lio_sam
