// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/ply_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "lidarena/base/error.hpp"
#include "lidarena/base/number.hpp"

namespace lidarena {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";
constexpr std::string_view kCutShort = "the file is cut short; copy or write it again";

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  for (;;) {
    const std::size_t begin = line.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) return words;
    const std::size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
}

ScalarType type_named(std::string_view name, const std::string& place) {
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
  throw InputError(place, fmt::format("'{}' is not a PLY type", name),
                   "types are char, uchar, short, ushort, int, uint, float, double");
}

PlyProperty parse_property(const std::vector<std::string_view>& words, const std::string& place) {
  if (words.size() == 3) {
    return {std::string(words[2]), type_named(words[1], place), std::nullopt};
  }
  if (words.size() == 5 && words[1] == "list") {
    return {std::string(words[4]), type_named(words[3], place), type_named(words[2], place)};
  }
  throw InputError(place, "is not a PLY property", "write 'property TYPE NAME'");
}

std::size_t parse_count(std::string_view word, const std::string& place) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) {
    throw InputError(place, fmt::format("'{}' is not a count", word));
  }
  return value;
}

}  // namespace

PlyReader::PlyReader(std::string_view bytes, const std::string& name)
    : rest_(bytes), size_(bytes.size()), name_(name) {
  parse_header();
}

std::string_view PlyReader::line() {
  if (rest_.empty()) {
    throw InputError(name_, fmt::format("ends after line {}", line_number_),
                     std::string(kCutShort));
  }
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  const std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  ++line_number_;
  return line;
}

std::string PlyReader::place() const {
  return format_ == Format::kAscii ? fmt::format("{}:{}", name_, line_number_)
                                   : fmt::format("{}: byte {}", name_, size_ - rest_.size());
}

void PlyReader::parse_header() {
  const auto first = split(line());
  if (first.size() != 1 || first[0] != "ply") {
    throw InputError(place(), "is not a PLY file", "its first line is not 'ply'");
  }
  Format format = Format::kAscii;  // places are lines until the header ends
  bool has_format = false;
  for (;;) {
    const std::string_view text = line();
    const auto words = split(text);
    const std::string_view key = words.empty() ? "" : words[0];
    if (key == "end_header") break;
    if (key == "format") {
      const std::string_view named = words.size() >= 2 ? words[1] : "";
      has_format = true;
      if (named == "binary_little_endian") {
        format = Format::kLittleEndian;
      } else if (named == "binary_big_endian") {
        format = Format::kBigEndian;
      } else if (named != "ascii") {
        throw InputError(place(), fmt::format("PLY format '{}' is not supported", named),
                         "save it as ascii or binary_little_endian");
      }
    } else if (!parse_header_line(text)) {
      throw InputError(place(), fmt::format("'{}' is not a PLY keyword", key));
    }
  }
  if (!has_format) throw InputError(place(), "the header has no format line");
  format_ = format;
}

/// False for an unknown keyword.
bool PlyReader::parse_header_line(std::string_view text) {
  const auto words = split(text);
  const std::string_view key = words.empty() ? "" : words[0];
  if (key == "comment") {
    const std::size_t begin = text.find(key) + key.size();
    const std::size_t end = text.find_last_not_of(kBlanks) + 1;
    comments_.emplace_back(text.substr(std::min(begin + 1, end), end - std::min(begin + 1, end)));
  } else if (key == "element") {
    if (words.size() != 3) throw InputError(place(), "is not a PLY element");
    elements_.push_back({std::string(words[1]), parse_count(words[2], place()), {}});
  } else if (key == "property") {
    if (elements_.empty()) throw InputError(place(), "a property precedes the first element");
    elements_.back().properties.push_back(parse_property(words, place()));
  } else {
    return key == "obj_info";
  }
  return true;
}

void PlyReader::begin_row() {
  if (format_ != Format::kAscii) return;
  words_ = split(line());
  next_word_ = 0;
}

void PlyReader::end_row() {
  if (format_ != Format::kAscii || next_word_ == words_.size()) return;
  throw InputError(place(), fmt::format("holds {} values, not {}", words_.size(), next_word_),
                   "write one row of an element per line");
}

std::string_view PlyReader::word() {
  if (next_word_ == words_.size()) {
    throw InputError(place(), fmt::format("holds only {} values", words_.size()),
                     "write one row of an element per line");
  }
  return words_[next_word_++];
}

std::string_view PlyReader::take(std::size_t count, std::size_t size) {
  if (size > 0 && count > rest_.size() / size) {
    throw InputError(place(),
                     fmt::format("{} times {} bytes are announced, but {} bytes are left", count,
                                 size, rest_.size()),
                     std::string(kCutShort));
  }
  const std::string_view bytes = rest_.substr(0, count * size);
  rest_.remove_prefix(bytes.size());
  return bytes;
}

double PlyReader::next(ScalarType type) {
  if (format_ == Format::kAscii) {
    const std::string_view text = word();
    if (const auto value = parse_number(text)) return *value;
    throw InputError(place(), fmt::format("'{}' is not a number", text));
  }
  std::array<char, 8> bytes{};
  const std::string_view stored = take(1, size_of(type));
  std::copy(stored.begin(), stored.end(), bytes.begin());
  if (format_ == Format::kBigEndian) {
    std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(stored.size()));
  }
  return with_scalar_type(type, [&](auto value) {
    std::memcpy(&value, bytes.data(), sizeof(value));
    return static_cast<double>(value);
  });
}

std::uint32_t PlyReader::next_index(ScalarType type) {
  const double value = next(type);
  if (!(value >= 0.0 && value <= std::numeric_limits<std::uint32_t>::max()) ||
      value != std::floor(value)) {
    throw InputError(place(), fmt::format("{} is not a count or an index", value));
  }
  return static_cast<std::uint32_t>(value);
}

void PlyReader::skip(const PlyElement& element) {
  for (std::size_t i = 0; i < element.count; ++i) {
    if (format_ == Format::kAscii) {
      line();
      continue;
    }
    if (element.properties.empty()) return;
    for (const PlyProperty& property : element.properties) {
      const std::size_t values = property.count_type ? next_index(*property.count_type) : 1;
      take(values, size_of(property.type));
    }
  }
}

std::string PlyReader::packed(const PlyElement& element) {
  std::size_t row_size = 0;
  for (const PlyProperty& property : element.properties) row_size += size_of(property.type);
  if (row_size == 0 && element.count > 0) {
    throw InputError(name_, fmt::format("element '{}' has no properties", element.name));
  }
  std::string bytes;
  if (format_ != Format::kAscii) {
    bytes = take(element.count, row_size);
    for (char* value = bytes.data();
         format_ == Format::kBigEndian && row_size > 0 && value < bytes.data() + bytes.size();) {
      for (const PlyProperty& property : element.properties) {
        std::reverse(value, value + size_of(property.type));
        value += size_of(property.type);
      }
    }
    return bytes;
  }
  for (std::size_t i = 0; i < element.count; ++i) {
    begin_row();
    if (words_.size() != element.properties.size()) {
      throw InputError(
          place(), fmt::format("holds {} values, not {}", words_.size(), element.properties.size()),
          "write one row of an element per line");
    }
    for (const PlyProperty& property : element.properties) {
      const std::string_view text = word();
      if (!append_scalar(bytes, property.type, text)) {
        throw InputError(place(), fmt::format("'{}' is not a value of its property's type", text));
      }
    }
  }
  return bytes;
}

}  // namespace lidarena
