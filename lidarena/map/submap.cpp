// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/submap.hpp"

#include <algorithm>

#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::map {

std::vector<std::uint32_t> surrounding(std::span<const KeyframePlace> keyframes,
                                       const Eigen::Vector3d& position, Time now,
                                       const SubmapExtent& extent) {
  std::vector<std::uint32_t> near;
  std::vector<Eigen::Vector3f> places;
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    if ((keyframes[i].position - position).norm() > extent.radius_m) continue;
    near.push_back(static_cast<std::uint32_t>(i));
    places.push_back(keyframes[i].position.cast<float>());
  }
  std::vector<std::uint32_t> chosen;
  for (const std::uint32_t i : first_of_each_voxel(places, extent.keyframe_spacing_m))
    chosen.push_back(near[i]);
  for (const std::uint32_t i : near) {
    if (to_seconds(now - keyframes[i].stamp) < extent.recent_s) chosen.push_back(i);
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

void append_placed(const Pose& frame_from_keyframe, std::span<const Eigen::Vector3f> points,
                   std::vector<Eigen::Vector3f>& out) {
  const Eigen::Isometry3f moved = frame_from_keyframe.cast<float>();
  for (const Eigen::Vector3f& p : points) out.push_back(moved * p);
}

void Submap::select(std::span<const std::uint32_t> chosen, const RevisionOf& revision_of,
                    const Placed& placed) {
  const auto stays = [&](const auto& part) {
    return part.second.revision == revision_of(part.first) &&
           std::binary_search(chosen.begin(), chosen.end(), part.first);
  };
  bool changed = false;
  if (std::none_of(parts_.begin(), parts_.end(), stays)) {  // for example after a loop moved all
    changed = !parts_.empty();
    parts_.clear();
    sums_.clear();
  }
  for (auto part = parts_.begin(); part != parts_.end();) {
    if (stays(*part)) {
      ++part;
      continue;
    }
    sums_.remove(part->second.points);
    part = parts_.erase(part);
    changed = true;
  }
  for (const std::uint32_t keyframe : chosen) {
    const auto [part, is_new] = parts_.try_emplace(keyframe);
    if (!is_new) continue;
    part->second = {revision_of(keyframe), placed(keyframe)};
    sums_.add(part->second.points);
    changed = true;
  }
  if (changed) tree_.build(sums_.means());
}

std::uint64_t Submap::memory_bytes() const {
  std::uint64_t bytes = tree_.memory_bytes() + sums_.memory_bytes();
  for (const auto& [keyframe, part] : parts_)
    bytes += sizeof(Part) + sizeof(Eigen::Vector3f) * part.points.capacity();
  return bytes;
}

}  // namespace lidarena::map
