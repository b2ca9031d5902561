// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/number.hpp"

#include <charconv>
#include <locale>
#include <sstream>
#include <string>

namespace lidarena {

std::optional<double> parse_number(std::string_view text) {
  double value = 0.0;
#if defined(__cpp_lib_to_chars)
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
#else  // GCC 10 reads no floating point numbers there
  if (text.empty() || text.front() == '+' || text.front() == ' ') return std::nullopt;
  std::istringstream in{std::string(text)};
  in.imbue(std::locale::classic());
  if (!(in >> value) || in.peek() != std::istringstream::traits_type::eof()) return std::nullopt;
#endif
  return value;
}

}  // namespace lidarena
