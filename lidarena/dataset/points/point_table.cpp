// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/points/point_table.hpp"

#include <fmt/format.h>

#include <cstring>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/points/pcd.hpp"
#include "lidarena/dataset/points/ply.hpp"

namespace lidarena::dataset {
namespace {

template <class T>
T value_at(const PointTable& table, const Column& column, std::size_t row) {
  T value;
  std::memcpy(&value, table.bytes.data() + column.offset + row * column.stride, sizeof(T));
  return value;
}

}  // namespace

const Column* PointTable::find(std::initializer_list<std::string_view> names) const {
  for (const std::string_view name : names) {
    for (const Column& column : columns) {
      if (column.name == name) return &column;
    }
  }
  return nullptr;
}

const Column& PointTable::require(std::string_view name) const {
  if (const Column* column = find({name})) return *column;
  std::string existing;
  for (const Column& column : columns) existing += (existing.empty() ? "" : " ") + column.name;
  throw InputError(file, fmt::format("has no field '{}'", name),
                   fmt::format("points need x, y, z; it has: {}", existing));
}

double PointTable::number(const Column& column, std::size_t row) const {
  return with_scalar_type(column.type, [&](auto type) {
    return static_cast<double>(value_at<decltype(type)>(*this, column, row));
  });
}

std::int64_t PointTable::integer(const Column& column, std::size_t row) const {
  return with_scalar_type(column.type, [&](auto type) {
    return static_cast<std::int64_t>(value_at<decltype(type)>(*this, column, row));
  });
}

PointTable read_point_table(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  if (ending == ".ply") return read_ply_table(file);
  if (ending == ".pcd") return read_pcd_table(file);
  throw InputError(file.string(), fmt::format("'{}' is not a supported point format", ending),
                   "give a .ply or .pcd file");
}

}  // namespace lidarena::dataset
