// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "lidarena/dataset/run_files.hpp"
#include "lidarena/results/resource_metrics.hpp"

namespace lidarena::evaluation {

/// Computing time and memory of a run from the rows of its resources.csv; empty without rows. The
/// curves have at most `limit` rows, each the maximum of several consecutive scans.
results::ResourceMetrics resource_metrics(std::span<const dataset::ResourceRow> rows,
                                          std::size_t limit = 500);

}  // namespace lidarena::evaluation
