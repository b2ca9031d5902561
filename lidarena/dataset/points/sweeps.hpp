// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "lidarena/dataset/dataset.hpp"

namespace lidarena::dataset {

/// Whether `path` is a sweep file (.pcd, .ply, .bin) or a folder that contains some, directly or in
/// velodyne/ as in KITTI.
bool has_sweeps(const std::filesystem::path& path);

/// Sweeps of one LiDAR, one per file, read one at a time in natural order of their names (2 before
/// 10). The time of a sweep comes from its points if they have 64-bit times, else from times.txt
/// (seconds, one per sweep), else from names of 19 digits (nanoseconds), else from
/// `options.rate_hz`. The layout of .bin sweeps is `options.layout`; if that is empty, the only
/// layout whose point size divides all file sizes, which is then stated in Dataset::notes. Throws
/// InputError naming file and remedy, also later, from next(), when a file is damaged or a stamp
/// does not increase.
Dataset open_sweep_folder(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same for files given one by one, in this order. `files` must not be empty.
Dataset open_sweep_files(const std::vector<std::filesystem::path>& files,
                         const ReadOptions& options = {});

/// Whether `a` comes before `b` in an order that compares runs of digits as numbers.
bool natural_less(std::string_view a, std::string_view b);

}  // namespace lidarena::dataset
