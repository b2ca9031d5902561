// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/base/scan.hpp"

namespace lidarena::dataset {

/// Sorts points by `dt_ns`; points of the same time stay in their order. Linear in the number of
/// points where few of them have times less than 1/4096 of the sweep apart without being in order,
/// as in the rows of a spinning sensor's message.
void sort_in_firing_order(std::vector<Point>& points);

}  // namespace lidarena::dataset
