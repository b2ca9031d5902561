// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/report/scene.hpp"

namespace lidarena::report {

/// A scene packed for a browser; viewer/src/view/scene.ts describes the header.
struct PackedScene {
  Json header;
  std::vector<std::string> blocks;  ///< little endian
};

/// Packs a scene. Points are grouped into boxes of at most 65,536 points that lie together, with 16
/// bits per coordinate inside the box (a box of 10 m: steps of 0.15 mm) and 16 bits per field. The
/// points of a box are in random order, and block p of a cloud holds the p-th part of every box, so
/// that the first block shows the whole cloud and any prefix is an unbiased sample. Points that are
/// not finite are left out. The same scene gives the same bytes on any number of threads.
PackedScene pack(const Scene& scene, const Parallel& parallel);

}  // namespace lidarena::report
