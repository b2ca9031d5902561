// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/number.hpp"

#include <locale.h>
#include <stdlib.h>

#include <charconv>
#include <string>

namespace lidarena {

std::optional<double> parse_number(std::string_view text) {
  double value = 0.0;
#if defined(__cpp_lib_to_chars)
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
#else  // GCC 10's from_chars does not read floating-point numbers
  static const locale_t plain = newlocale(LC_ALL_MASK, "C", nullptr);
  const std::string copy(text);
  if (copy.empty() || copy.find_first_of(" \t\n+xX") == 0) return std::nullopt;
  if (copy.find_first_of("xX") != std::string::npos) return std::nullopt;
  char* end = nullptr;
  value = strtod_l(copy.c_str(), &end, plain);
  if (end != copy.c_str() + copy.size()) return std::nullopt;
#endif
  return value;
}

}  // namespace lidarena
