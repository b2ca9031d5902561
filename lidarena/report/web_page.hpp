// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/report/scene_blocks.hpp"

namespace lidarena::report {

/// A page that a script of the bundle draws from its data.
struct WebPage {
  std::string title;
  std::string script;               ///< "report" or "view"
  Json data;                        ///< element `data`; null = none
  std::vector<PackedScene> scenes;  ///< headers: elements scene-0, ...; blocks: block-0-0, ...
};

/// Whether this build contains the pages' scripts.
bool has_viewer();

/// Writes one self-contained HTML file. Throws Error if this build has no viewer or the disk is
/// full.
void write_page(const std::filesystem::path& file, const WebPage& page);

/// The same page without the blocks; it fetches block N of the first scene from "block/N".
std::string served_page(const WebPage& page);

/// `text` escaped for HTML and SVG.
std::string escaped(std::string_view text);

}  // namespace lidarena::report
