// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/text_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <system_error>

#include "lidarena/base/error.hpp"
#include "lidarena/base/number.hpp"

namespace lidarena::dataset {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// A decimal number as written: 0.`digits` * 10^`point`, digits without leading zeros.
struct Decimal {
  bool negative = false;
  std::string digits;
  long point = 0;
};

/// Removes digits with at most one decimal point from the front of `word`; false if there is no
/// digit.
bool take_digits(std::string_view& word, Decimal& out) {
  bool any = false;
  bool after_point = false;
  for (; !word.empty(); word.remove_prefix(1)) {
    const char c = word.front();
    if (c == '.' && !after_point) {
      after_point = true;
    } else if (is_digit(c)) {
      any = true;
      const bool leading_zero = c == '0' && out.digits.empty();
      if (!leading_zero) out.digits.push_back(c);
      if (after_point) {
        out.point -= leading_zero ? 1 : 0;
      } else {
        out.point += leading_zero ? 0 : 1;
      }
    } else {
      break;
    }
  }
  return any;
}

std::optional<Decimal> parse_decimal(std::string_view word) {
  Decimal decimal;
  if (!word.empty() && (word.front() == '-' || word.front() == '+')) {
    decimal.negative = word.front() == '-';
    word.remove_prefix(1);
  }
  if (!take_digits(word, decimal)) return std::nullopt;
  if (word.empty()) return decimal;
  if (word.front() != 'e' && word.front() != 'E') return std::nullopt;
  word.remove_prefix(1);
  if (word.size() > 1 && word.front() == '+' && is_digit(word[1])) word.remove_prefix(1);
  int exponent = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), exponent);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  decimal.point += exponent;
  return decimal;
}

}  // namespace

std::string read_bytes(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) {
    throw InputError(file.string(), "there is no such file", "check the path");
  }
  if (std::filesystem::is_directory(status)) {
    throw InputError(file.string(), "is a folder, a file is expected");
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"),
                                                               &std::fclose);
  if (!stream) {
    throw InputError(file.string(), "cannot be opened: " + std::generic_category().message(errno));
  }
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::string bytes;
  if (!error) bytes.reserve(static_cast<std::size_t>(size));
  char buffer[1 << 16];
  while (const std::size_t count = std::fread(buffer, 1, sizeof(buffer), stream.get())) {
    bytes.append(buffer, count);
  }
  if (std::ferror(stream.get()) != 0) throw InputError(file.string(), "cannot be read completely");
  return bytes;
}

TextRows::TextRows(const std::filesystem::path& file) : TextRows(read_bytes(file), file.string()) {}

TextRows::TextRows(std::string text, std::string name)
    : text_(std::move(text)), name_(std::move(name)) {
  if (text_.starts_with(kByteOrderMark)) position_ = kByteOrderMark.size();
}

std::optional<std::string_view> TextRows::next() {
  while (position_ < text_.size()) {
    const std::size_t end = std::min(text_.find('\n', position_), text_.size());
    const std::string_view row =
        without_outer_blanks(std::string_view(text_).substr(position_, end - position_));
    position_ = end + 1;
    ++line_;
    if (!row.empty() && row.front() != '#') return row;
  }
  return std::nullopt;
}

std::string_view without_outer_blanks(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::vector<std::string_view> split_words(std::string_view row) {
  std::vector<std::string_view> words;
  std::size_t begin = row.find_first_not_of(kBlanks);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(row.find_first_of(kBlanks, begin), row.size());
    words.push_back(row.substr(begin, end - begin));
    begin = row.find_first_not_of(kBlanks, end);
  }
  return words;
}

std::vector<std::string_view> split_commas(std::string_view row) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t comma = row.find(',');
    parts.push_back(without_outer_blanks(row.substr(0, comma)));
    if (comma == std::string_view::npos) return parts;
    row.remove_prefix(comma + 1);
  }
}

std::optional<double> parse_double(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  return parse_number(word);
}

double finite_number(std::string_view word, const std::string& place) {
  const auto value = parse_double(word);
  if (!value) throw InputError(place, fmt::format("'{}' is not a number", word));
  if (!std::isfinite(*value)) {
    throw InputError(
        place, fmt::format("'{}' is not finite", word),
        "the program that wrote the file had diverged there; remove this and all later lines");
  }
  return *value;
}

std::optional<Time> parse_seconds(std::string_view word) {
  const auto decimal = parse_decimal(word);
  if (!decimal) return std::nullopt;
  if (decimal->digits.empty()) return Time{0};
  const long kept = decimal->point + 9;  // digits before the decimal point, in nanoseconds
  if (kept < 0) return Time{0};
  if (kept > 19) return std::nullopt;
  const auto digit = [&](long i) {
    return i < static_cast<long>(decimal->digits.size())
               ? static_cast<std::uint64_t>(decimal->digits[static_cast<std::size_t>(i)] - '0')
               : std::uint64_t{0};
  };
  std::uint64_t ns = 0;  // 19 digits fit
  for (long i = 0; i < kept; ++i) ns = ns * 10 + digit(i);
  if (digit(kept) >= 5) ++ns;
  if (ns > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
    return std::nullopt;
  }
  const auto magnitude = static_cast<std::int64_t>(ns);
  return Time{decimal->negative ? -magnitude : magnitude};
}

std::string format_seconds(Time time) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t ns = time.count();
  // divided before negated: the magnitude of the smallest integer does not fit
  const std::int64_t whole = ns / kSecond;
  const std::int64_t rest = ns % kSecond;
  return fmt::format("{}{}.{:09}", ns < 0 ? "-" : "", whole < 0 ? -whole : whole,
                     rest < 0 ? -rest : rest);
}

Time seconds_at(std::string_view word, const std::string& place) {
  const auto time = parse_seconds(word);
  const double value = time ? 0.0 : std::abs(parse_double(word).value_or(0.0));
  if (value > 1e10 && value < 1e20) {  // present-day times are 1.7e12 ms or 1.7e18 ns
    const char* unit = value < 1e14   ? "milliseconds"
                       : value < 1e17 ? "microseconds"
                                      : "nanoseconds";
    throw InputError(place,
                     fmt::format("'{}' is not a time in seconds: it looks like {}", word, unit),
                     "write decimal seconds");
  }
  if (!time) {
    throw InputError(place, fmt::format("'{}' is not a time in seconds", word),
                     "write decimal seconds, within 292 years of zero");
  }
  return *time;
}

}  // namespace lidarena::dataset
