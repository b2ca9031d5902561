// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "lidarena/dataset/event.hpp"
#include "lidarena/dataset/recording.hpp"

namespace lidarena {

/// Which topics of a recording are which sensors.
struct RecordedSensors {
  std::map<std::string, std::string> lidars;  ///< topic -> sensor id
  std::map<std::string, std::string> imus;    ///< likewise
  std::set<std::string> imus_in_g;            ///< ids whose acceleration is in g, as Livox's is
};

/// Whether messages of this type can be read as scans, or as IMU samples.
bool is_scan_type(const RecordedTopic& topic);
bool is_imu_type(const RecordedTopic& topic);

/// The measurements in a file, in the order that EventSource promises. `info` tells which IMUs have
/// samples at all, so that no scan waits for one that has none. next() throws InputError when the
/// file is cut off or damaged, after having given out what comes before.
std::unique_ptr<EventSource> open_recorded_events(const std::filesystem::path& file,
                                                  const RecordedSensors& sensors,
                                                  const RecordingInfo& info);

/// Whether the accelerations on `imu_topic` are in g: the mean magnitude of the first samples,
/// which gravity rules, lies between 0.5 and 2.
bool is_in_g(const std::filesystem::path& file, const std::string& imu_topic);

/// Standard gravity, m/s^2.
inline constexpr double kStandardGravity = 9.80665;

}  // namespace lidarena
