// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/dataset/messages/point_times.hpp"
#include "lidarena/dataset/mounting.hpp"
#include "lidarena/dataset/recording.hpp"

namespace lidarena::dataset {

/// What the first messages of a topic show.
struct SurveyedTopic {
  std::string frame_id;
  std::vector<Time> stamps;             ///< header stamps
  std::vector<Time> log_times;          ///< of the same messages
  std::vector<ros::SweepTimes> sweeps;  ///< of a PointCloud2 topic
  std::size_t points = 0;               ///< returns in the sweeps
  bool has_rings = false;
  std::string fault;               ///< why a message cannot be read; empty if all can
  std::vector<ImuSample> samples;  ///< of an Imu topic, as stored

  /// Median of header stamp minus log time, s; 0 without messages.
  double clock_offset_s() const;
  /// Median time between stamps; 0 with less than two.
  Time period() const;
};

/// A first look at a recording of others: the first sweeps and samples of each topic, and the
/// static frames.
struct Survey {
  std::map<std::string, SurveyedTopic> topics;  ///< those with scans or IMU samples
  StaticFrames frames;
};

/// Reads from the front until each topic with scans or IMU samples has shown its first messages;
/// where topics follow one after the other, that is all of the file. Damage ends the survey.
Survey survey_recording(const std::filesystem::path& file, const RecordingInfo& info);

}  // namespace lidarena::dataset
