// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace lidarena {

/// Draws every figure of the report as an SVG file in `folder` from the charts' data (a JSON file),
/// by the bundled script under Node.js. False where the build has no bundle, Node.js is missing, or
/// the script fails: the page draws the same figures by itself.
bool draw_svg_figures(const std::filesystem::path& data, const std::filesystem::path& folder);

}  // namespace lidarena
