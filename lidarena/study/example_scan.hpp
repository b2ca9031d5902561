// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/base/parallel.hpp"

namespace lidarena {

/// For pictures: of each LiDAR the scan of the first minute during which the body turns most, in
/// the mesh's frame with each return's distance to the mesh, as SENSOR_scan.ply (each return laid
/// by the true pose at its own instant) and SENSOR_scan_skewed.ply (all by that of the scan's
/// start, as if nothing had moved) in the dataset's folder. Throws InputError where it has no truth
/// or mesh.
void write_example_scans(const std::filesystem::path& dataset, const Parallel& parallel);

}  // namespace lidarena
