// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace lidarena {

/// A short closed tour through all places from place 0 on, given the symmetric lengths between
/// places: nearest neighbor, then 2-opt until no exchange of two legs helps (Croes 1958).
std::vector<std::size_t> order_of_visits(const std::vector<std::vector<std::int32_t>>& lengths);

}  // namespace lidarena
