// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "lidarena/results/run_record.hpp"

namespace lidarena::report {

/// One SVG element, which is shown in the page and also written as a file.
struct Picture {
  std::string id;  ///< name of its file
  std::string svg;
};

/// Pictures of a world from above, which need no WebGL.
struct WorldPictures {
  std::string world;
  std::vector<Picture> place;  ///< mesh with the flight; example scans, de-skewed and skewed
  std::vector<Picture> maps;   ///< of shown_rows(), with the paths
};

/// The first run with status ok for each sensor, algorithm and variant_of() of a world.
std::vector<const results::RunRecord*> first_seed_rows(const results::StudyResults& results,
                                                       const std::string& world);

/// The pictures of every world, as far as the folders still hold their files.
std::vector<WorldPictures> draw_pictures(const results::StudyResults& results);

}  // namespace lidarena::report
