// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/ply.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <optional>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/point_file_text.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena {
namespace {

struct Property {
  std::string name;
  ScalarType type;                       ///< of each value
  std::optional<ScalarType> count_type;  ///< of the length of a list; empty for a scalar
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  bool ascii = false;
  std::vector<Element> elements;
};

std::optional<ScalarType> type_named(std::string_view name) {
  using S = ScalarType;
  constexpr std::pair<std::string_view, ScalarType> kNames[] = {
      {"char", S::kInt8},      {"int8", S::kInt8},       {"uchar", S::kUint8},
      {"uint8", S::kUint8},    {"short", S::kInt16},     {"int16", S::kInt16},
      {"ushort", S::kUint16},  {"uint16", S::kUint16},   {"int", S::kInt32},
      {"int32", S::kInt32},    {"uint", S::kUint32},     {"uint32", S::kUint32},
      {"float", S::kFloat32},  {"float32", S::kFloat32}, {"double", S::kFloat64},
      {"float64", S::kFloat64}};
  for (const auto& [known, type] : kNames) {
    if (known == name) return type;
  }
  return std::nullopt;
}

ScalarType type_at(std::string_view name, const std::string& place) {
  if (const auto type = type_named(name)) return *type;
  throw InputError(place, fmt::format("'{}' is not a PLY type", name),
                   "types are char, uchar, short, ushort, int, uint, float, double");
}

bool parse_format(const std::vector<std::string_view>& words, const std::string& place) {
  const std::string_view format = words.size() >= 2 ? words[1] : "";
  if (format == "ascii") return true;
  if (format == "binary_little_endian") return false;
  throw InputError(place, fmt::format("PLY format '{}' is not supported", format),
                   "save it as ascii or binary_little_endian");
}

Property parse_property(const std::vector<std::string_view>& words, const std::string& place) {
  if (words.size() == 3) return {lower_case(words[2]), type_at(words[1], place), std::nullopt};
  if (words.size() == 5 && words[1] == "list") {
    return {lower_case(words[4]), type_at(words[3], place), type_at(words[2], place)};
  }
  throw InputError(place, "is not a PLY property", "write 'property TYPE NAME'");
}

Header parse_header(FileText& text) {
  if (text.line() != "ply") throw InputError(text.place(), "is not a PLY file");
  Header header;
  bool has_format = false;
  for (;;) {
    const auto words = split_words(text.line());
    const std::string place = text.place();
    const std::string_view key = words.empty() ? "" : words[0];
    if (key == "format") {
      header.ascii = parse_format(words, place);
      has_format = true;
    } else if (key == "element") {
      if (words.size() != 3) throw InputError(place, "is not a PLY element");
      header.elements.push_back({std::string(words[1]), parse_count(words[2], place), {}});
    } else if (key == "property") {
      if (header.elements.empty()) throw InputError(place, "a property precedes the first element");
      header.elements.back().properties.push_back(parse_property(words, place));
    } else if (key == "end_header") {
      if (!has_format) throw InputError(place, "the header has no format line");
      return header;
    } else if (key != "comment" && key != "obj_info") {
      throw InputError(place, fmt::format("'{}' is not a PLY keyword", key));
    }
  }
}

/// Reads the length of a binary list at the current position.
std::size_t take_list_count(FileText& text, ScalarType type) {
  PointTable one;
  one.bytes = std::string(text.take(size_of(type)));
  if (!is_integer(type)) throw InputError(text.place(), "a list's length must be an integer");
  const std::int64_t count = one.integer({"", type, 0, 0}, 0);
  if (count < 0) throw InputError(text.place(), "a list has a negative length");
  return static_cast<std::size_t>(count);
}

/// Skips an element that precedes the vertices.
void skip_element(FileText& text, const Element& element, bool ascii) {
  for (std::size_t i = 0; i < element.count; ++i) {
    if (ascii) {
      text.line();
      continue;
    }
    for (const Property& property : element.properties) {
      const std::size_t values =
          property.count_type ? take_list_count(text, *property.count_type) : 1;
      text.take(values, size_of(property.type));
    }
    if (element.properties.empty()) return;
  }
}

std::vector<Field> vertex_fields(const Element& vertex, const std::string& place) {
  std::vector<Field> fields;
  for (const Property& property : vertex.properties) {
    if (property.count_type) {
      throw InputError(place, fmt::format("vertices have a list property '{}'", property.name),
                       "write scalar properties only");
    }
    fields.push_back({property.name, property.type, 1});
  }
  return fields;
}

}  // namespace

PointTable read_ply_table(const std::filesystem::path& file) {
  return parse_ply_table(read_bytes(file), file.string());
}

PointTable parse_ply_table(std::string_view bytes, const std::string& name) {
  FileText text(bytes, name);
  const Header header = parse_header(text);
  for (const Element& element : header.elements) {
    if (element.name != "vertex") {
      skip_element(text, element, header.ascii);
      continue;
    }
    const auto fields = vertex_fields(element, name);
    return header.ascii ? read_ascii_rows(text, fields, element.count)
                        : read_binary_rows(text, fields, element.count);
  }
  throw InputError(name, "has no element 'vertex'", "a cloud needs vertices");
}

}  // namespace lidarena
