// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/points/point_file_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::dataset {
namespace {

constexpr std::string_view kCutShort = "the file is cut short; copy or write it again";

/// Throws InputError when the header announces rows without fields: a damaged count alone could
/// otherwise cause any amount of work.
void check_fields(const FileText& text, const std::vector<Field>& fields, std::size_t rows) {
  if (row_size(fields) == 0 && rows > 0) throw InputError(text.name(), "points have no fields");
}

}  // namespace

std::string_view FileText::line() {
  if (rest_.empty()) {
    throw InputError(name_, fmt::format("ends after line {}", line_), kCutShort);
  }
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  const std::string_view line = without_outer_blanks(rest_.substr(0, end));
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  ++line_;
  return line;
}

std::string_view FileText::take(std::size_t count, std::size_t size) {
  if (size > 0 && count > rest_.size() / size) {
    throw InputError(fmt::format("{}: byte {}", name_, size_ - rest_.size()),
                     fmt::format("{} times {} bytes are announced, but {} bytes are left", count,
                                 size, rest_.size()),
                     kCutShort);
  }
  const std::string_view bytes = rest_.substr(0, count * size);
  rest_.remove_prefix(bytes.size());
  return bytes;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

std::size_t parse_count(std::string_view word, const std::string& place) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) {
    throw InputError(place, fmt::format("'{}' is not a count", word));
  }
  return value;
}

std::size_t row_size(const std::vector<Field>& fields) {
  std::size_t size = 0;
  for (const Field& field : fields) size += field.count * size_of(field.type);
  return size;
}

std::vector<Column> row_columns(const std::vector<Field>& fields) {
  std::vector<Column> columns;
  std::size_t offset = 0;
  const std::size_t stride = row_size(fields);
  for (const Field& field : fields) {
    columns.push_back({field.name, field.type, offset, stride});
    offset += field.count * size_of(field.type);
  }
  return columns;
}

PointTable read_binary_rows(FileText& text, const std::vector<Field>& fields, std::size_t rows) {
  check_fields(text, fields, rows);
  return {text.name(), std::string(text.take(rows, row_size(fields))), rows, row_columns(fields)};
}

PointTable read_ascii_rows(FileText& text, const std::vector<Field>& fields, std::size_t rows) {
  check_fields(text, fields, rows);
  PointTable table{text.name(), {}, rows, row_columns(fields)};
  std::vector<ScalarType> types;
  for (const Field& field : fields) types.insert(types.end(), field.count, field.type);
  for (std::size_t row = 0; row < rows; ++row) {
    const auto words = split_words(text.line());
    if (words.size() != types.size()) {
      throw InputError(text.place(),
                       fmt::format("holds {} values, not {}", words.size(), types.size()),
                       "write one point per line");
    }
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (!append_scalar(table.bytes, types[i], words[i])) {
        throw InputError(text.place(),
                         fmt::format("'{}' is not a value of its field's type", words[i]));
      }
    }
  }
  return table;
}

}  // namespace lidarena::dataset
