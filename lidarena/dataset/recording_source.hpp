// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "lidarena/dataset/event.hpp"
#include "lidarena/dataset/mcap_info.hpp"

namespace lidarena {

/// Which topics of an MCAP file are which sensors.
struct McapSensors {
  std::map<std::string, std::string> lidars;  ///< topic -> sensor id
  std::map<std::string, std::string> imus;    ///< likewise
};

/// Whether messages of this type (in CDR) can be read as scans, or as IMU samples.
bool is_scan_type(const McapTopic& topic);
bool is_imu_type(const McapTopic& topic);

/// The measurements in a file, in the order that EventSource promises. `info` tells which IMUs have
/// samples at all, so that no scan waits for one that has none. next() throws InputError when the
/// file is cut off or damaged, after having given out what comes before.
std::unique_ptr<EventSource> open_mcap_events(const std::filesystem::path& file,
                                              const McapSensors& sensors, const McapInfo& info);

}  // namespace lidarena
