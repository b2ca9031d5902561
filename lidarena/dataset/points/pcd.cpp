// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/points/pcd.hpp"

#include <fmt/format.h>

#include <cstring>
#include <map>
#include <optional>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/points/lzf.hpp"
#include "lidarena/dataset/points/point_file_text.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::dataset {
namespace {

/// Upper limit on the values of one field (COUNT): more than any sensor has, small enough that
/// products do not overflow.
constexpr std::size_t kMaxFieldCount = 1 << 16;

struct HeaderLine {
  std::string place;
  std::vector<std::string_view> values;
};

struct Header {
  std::vector<Field> fields;
  std::size_t points = 0;
  std::string data;  ///< ascii, binary or binary_compressed
};

using HeaderLines = std::map<std::string, HeaderLine, std::less<>>;

HeaderLines header_lines(FileText& text) {
  HeaderLines lines;
  for (;;) {
    auto words = split_words(text.line());
    if (words.empty() || words[0].front() == '#') continue;
    const std::string key(words[0]);
    constexpr std::string_view kKeys =
        " VERSION FIELDS SIZE TYPE COUNT WIDTH HEIGHT VIEWPOINT POINTS DATA ";
    if (kKeys.find(" " + key + " ") == std::string_view::npos) {
      throw InputError(text.place(), fmt::format("'{}' is not a PCD keyword", key),
                       "give a .pcd file, version 0.7");
    }
    words.erase(words.begin());
    lines[key] = {text.place(), words};
    if (key == "DATA") return lines;
  }
}

const HeaderLine& require(const HeaderLines& lines, std::string_view key, const std::string& file) {
  const auto found = lines.find(key);
  if (found == lines.end()) {
    throw InputError(file, fmt::format("the PCD header has no line {}", key));
  }
  return found->second;
}

ScalarType type_of(std::string_view kind, std::string_view size, const std::string& place) {
  using S = ScalarType;
  constexpr std::pair<std::string_view, ScalarType> kTypes[] = {
      {"I1", S::kInt8},    {"U1", S::kUint8},  {"I2", S::kInt16}, {"U2", S::kUint16},
      {"I4", S::kInt32},   {"U4", S::kUint32}, {"I8", S::kInt64}, {"U8", S::kUint64},
      {"F4", S::kFloat32}, {"F8", S::kFloat64}};
  const std::string wanted = std::string(kind) + std::string(size);
  for (const auto& [name, type] : kTypes) {
    if (name == wanted) return type;
  }
  throw InputError(place, fmt::format("TYPE {} with SIZE {} is not a PCD type", kind, size),
                   "types are I, U of 1, 2, 4, 8 bytes and F of 4, 8");
}

std::vector<Field> header_fields(const HeaderLines& lines, const std::string& file) {
  const HeaderLine& names = require(lines, "FIELDS", file);
  const HeaderLine& sizes = require(lines, "SIZE", file);
  const HeaderLine& types = require(lines, "TYPE", file);
  const auto counts = lines.find("COUNT");
  const std::size_t n = names.values.size();
  if (sizes.values.size() != n || types.values.size() != n ||
      (counts != lines.end() && counts->second.values.size() != n)) {
    throw InputError(names.place, "FIELDS, SIZE, TYPE and COUNT differ in length");
  }
  std::vector<Field> fields;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t count =
        counts == lines.end() ? 1 : parse_count(counts->second.values[i], counts->second.place);
    if (count == 0 || count > kMaxFieldCount) {
      throw InputError(counts->second.place, fmt::format("COUNT {} is out of range", count));
    }
    fields.push_back({lower_case(names.values[i]),
                      type_of(types.values[i], sizes.values[i], types.place), count});
  }
  return fields;
}

std::optional<std::size_t> header_count(const HeaderLines& lines, std::string_view key) {
  const auto found = lines.find(key);
  if (found == lines.end()) return std::nullopt;
  const HeaderLine& line = found->second;
  if (line.values.size() != 1)
    throw InputError(line.place, fmt::format("{} must be a single number", key));
  return parse_count(line.values[0], line.place);
}

std::size_t header_points(const HeaderLines& lines, const std::string& file) {
  const auto points = header_count(lines, "POINTS");
  const std::size_t width = header_count(lines, "WIDTH").value_or(0);
  const std::size_t height = header_count(lines, "HEIGHT").value_or(0);
  std::size_t product = 0;
  const bool too_many = __builtin_mul_overflow(width, height, &product);
  if (!points && product == 0) throw InputError(file, "the PCD header has no line POINTS");
  if (too_many || (points && product != 0 && product != *points)) {
    throw InputError(file, fmt::format("WIDTH {} x HEIGHT {} is not POINTS {}", width, height,
                                       points.value_or(0)));
  }
  return points.value_or(product);
}

Header parse_header(FileText& text) {
  const HeaderLines lines = header_lines(text);
  const HeaderLine& data = lines.find("DATA")->second;
  Header header{header_fields(lines, text.name()), header_points(lines, text.name()), ""};
  if (data.values.size() == 1) header.data = data.values[0];
  if (header.data != "ascii" && header.data != "binary" && header.data != "binary_compressed") {
    throw InputError(data.place, fmt::format("DATA '{}' is not supported", header.data),
                     "use ascii, binary or binary_compressed");
  }
  return header;
}

std::size_t take_uint32(FileText& text) {
  std::uint32_t value = 0;
  std::memcpy(&value, text.take(1, sizeof(value)).data(), sizeof(value));
  return value;
}

/// Compressed points are stored field by field: all x, all y, ...
PointTable read_compressed(FileText& text, const Header& header) {
  const std::size_t packed = take_uint32(text);
  const std::size_t expanded = take_uint32(text);
  const std::size_t row = row_size(header.fields);
  const bool fits = row > 0 ? expanded % row == 0 && expanded / row == header.points
                            : header.points == 0 && expanded == 0;
  auto bytes = fits ? expand_lzf(text.take(packed), expanded) : std::nullopt;
  if (!bytes) {
    throw InputError(
        text.name(),
        fmt::format("the compressed data are not {} points of {} bytes", header.points, row),
        "the file is damaged; copy or write it again");
  }
  PointTable table{text.name(), std::move(*bytes), header.points, {}};
  std::size_t offset = 0;
  for (const Field& field : header.fields) {
    const std::size_t stride = field.count * size_of(field.type);
    table.columns.push_back({field.name, field.type, offset, stride});
    offset += stride * header.points;
  }
  return table;
}

}  // namespace

PointTable read_pcd_table(const std::filesystem::path& file) {
  return parse_pcd_table(read_bytes(file), file.string());
}

PointTable parse_pcd_table(std::string_view bytes, const std::string& name) {
  FileText text(bytes, name);
  const Header header = parse_header(text);
  if (header.data == "ascii") return read_ascii_rows(text, header.fields, header.points);
  if (header.data == "binary") return read_binary_rows(text, header.fields, header.points);
  return read_compressed(text, header);
}

}  // namespace lidarena::dataset
