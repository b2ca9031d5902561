// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numbers>

namespace lidarena {

inline constexpr double kDegree = std::numbers::pi / 180.0;            // rad per degree
inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;  // degrees per rad

}  // namespace lidarena
