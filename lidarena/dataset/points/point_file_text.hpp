// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lidarena/dataset/points/point_table.hpp"

/// Common parts of PLY and PCD files: a header of text lines, then rows of values.
namespace lidarena::dataset {

/// A cursor over a file that begins with text and may continue in binary. Throws InputError instead
/// of reading past the end.
class FileText {
 public:
  /// `bytes` must outlive this object; `name` is the file, for messages.
  FileText(std::string_view bytes, std::string name)
      : rest_(bytes), size_(bytes.size()), name_(std::move(name)) {}

  /// The next line without leading and trailing blanks. Throws InputError at the end of the file.
  std::string_view line();
  /// The next `count * size` bytes. Throws InputError when there are fewer.
  std::string_view take(std::size_t count, std::size_t size = 1);
  const std::string& name() const { return name_; }
  /// "file:line" of the line last returned.
  std::string place() const { return name_ + ":" + std::to_string(line_); }

 private:
  std::string_view rest_;
  std::size_t size_;
  std::string name_;
  std::size_t line_ = 0;
};

/// `count` consecutive values of one type under one name.
struct Field {
  std::string name;
  ScalarType type = ScalarType::kFloat32;
  std::size_t count = 1;
};

std::string lower_case(std::string_view text);
/// A non-negative integer; throws InputError (place `place`) otherwise.
std::size_t parse_count(std::string_view word, const std::string& place);

/// Bytes of one row.
std::size_t row_size(const std::vector<Field>& fields);
/// Columns of consecutive rows; for a field of several values, the column of the first.
std::vector<Column> row_columns(const std::vector<Field>& fields);

/// The next `rows` rows of packed little-endian values.
PointTable read_binary_rows(FileText& text, const std::vector<Field>& fields, std::size_t rows);
/// The next `rows` lines of blank-separated values.
PointTable read_ascii_rows(FileText& text, const std::vector<Field>& fields, std::size_t rows);

}  // namespace lidarena::dataset
