// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/time.hpp"

namespace lidarena::dataset {

/// The whole file. Throws InputError when it is missing, a folder, or cannot be read.
std::string read_bytes(const std::filesystem::path& file);

/// The rows of a text file: a byte order mark, blank lines, '#' comments, blanks at either end and
/// carriage returns are skipped.
class TextRows {
 public:
  /// Throws InputError like read_bytes().
  explicit TextRows(const std::filesystem::path& file);
  /// Rows of `text`; `name` is the file's name in messages.
  TextRows(std::string text, std::string name);

  /// The next row, empty at the end; valid as long as this object.
  std::optional<std::string_view> next();
  /// "file:line" of the row last returned.
  std::string place() const { return name_ + ":" + std::to_string(line_); }
  const std::string& name() const { return name_; }

 private:
  std::string text_;
  std::string name_;
  std::size_t position_ = 0;
  std::size_t line_ = 0;
};

std::string_view without_outer_blanks(std::string_view text);
/// Parts between blanks and tabs, none empty.
std::vector<std::string_view> split_words(std::string_view row);
/// Parts between commas, outer blanks removed.
std::vector<std::string_view> split_commas(std::string_view row);

/// A decimal number, "nan" or "inf"; empty if `word` is anything else. Independent of the locale.
std::optional<double> parse_double(std::string_view word);
/// A finite number; throws InputError (place `place`) otherwise.
double finite_number(std::string_view word, const std::string& place);

/// Decimal seconds, also with an exponent, as integer nanoseconds, exactly (half a nanosecond
/// rounds away from zero). Empty if `word` is not a number or is beyond 292 years.
std::optional<Time> parse_seconds(std::string_view word);
/// Seconds with 9 decimals, exactly.
std::string format_seconds(Time time);

/// A time in seconds; throws InputError (place `place`) otherwise.
Time seconds_at(std::string_view word, const std::string& place);

}  // namespace lidarena::dataset
