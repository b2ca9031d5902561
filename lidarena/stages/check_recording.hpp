// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

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
  static constexpr const char* kTitle = "CheckCurves";
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
    v("pose_t_s", self.pose_t_s, "s", "midway between two poses");
    v("lidar_rate_rad_s", self.lidar_rate_rad_s, "rad/s", "angular rate as the sweeps show it");
  }
};

/// What was found in a recording.
struct CheckReport {
  std::string recording, lidar, imu;
  double seconds = 0.0;
  std::vector<evaluation::Finding> findings;
  std::vector<dataset::TopicSummary> topics;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("recording", self.recording, "", "");
    v("lidar", self.lidar, "", "");
    v("imu", self.imu, "", "empty: none");
    v("seconds", self.seconds, "s", "from the first measurement to the last");
    v("findings", self.findings, "", "the most severe first");
    v("topics", self.topics, "", "of the recording");
  }
};

/// The data of the page: findings, and the measurements behind them.
struct CheckPage : CheckReport {
  CheckCurves curves;
  evaluation::Spectrum accel_spectrum, gyro_spectrum;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    CheckReport::visit(self, v);
    v("curves", self.curves, "", "");
    v("accel_spectrum", self.accel_spectrum, "", "of the specific force");
    v("gyro_spectrum", self.gyro_spectrum, "", "of the angular rate");
  }
};

/// Reads the recording once, with an odometry that needs no IMU, and lists what would spoil a SLAM.
/// Throws InputError if it cannot be read, or has several LiDARs and none is chosen.
CheckPage check_recording(const CheckRequest& request, const Parallel& parallel, LogSink& log);

}  // namespace lidarena::stages
