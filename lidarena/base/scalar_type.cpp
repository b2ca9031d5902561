// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/scalar_type.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <type_traits>

#include "lidarena/base/number.hpp"

namespace lidarena {
namespace {

/// A number that may begin with a plus.
std::optional<double> parse_signed(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  return parse_number(word);
}

/// Integers may be written as "12.0"; everything else must be a number in the range of T.
template <class T>
bool parse_scalar(std::string_view word, T& out) {
  if constexpr (std::is_integral_v<T>) {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out);
    if (error == std::errc{} && end == word.data() + word.size()) return true;
    const auto value = parse_signed(word);
    // a double holds every T of up to 4 bytes exactly; wider integers must be written as integers
    if (sizeof(T) > 4 || !value || *value != std::floor(*value) ||
        *value < static_cast<double>(std::numeric_limits<T>::min()) ||
        *value > static_cast<double>(std::numeric_limits<T>::max())) {
      return false;
    }
    out = static_cast<T>(*value);
    return true;
  } else {
    const auto value = parse_signed(word);
    if (!value) return false;
    out = static_cast<T>(*value);
    return true;
  }
}

}  // namespace

std::size_t size_of(ScalarType type) {
  return with_scalar_type(type, [](auto value) { return sizeof(value); });
}

bool append_scalar(std::string& bytes, ScalarType type, std::string_view word) {
  return with_scalar_type(type, [&](auto value) {
    if (!parse_scalar(word, value)) return false;
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
    return true;
  });
}

}  // namespace lidarena
