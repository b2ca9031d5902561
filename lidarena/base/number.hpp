// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

namespace lidarena {

/// The number that `text` is, whole, with a point whatever the locale; nothing for anything else.
/// Infinities and NaN count as numbers.
std::optional<double> parse_number(std::string_view text);

}  // namespace lidarena
