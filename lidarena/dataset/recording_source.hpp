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

namespace lidarena::dataset {

/// The sensors of a recording by topic.
struct RecordedSensors {
  std::map<std::string, std::string> lidars;  ///< topic -> sensor id
  std::map<std::string, std::string> imus;    ///< likewise
  std::set<std::string> imus_in_g;            ///< ids of IMUs whose acceleration is in g (Livox)
};

/// Whether messages of this type can be read as scans, or as IMU samples.
bool is_scan_type(const RecordedTopic& topic);
bool is_imu_type(const RecordedTopic& topic);

/// The measurements in a file, in the order that EventSource guarantees. `info` is used to find the
/// IMUs that have samples, so that no scan waits for an IMU without any. next() throws InputError
/// where the file is cut off or damaged, after it returned everything before.
std::unique_ptr<EventSource> open_recorded_events(const std::filesystem::path& file,
                                                  const RecordedSensors& sensors,
                                                  const RecordingInfo& info);

/// The measurements in the messages that `reader` gives, likewise. `imus` are the ids of the IMUs
/// that a scan waits for; `place` names the reader in messages.
std::unique_ptr<EventSource> recorded_events(std::unique_ptr<RecordingReader> reader,
                                             const std::string& place,
                                             const RecordedSensors& sensors,
                                             const std::vector<std::string>& imus);

/// Whether the accelerations on `imu_topic` are in g: the mean magnitude of the first samples,
/// dominated by gravity, lies between 0.5 and 2.
bool is_in_g(const std::filesystem::path& file, const std::string& imu_topic);

/// Standard gravity, m/s^2.
inline constexpr double kStandardGravity = 9.80665;

}  // namespace lidarena::dataset
