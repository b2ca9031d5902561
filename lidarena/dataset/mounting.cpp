// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/mounting.hpp"

#include <algorithm>
#include <array>

namespace lidarena::dataset {
namespace {

/// ROS 1 allowed a leading slash.
std::string bare(std::string frame) {
  if (frame.starts_with('/')) frame.erase(0, 1);
  return frame;
}

}  // namespace

void StaticFrames::add(const ros::StampedTransform& transform) {
  ros::StampedTransform added = transform;
  added.parent = bare(added.parent);
  added.child = bare(added.child);
  if (added.parent != added.child) parents_[added.child] = added;
}

bool StaticFrames::contains(const std::string& frame) const {
  return std::ranges::any_of(parents_, [name = bare(frame)](const auto& entry) {
    return entry.first == name || entry.second.parent == name;
  });
}

std::vector<std::string> StaticFrames::path_to_root(const std::string& frame) const {
  std::vector<std::string> path{bare(frame)};
  for (auto up = parents_.find(path.back()); up != parents_.end();
       up = parents_.find(path.back())) {
    if (std::ranges::find(path, up->second.parent) != path.end()) break;  // a loop has no root
    path.push_back(up->second.parent);
  }
  return path;
}

Pose StaticFrames::root_from(const std::string& frame) const {
  const std::vector<std::string> path = path_to_root(frame);
  Pose root_from_frame = Pose::Identity();
  for (std::size_t i = path.size() - 1; i-- > 0;)
    root_from_frame = root_from_frame * parents_.at(path[i]).parent_from_child;
  return root_from_frame;
}

std::optional<Pose> StaticFrames::find(const std::string& reference,
                                       const std::string& frame) const {
  if (path_to_root(reference).back() != path_to_root(frame).back()) return std::nullopt;
  return root_from(reference).inverse() * root_from(frame);
}

std::string StaticFrames::body_of(const std::string& frame) const {
  static constexpr std::array kBodies{"base_link", "base_footprint", "base", "body"};
  static constexpr std::array kWorlds{"map", "odom", "world", "earth", "camera_init"};
  const std::vector<std::string> path = path_to_root(frame);
  for (const char* body : kBodies) {
    const bool is_above = std::ranges::find(path, body) != path.end();
    const bool is_sibling = parents_.contains(body) && path_to_root(body).back() == path.back();
    if (is_above || is_sibling) return body;
  }
  const bool is_in_world =
      path.size() > 1 && std::ranges::find(kWorlds, path.back()) != kWorlds.end();
  return is_in_world ? path[path.size() - 2] : path.back();
}

}  // namespace lidarena::dataset
