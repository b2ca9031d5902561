// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "lidarena/dataset/points/point_table.hpp"

namespace lidarena::dataset {

/// The vertices of a PLY file (ASCII or binary) with all their properties; other
/// elements are skipped. Bytes after the vertices are ignored. Throws InputError naming the file
/// and the line or byte.
PointTable read_ply_table(const std::filesystem::path& file);
/// The same from the bytes of a file; `name` is the file's name in messages.
PointTable parse_ply_table(std::string_view bytes, const std::string& name);

}  // namespace lidarena::dataset
