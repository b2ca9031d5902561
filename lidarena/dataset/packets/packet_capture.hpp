// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/dataset/dataset.hpp"

namespace lidarena::dataset {

/// Whether a file is a capture of packets by its name: .pcap or .pcapng.
bool is_packet_capture(const std::filesystem::path& file);

/// Opens a capture of packets of an Ouster, whose metadata lie beside it as JSON (the file
/// whose name is a beginning of the capture's, else the only one), or of a Velodyne. An Ouster's
/// body frame is its sensor frame, which the metadata relate to LiDAR and IMU. Throws InputError
/// when the metadata are missing or the packets are of none of these.
Dataset open_packet_capture(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace lidarena::dataset
