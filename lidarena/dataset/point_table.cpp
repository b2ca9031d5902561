// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/point_table.hpp"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/pcd.hpp"
#include "lidarena/dataset/ply.hpp"
#include "lidarena/dataset/text_file.hpp"

static_assert(std::endian::native == std::endian::little, "point files are read in place");

namespace lidarena {
namespace {

/// Calls `visit` with a value of the C++ type of `type`.
template <class Visit>
auto with_type(ScalarType type, Visit&& visit) {
  switch (type) {
    case ScalarType::kInt8:
      return visit(std::int8_t{});
    case ScalarType::kUint8:
      return visit(std::uint8_t{});
    case ScalarType::kInt16:
      return visit(std::int16_t{});
    case ScalarType::kUint16:
      return visit(std::uint16_t{});
    case ScalarType::kInt32:
      return visit(std::int32_t{});
    case ScalarType::kUint32:
      return visit(std::uint32_t{});
    case ScalarType::kInt64:
      return visit(std::int64_t{});
    case ScalarType::kUint64:
      return visit(std::uint64_t{});
    case ScalarType::kFloat32:
      return visit(float{});
    case ScalarType::kFloat64:
      break;
  }
  return visit(double{});
}

template <class T>
T value_at(const PointTable& table, const Column& column, std::size_t row) {
  T value;
  std::memcpy(&value, table.bytes.data() + column.offset + row * column.stride, sizeof(T));
  return value;
}

/// Integers may be written as "12.0"; everything else must be a number in the range of T.
template <class T>
bool parse_scalar(std::string_view word, T& out) {
  if constexpr (std::is_integral_v<T>) {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out);
    if (error == std::errc{} && end == word.data() + word.size()) return true;
    const auto value = parse_double(word);
    // a double holds every T of up to 4 bytes exactly; wider integers must be written as integers
    if (sizeof(T) > 4 || !value || *value != std::floor(*value) ||
        *value < static_cast<double>(std::numeric_limits<T>::min()) ||
        *value > static_cast<double>(std::numeric_limits<T>::max())) {
      return false;
    }
    out = static_cast<T>(*value);
    return true;
  } else {
    const auto value = parse_double(word);
    if (!value) return false;
    out = static_cast<T>(*value);
    return true;
  }
}

}  // namespace

std::size_t size_of(ScalarType type) {
  return with_type(type, [](auto value) { return sizeof(value); });
}

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
  std::string there;
  for (const Column& column : columns) there += (there.empty() ? "" : " ") + column.name;
  throw InputError(file, fmt::format("has no field '{}'", name),
                   fmt::format("points need x, y, z; it has: {}", there));
}

double PointTable::number(const Column& column, std::size_t row) const {
  return with_type(column.type, [&](auto type) {
    return static_cast<double>(value_at<decltype(type)>(*this, column, row));
  });
}

std::int64_t PointTable::integer(const Column& column, std::size_t row) const {
  return with_type(column.type, [&](auto type) {
    return static_cast<std::int64_t>(value_at<decltype(type)>(*this, column, row));
  });
}

bool append_scalar(std::string& bytes, ScalarType type, std::string_view word) {
  return with_type(type, [&](auto value) {
    if (!parse_scalar(word, value)) return false;
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
    return true;
  });
}

PointTable read_point_table(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  if (ending == ".ply") return read_ply_table(file);
  if (ending == ".pcd") return read_pcd_table(file);
  throw InputError(file.string(), fmt::format("'{}' is not a supported point format", ending),
                   "give a .ply or .pcd file");
}

}  // namespace lidarena
