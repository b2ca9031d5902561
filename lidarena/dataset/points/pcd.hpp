// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "lidarena/dataset/points/point_table.hpp"

namespace lidarena::dataset {

/// The points of a PCD file (ascii, binary, binary_compressed) with all their fields. Points are
/// returned as stored: VIEWPOINT is not applied. The number of points is POINTS or, without it,
/// WIDTH * HEIGHT (which some writers leave zero). Padding after the points is ignored. Throws
/// InputError naming the file and the line or byte.
PointTable read_pcd_table(const std::filesystem::path& file);
/// The same from the bytes of a file; `name` is the file's name in messages.
PointTable parse_pcd_table(std::string_view bytes, const std::string& name);

}  // namespace lidarena::dataset
