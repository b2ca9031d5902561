// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace lidarena {

static_assert(std::endian::native == std::endian::little, "binary files are read in place");

/// Type of a number in a binary file.
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
inline bool is_integer(ScalarType type) { return type < ScalarType::kFloat32; }

/// Calls `visit` with a zero of the C++ type of `type`.
template <class Visit>
auto with_scalar_type(ScalarType type, Visit&& visit) {
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

/// Bytes of one value.
std::size_t size_of(ScalarType type);

/// Appends `word` in the binary form of `type`; false if it is not a number of that type. NaN and
/// infinity are valid floats; integers of up to 4 bytes may be written as "12.0".
bool append_scalar(std::string& bytes, ScalarType type, std::string_view word);

}  // namespace lidarena
