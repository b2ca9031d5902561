// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/base/scan.hpp"

namespace lidarena::dataset {

/// Sorts points by `dt_ns`; points of the same time stay in their order. Linear in the number of
/// points: the rows of a spinning sensor's message are sorted in a fraction of the time that a sort
/// by comparison takes.
void sort_in_firing_order(std::vector<Point>& points);

}  // namespace lidarena::dataset
