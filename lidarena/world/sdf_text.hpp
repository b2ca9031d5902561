// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace lidarena {

/// The part of an SDF text that can have a surface: the same text with elements such as <scene>,
/// <physics>, <gui>, <plugin>, <material> and <state> blanked out, line breaks kept. Strict SDF
/// readers refuse a whole world for a color out of range in one of these; Gazebo Classic does not.
/// An element that is never closed stays, for the parser to complain about.
std::string without_unseen_elements(std::string sdf_text);

}  // namespace lidarena
