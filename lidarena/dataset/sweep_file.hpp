// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/scan.hpp"
#include "lidarena/dataset/point_table.hpp"

namespace lidarena {

/// Reads one sweep: .ply, .pcd, or .bin (raw float32 rows of `layout` xyz, xyzi, xyzt or xyztr,
/// with t in seconds). `stamp` is the sweep's instant by the folder (a file name, times.txt).
///
/// Fields: x y z; intensity (or scalar_intensity, i); ring (or line, channel); and a time: t, time,
/// offset_time, timestamp or time_stamp. A time of 32 bits or fewer counts from `stamp`; one of 64
/// bits is absolute and replaces `stamp` by the first return's. Integers are nanoseconds; floats
/// are seconds, or nanoseconds beyond 1e10 (the year 2286). Without a time field the scan is
/// untimed. Returns at the origin or not finite are no returns and are left out; the rest is put
/// in order of time. Throws InputError naming the file.
Scan read_sweep(const std::filesystem::path& file, Time stamp, const std::string& layout = {});

/// The scan of a table of points, as read_sweep() describes.
Scan scan_from(const PointTable& table, Time stamp);

/// The scan with the stamp `begin`, an instant before its first return; throws InputError (place
/// `file`) when it lies after it, or two seconds before its last.
Scan starting_at(Scan scan, Time begin, const std::string& file);

/// Writes the sweep as binary little-endian PLY: float x y z intensity, uint t (ns since the stamp;
/// left out when untimed), ushort ring, uchar echo. The stamp is not in the file: name it by it, as
/// sweep_file_name() does. Throws Error when the disk is full.
void write_sweep_ply(const std::filesystem::path& file, const Scan& scan);
/// The same fields as binary PCD.
void write_sweep_pcd(const std::filesystem::path& file, const Scan& scan);
/// Raw float32 rows x y z intensity, as KITTI's velodyne sweeps: no times, no rings.
void write_sweep_bin(const std::filesystem::path& file, const Scan& scan);
/// The stamp as 19 digits of nanoseconds, with the ending (".ply").
std::string sweep_file_name(Time stamp, std::string_view ending);

/// What a .bin may hold.
std::vector<std::string> raw_layouts();
/// Bytes of one point; throws InputError (place "layout") for an unknown name.
std::size_t raw_point_size(const std::string& layout);

}  // namespace lidarena
