// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lidarena::report {

/// `text` escaped for HTML and SVG.
std::string escaped(std::string_view text);

/// "Nice" tick positions (1, 2, 5 times a power of ten) that cover [low, high] in about `count`
/// steps.
std::vector<double> nice_ticks(double low, double high, int count);

}  // namespace lidarena::report
