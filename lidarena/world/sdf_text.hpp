// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace lidarena::world {

/// The SDF text without elements that have no surface: <scene>, <physics>, <gui>, <plugin>,
/// <material>, <state> and others are overwritten by blanks; line breaks are kept. Strict SDF
/// readers reject a whole world for a color out of range in one of these; Gazebo Classic does not.
/// An element that is not closed is kept, so that the parser reports it.
std::string without_non_geometric_elements(std::string sdf_text);

}  // namespace lidarena::world
