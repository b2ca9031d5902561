// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

namespace lidarena {

/// An instant (since an epoch that the dataset names) or a duration, in integer nanoseconds.
/// Seconds as `double` are for differences and for printing only.
using Time = std::chrono::nanoseconds;

/// Nearest nanosecond to `s` seconds.
inline Time from_seconds(double s) { return Time{std::llround(s * 1e9)}; }

/// Seconds; rounded to 0.24 us for present-day times since 1970, so use it for differences.
inline double to_seconds(Time t) { return static_cast<double>(t.count()) * 1e-9; }

}  // namespace lidarena
