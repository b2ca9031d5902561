// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/pose.hpp"

namespace lidarena::world {

/// Where Gazebo Classic had its models when it saved a world: the <state> beside them. All poses
/// are in the world frame.
struct SavedState {
  std::map<std::string, Pose> models;  ///< by name; nested ones as "outer::inner"
  std::map<std::string, Pose> links;   ///< by name, as "model::link"
  bool has_scales = false;             ///< a model was scaled, which is not applied
};

/// The last <state> of a world; empty when the text has none. Poses that are not six numbers are
/// ignored.
SavedState saved_state(std::string_view sdf_text);

/// What a world holds that this program does not place, each with its count: "2 <road>". Lights and
/// other elements without a surface are not counted.
std::vector<std::string> unsupported_elements(std::string_view sdf_text);

}  // namespace lidarena::world
