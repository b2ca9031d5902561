// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

namespace lidarena {

/// Parses all of `text` as a number with a decimal point, whatever the locale; nullopt if it is
/// anything else. Infinities and NaN count as numbers.
std::optional<double> parse_number(std::string_view text);

}  // namespace lidarena
