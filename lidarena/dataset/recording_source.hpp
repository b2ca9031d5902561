// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "lidarena/base/event.hpp"
#include "lidarena/dataset/imu_units.hpp"
#include "lidarena/dataset/messages/point_times.hpp"
#include "lidarena/dataset/read_report.hpp"
#include "lidarena/dataset/recording.hpp"

namespace lidarena::dataset {

/// The sensors of a recording by topic, and how their messages are read.
struct RecordedSensors {
  std::map<std::string, std::string> lidars;  ///< topic -> sensor id
  std::map<std::string, std::string> imus;    ///< likewise
  std::map<std::string, ImuUnits> imu_units;  ///< by sensor id, of those that are not in SI
  /// By topic, of recordings of others; empty for our own, whose times need no rule.
  std::map<std::string, ros::PointTimes> point_times;
};

/// Whether messages of this type can be read as scans, or as IMU samples.
bool is_scan_type(const RecordedTopic& topic);
bool is_imu_type(const RecordedTopic& topic);

/// The measurements in a recording, in the order that EventSource guarantees. `info` is used to
/// find the IMUs that have samples, so that no scan waits for an IMU without any.
///
/// Recordings of others are read in the order of log times, within a look-ahead of 0.3 s. Where an
/// IMU's samples come more than StreamMerge::kMaxGap behind the scans (topic after topic), they are
/// read ahead by a second reader; an IMU that has ended holds up no scan. Measurements that are not
/// later than the one before, and IMU samples that cannot be measurements, are left out. `report`
/// counts all this. next() throws DamagedFile where the file is cut off or damaged, after it
/// returned everything before.
std::unique_ptr<EventSource> open_recorded_events(const std::filesystem::path& file,
                                                  const RecordedSensors& sensors,
                                                  const RecordingInfo& info,
                                                  std::shared_ptr<ReadReport> report);

}  // namespace lidarena::dataset
