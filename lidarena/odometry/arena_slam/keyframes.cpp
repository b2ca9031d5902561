// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_slam/keyframes.hpp"

#include <algorithm>

#include "lidarena/base/so3.hpp"
#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::odometry::arena_slam {
namespace {

void append(std::vector<Eigen::Vector3f>& all, const std::vector<Eigen::Vector3f>& points,
            const Pose& pose) {
  const Eigen::Isometry3f moved = pose.cast<float>();
  for (const Eigen::Vector3f& p : points) all.push_back(moved * p);
}

/// The keyframe's features in the world frame.
Features placed(const Keyframe& keyframe) {
  Features in_world;
  append(in_world.edges, keyframe.features.edges, keyframe.world_from_lidar);
  append(in_world.surfaces, keyframe.features.surfaces, keyframe.world_from_lidar);
  return in_world;
}

}  // namespace

bool is_keyframe(const Keyframe& last, Time stamp, const Pose& world_from_lidar,
                 const Config& config) {
  const Pose moved = last.world_from_lidar.inverse() * world_from_lidar;
  const bool old = config.keyframe_interval_s > 0.0 &&
                   to_seconds(stamp - last.stamp) > config.keyframe_interval_s;
  return old || moved.translation().norm() >= config.keyframe_translation_m ||
         so3::log(moved.linear()).cwiseAbs().maxCoeff() >= config.keyframe_rotation_rad;
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
  for (const std::uint32_t i : map::first_of_each_voxel(places, config.submap_keyframe_spacing_m))
    chosen.push_back(near[i]);
  for (const std::uint32_t i : near) {
    if (to_seconds(now - keyframes[i].stamp) < config.submap_recent_s) chosen.push_back(i);
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

void Submap::select(const std::vector<Keyframe>& keyframes,
                    const std::vector<std::uint32_t>& chosen) {
  const auto stays = [&](const auto& part) {
    return part.second.revision == keyframes[part.first].revision &&
           std::binary_search(chosen.begin(), chosen.end(), part.first);
  };
  bool changed = false;
  if (std::none_of(parts_.begin(), parts_.end(), stays)) {  // for example after a loop moved all
    changed = !parts_.empty();
    parts_.clear();
    edges_.clear();
    surfaces_.clear();
  }
  for (auto part = parts_.begin(); part != parts_.end();) {
    if (stays(*part)) {
      ++part;
      continue;
    }
    const Part& held = part->second;
    edges_.remove(held.placed.edges);
    surfaces_.remove(held.placed.surfaces);
    part = parts_.erase(part);
    changed = true;
  }
  for (const std::uint32_t i : chosen) {
    const auto [part, is_new] = parts_.try_emplace(i);
    if (!is_new) continue;
    part->second = {keyframes[i].revision, placed(keyframes[i])};
    edges_.add(part->second.placed.edges);
    surfaces_.add(part->second.placed.surfaces);
    changed = true;
  }
  if (!changed) return;
  map_.edges.build(edges_.means());
  map_.surfaces.build(surfaces_.means());
}

std::uint64_t Submap::memory_bytes() const {
  std::uint64_t bytes = map_.edges.memory_bytes() + map_.surfaces.memory_bytes() +
                        edges_.memory_bytes() + surfaces_.memory_bytes();
  for (const auto& [keyframe, part] : parts_) {
    bytes += sizeof(Part) + sizeof(Eigen::Vector3f) *
                                (part.placed.edges.capacity() + part.placed.surfaces.capacity());
  }
  return bytes;
}

}  // namespace lidarena::odometry::arena_slam
