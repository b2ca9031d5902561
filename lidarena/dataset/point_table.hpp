// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace lidarena {

enum class ScalarType {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64
};
/// Bytes of one value.
std::size_t size_of(ScalarType type);
inline bool is_integer(ScalarType type) { return type < ScalarType::kFloat32; }

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

/// Appends `word` in the binary form of `type`; false if it is not a number of that type (NaN and
/// infinity are valid floats).
bool append_scalar(std::string& bytes, ScalarType type, std::string_view word);

/// Reads .ply or .pcd, chosen by the extension. Throws InputError naming file, place and remedy.
PointTable read_point_table(const std::filesystem::path& file);

}  // namespace lidarena
