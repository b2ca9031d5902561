// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/scalar_type.hpp"

namespace lidarena::dataset {

/// One named value of each point: value i starts at byte `offset + i * stride`.
struct Column {
  std::string name;  ///< lower case
  ScalarType type = ScalarType::kFloat32;
  std::size_t offset = 0;
  std::size_t stride = 0;
};

/// Points as a file stores them (little endian), with any columns.
struct PointTable {
  std::string file;   ///< for messages
  std::string bytes;  ///< holds every value of every column
  std::size_t size = 0;
  std::vector<Column> columns;

  /// The first of `names` that is a column; nullptr if none is.
  const Column* find(std::initializer_list<std::string_view> names) const;
  /// The column `name`; throws InputError listing the existing columns if there is none.
  const Column& require(std::string_view name) const;
  double number(const Column& column, std::size_t row) const;
  /// Exact value in a column of integers.
  std::int64_t integer(const Column& column, std::size_t row) const;
};

/// Reads .ply or .pcd, chosen by the extension. Throws InputError naming file, place and remedy.
PointTable read_point_table(const std::filesystem::path& file);

}  // namespace lidarena::dataset
