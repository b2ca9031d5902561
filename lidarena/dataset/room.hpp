// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>

#include "lidarena/dataset/dataset.hpp"

namespace lidarena {

/// Whether the folder has the files of the room format: meta.json, scans.txt, scans/.
bool is_room(const std::filesystem::path& path);

/// Opens a folder of the room format, one LiDAR ("lidar") and maybe one IMU ("imu") whose frame is
/// the body:
///   meta.json       {"columns": ["x", "y", "z", "t", "ring"], "body_from_lidar": [x, y, z, qx, qy,
///                   qz, qw], "time": "absolute seconds", "truth": "imu frame" or "lidar frame"}
///   scans.txt       rows: index t_begin t_end (s)
///   scans/%06d.bin  rows of `columns` as little-endian float64, in the lidar frame at instant t
///   imu.txt         rows: t wx wy wz ax ay az (rad/s, specific force m/s^2); optional
///   gt.tum          truth; optional, never read here
/// A scan's stamp is its t_begin. Throws InputError naming file, line and remedy, from next() too.
Dataset open_room(const std::filesystem::path& path, const ReadOptions& options = {});

/// gt.tum in the body frame (converted with meta.json's extrinsics when it is of the lidar frame);
/// empty without that file. For evaluation alone. Throws InputError.
std::optional<Trajectory> room_truth(const std::filesystem::path& path);

}  // namespace lidarena
