// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace lidarena::flight {

/// A short closed tour through all places, starting at place 0, for given symmetric lengths between
/// places: nearest neighbor, then 2-opt until no exchange of two legs shortens it (Croes 1958).
std::vector<std::size_t> order_of_visits(const std::vector<std::vector<std::int32_t>>& lengths);

}  // namespace lidarena::flight
