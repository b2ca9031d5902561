// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/evaluation/diagnosis/recording_check.hpp"
#include "lidarena/evaluation/diagnosis/spectrum.hpp"

namespace lidarena::stages {

/// Input of `lidarena check`.
struct CheckRequest {
  std::filesystem::path recording;
  dataset::ReadOptions read{};
  bool motion = true;  ///< register the sweeps: clocks, axes, degenerate stretches, the map
};

/// Columns of equal length; of each short stretch of time the sample of largest size.
struct CheckCurves {
  std::vector<double> imu_t_s, gyro_rad_s, accel_m_s2;
  std::vector<double> sweep_t_s, sweep_points, sweep_gap_s;
  std::vector<double> pose_t_s, lidar_rate_rad_s;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("imu_t_s", self.imu_t_s, "s", "since the first measurement");
    v("gyro_rad_s", self.gyro_rad_s, "rad/s", "size of the angular rate");
    v("accel_m_s2", self.accel_m_s2, "m/s^2", "size of the specific force");
    v("sweep_t_s", self.sweep_t_s, "s", "stamps of the sweeps");
    v("sweep_points", self.sweep_points, "", "points of each sweep");
    v("sweep_gap_s", self.sweep_gap_s, "s", "time since the sweep before");
    v("pose_t_s", self.pose_t_s, "s", "");
    v("lidar_rate_rad_s", self.lidar_rate_rad_s, "rad/s", "angular rate as the sweeps show it");
  }
};

/// What was found in a recording.
struct CheckReport {
  std::string recording, lidar, imu;
  double seconds = 0.0;
  std::vector<evaluation::Finding> findings;  ///< the most severe first
  CheckCurves curves;
  evaluation::Spectrum accel_spectrum, gyro_spectrum;
  std::vector<dataset::TopicSummary> topics;
};

/// Reads the recording once, with an odometry that needs no IMU, and lists what would spoil a SLAM.
/// Throws InputError if it cannot be read, or has several LiDARs and none is chosen.
CheckReport check_recording(const CheckRequest& request, const Parallel& parallel, LogSink& log);

/// The report as one JSON document, with or without what only the page draws.
Json to_json(const CheckReport& report, bool with_curves);

}  // namespace lidarena::stages
