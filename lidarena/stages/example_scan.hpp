// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/base/parallel.hpp"

namespace lidarena::stages {

/// Writes one scan per LiDAR for pictures: the scan of the first minute during which the body
/// rotates most, in the mesh's frame, with each return's distance to the mesh. SENSOR_scan.ply
/// places each return by the true pose at its own instant; SENSOR_scan_skewed.ply places all
/// returns by the true pose at the scan's start, as if nothing had moved. Both files go to the
/// dataset's folder. Throws InputError if the dataset has no truth or no mesh.
void write_example_scans(const std::filesystem::path& dataset, const Parallel& parallel);

}  // namespace lidarena::stages
