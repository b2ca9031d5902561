// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/dataset/messages/ros_messages.hpp"

namespace lidarena::dataset {

/// The frames of a recording's /tf_static: a forest of fixed transforms.
class StaticFrames {
 public:
  /// Later transforms of a frame replace earlier ones.
  void add(const ros::StampedTransform& transform);
  bool contains(const std::string& frame) const;

  /// Pose of `frame` in `reference`; empty when the tree does not connect them.
  std::optional<Pose> find(const std::string& reference, const std::string& frame) const;

  /// The frame of the body that carries `frame`: base_link (or base_footprint, base, body)
  /// if the tree has it, else the root, or the frame below it where the root is a world (map,
  /// odom).
  std::string body_of(const std::string& frame) const;

 private:
  /// `frame` and the frames above it, up to the root.
  std::vector<std::string> path_to_root(const std::string& frame) const;
  Pose root_from(const std::string& frame) const;

  std::map<std::string, ros::StampedTransform> parents_;  ///< by child
};

}  // namespace lidarena::dataset
