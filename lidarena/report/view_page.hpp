// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "lidarena/report/scene.hpp"
#include "lidarena/report/scene_blocks.hpp"

namespace lidarena {

/// Whether this build carries the interactive view.
bool has_viewer();

/// The scene from above as a picture, for where the interactive view cannot run: the clouds that
/// are visible at first (or the mesh's corners) and all paths.
std::string scene_picture(const Scene& scene);

/// Writes one self-contained HTML file that shows the scene. `picture` stands in it until the view
/// has started, and where WebGL is missing. Throws Error when this build has no viewer, or the disk
/// is full.
void write_view_page(const std::filesystem::path& file, const PackedScene& scene,
                     const std::string& picture);

/// The same page with its blocks apart: it fetches block N from "block/N".
std::string served_view_page(const PackedScene& scene, const std::string& picture);

/// JSON that may stand inside a <script> element.
std::string script_json(const Json& json);

}  // namespace lidarena
