// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "lidarena/report/scene.hpp"
#include "lidarena/report/scene_blocks.hpp"

namespace lidarena::report {

/// Whether this build contains the interactive view.
bool has_viewer();

/// A picture of the scene from above, for browsers that cannot run the interactive view: the clouds
/// that are visible at first (or the meshes' vertices if there are none), the truth and one path.
std::string scene_picture(const Scene& scene);

/// Writes one self-contained HTML file that shows the scene. It shows `picture` until the view has
/// started, or if WebGL is missing. Throws Error if this build has no viewer or the disk is full.
void write_view_page(const std::filesystem::path& file, const PackedScene& scene,
                     const std::string& picture);

/// The same page without the blocks; it fetches block N from "block/N".
std::string served_view_page(const PackedScene& scene, const std::string& picture);

/// The text of `json`, escaped so that it can be embedded in a <script> element.
std::string script_json(const Json& json);

}  // namespace lidarena::report
