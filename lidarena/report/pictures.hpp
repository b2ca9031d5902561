// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "lidarena/report/result_table.hpp"

namespace lidarena {

/// One SVG element that stands in the page and, as a file, alone.
struct Picture {
  std::string id;  ///< name of its file
  std::string svg;
};

/// What can be seen of a world from above without WebGL.
struct WorldPictures {
  std::string world;
  std::vector<Picture> place;  ///< the mesh with the flight, example scans whole and skewed
  std::vector<Picture> maps;   ///< of shown_rows(), with the paths
};

/// The first seed of each sensor, algorithm and reading of a world that went well.
std::vector<const ResultRow*> shown_rows(const Results& results, const std::string& world);

/// Of every world what its folders still hold.
std::vector<WorldPictures> draw_pictures(const Results& results);

}  // namespace lidarena
