// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/dataset_layout.hpp"
#include "lidarena/dataset/recording_survey.hpp"

namespace lidarena::dataset {

/// The sensors of a recording of others, with what was said about them.
struct GuessedSensors {
  layout::Description description;
  std::vector<std::string> notes;
  std::vector<std::string> warnings;
  std::string imu_fault;  ///< see Dataset
};

/// Infers what a recording does not state, from its topics and first messages:
///   LiDAR     the topic (PointCloud2, Livox CustomMsg) whose points have times and rings, then the
///             first one; or the one named by topic or id in `options.sensor`
///   IMU       the one whose topic begins as the LiDAR's does, then the one whose frame does, then
///             the first; or `options.imu_topic`. An IMU whose stamps are on another clock than the
///             LiDAR's is left out, and imu_fault says so
///   units     of point times (judge_point_times()), of the IMU (judge_imu())
///   mounting  by the frames in /tf_static; without them, body, LiDAR and IMU frames coincide;
///             `options.body_from_lidar` takes precedence
/// With `options.all_sensors`, all LiDARs and IMUs are taken. Throws InputError (place `file`) when
/// no topic fits.
GuessedSensors guess_sensors(const std::filesystem::path& file, const RecordingInfo& info,
                             const Survey& survey, const ReadOptions& options);

}  // namespace lidarena::dataset
