// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/scan.hpp"
#include "lidarena/dataset/points/point_table.hpp"

namespace lidarena::dataset {

/// Reads one sweep: .ply, .pcd, or .bin (raw float32 rows of `layout` xyz, xyzi, xyzt or xyztr,
/// with t in seconds). `stamp` is the sweep's time given by its folder (file name, times.txt).
///
/// Fields: x y z; intensity (or scalar_intensity, i); ring (or line, channel); and a time: t, time,
/// offset_time, timestamp or time_stamp. A time of 32 bits or fewer is relative to `stamp`; one of
/// 64 bits is absolute, and the scan's stamp is then the time of the first return. Integers are
/// nanoseconds; floats are seconds, or nanoseconds beyond 1e10 (the year 2286). Without a time
/// field the scan is untimed. Points at the origin or not finite are not returns and are dropped;
/// the others are sorted by time. Throws InputError naming the file.
Scan read_sweep(const std::filesystem::path& file, Time stamp, const std::string& layout = {});

/// The scan in a table of points, as described at read_sweep().
Scan scan_from(const PointTable& table, Time stamp);

/// The scan with its stamp moved back to `begin`; throws InputError (place `file`) when `begin` is
/// after the first return, or more than two seconds before the last.
Scan starting_at(Scan scan, Time begin, const std::string& file);

/// Writes the sweep as binary little-endian PLY: float x y z intensity, uint t (ns since the stamp;
/// left out when untimed), ushort ring, uchar echo. The stamp is not in the file: keep it in the
/// name, see sweep_file_name(). Throws Error when the disk is full.
void write_sweep_ply(const std::filesystem::path& file, const Scan& scan);
/// The same fields as binary PCD.
void write_sweep_pcd(const std::filesystem::path& file, const Scan& scan);
/// Raw float32 rows x y z intensity, as KITTI's velodyne sweeps: no times, no rings.
void write_sweep_bin(const std::filesystem::path& file, const Scan& scan);
/// The stamp as 19 digits of nanoseconds, followed by `ending` (".ply").
std::string sweep_file_name(Time stamp, std::string_view ending);

/// Names of the layouts that a .bin file may have.
std::vector<std::string> raw_layouts();
/// Bytes of one point; throws InputError (place "layout") for an unknown name.
std::size_t raw_point_size(const std::string& layout);

}  // namespace lidarena::dataset
