// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "lidarena/dataset/dataset.hpp"

namespace lidarena {

/// Whether `path` is a sweep file (.pcd, .ply, .bin) or a folder of some (or of velodyne/, as KITTI
/// has it).
bool has_sweeps(const std::filesystem::path& path);

/// Sweeps of one LiDAR, a file each, read one at a time in natural order of their names (2 before
/// 10). When a sweep was made comes from its points where they carry 64-bit times, else from
/// times.txt (seconds, one a sweep), else from names that are 19 digits of nanoseconds, else from
/// `options.rate_hz`. The layout of .bin sweeps is `options.layout`; without it the one that alone
/// divides all their sizes, which Dataset::notes then says. Throws InputError naming file and
/// remedy, also later, from next(), when a file is broken or a stamp does not increase.
Dataset open_sweep_folder(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same for files given one by one, in this order. `files` must not be empty.
Dataset open_sweep_files(const std::vector<std::filesystem::path>& files,
                         const ReadOptions& options = {});

/// Order of names in which runs of digits compare as numbers.
bool natural_less(std::string_view a, std::string_view b);

}  // namespace lidarena
