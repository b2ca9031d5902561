// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace lidarena::report {

/// Draws every figure of the report as an SVG file in `folder` from the charts' data (a JSON file),
/// by running the bundled script in Node.js. False if the build has no bundle, Node.js is missing
/// or the script fails; the page itself draws the same figures in any case.
bool draw_svg_figures(const std::filesystem::path& data, const std::filesystem::path& folder);

}  // namespace lidarena::report
