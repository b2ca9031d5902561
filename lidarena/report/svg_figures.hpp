// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace lidarena::report {

/// Draws every picture and chart of the report's page as an SVG file in `folder`, by running the
/// bundled script in Node.js. False if Node.js is missing or the script fails; the page itself
/// draws the same in any case.
bool draw_svg_figures(const std::filesystem::path& page, const std::filesystem::path& folder);

}  // namespace lidarena::report
