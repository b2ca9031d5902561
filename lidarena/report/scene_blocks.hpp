// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/report/scene.hpp"

namespace lidarena {

/// A scene made small for a browser; viewer/src/view/scene.ts describes the header.
struct PackedScene {
  Json header;
  std::vector<std::string> blocks;  ///< little endian
};

/// Packs a scene. Points are gathered into boxes of at most 65,536 that lie together, 16 bits a
/// coordinate inside the box (a box of 10 m: steps of 0.15 mm) and 16 bits a field. Within a box
/// they stand in random order, and block p of a cloud holds the p-th share of every box, so that
/// the whole cloud shows after its first block and any prefix is a fair sample. Points that are not
/// finite are left out. The same scene gives the same bytes on any number of threads.
PackedScene pack(const Scene& scene, const Parallel& parallel);

}  // namespace lidarena
