// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/pose.hpp"

namespace lidarena {

/// Description of a LiDAR as given to estimators: data-sheet values and mounting.
struct LidarInfo {
  std::string id;                ///< name of its topics, e.g. "mid360"
  std::string model;             ///< e.g. "livox_mid360"
  std::string kind = "unknown";  ///< "spinning", "rosette" or "unknown"
  int rows = 0;                  ///< rings of a spinning sensor, laser lines of a Livox; 0 unknown
  int columns = 0;               ///< firings per ring and scan; 0 unknown
  /// Number of columns by which each row of a spinning sensor points ahead of the sensor head;
  /// empty = unknown.
  std::vector<int> pixel_shifts;
  double beam_origin_m = 0.0;  ///< distance of the beams' origins from the axis of rotation
  double rate_hz = 10.0;       ///< scans per second
  double min_range_m = 0.0;
  double max_range_m = 100.0;
  Pose body_from_lidar = Pose::Identity();

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("id", self.id, "", "name of the sensor in the dataset");
    v("model", self.model, "", "model, e.g. livox_mid360");
    v("kind", self.kind, "", "spinning, rosette or unknown");
    v("rows", self.rows, "", "rings or laser lines, 0 if unknown", at_least(0));
    v("columns", self.columns, "", "firings per ring and scan, 0 if unknown", at_least(0));
    v("pixel_shifts", self.pixel_shifts, "columns",
      "number of columns by which each row points ahead of the head, empty if unknown");
    v("beam_origin_m", self.beam_origin_m, "m",
      "distance of the beams' origins from the axis of rotation", at_least(0));
    v("rate_hz", self.rate_hz, "Hz", "scans per second", above(0));
    v("min_range_m", self.min_range_m, "m", "minimum range reported", at_least(0));
    v("max_range_m", self.max_range_m, "m", "maximum range reported", above(0));
    v("body_from_lidar", self.body_from_lidar, "m, quaternion", "x y z qx qy qz qw");
  }
};

/// Description of an IMU as given to estimators; noise densities are continuous-time, in SI units.
struct ImuInfo {
  std::string id;
  std::string model;
  double rate_hz = 200.0;
  double gyro_noise_density = 0.0;   ///< rad/s/sqrt(Hz)
  double accel_noise_density = 0.0;  ///< m/s^2/sqrt(Hz)
  double gyro_bias_walk = 0.0;       ///< rad/s^2/sqrt(Hz)
  double accel_bias_walk = 0.0;      ///< m/s^3/sqrt(Hz)
  Pose body_from_imu = Pose::Identity();

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("id", self.id, "", "name of the sensor in the dataset");
    v("model", self.model, "", "model of the IMU");
    v("rate_hz", self.rate_hz, "Hz", "samples per second", above(0));
    v("gyro_noise_density", self.gyro_noise_density, "rad/s/sqrt(Hz)", "density of the white noise",
      at_least(0));
    v("accel_noise_density", self.accel_noise_density, "m/s^2/sqrt(Hz)",
      "density of the white noise", at_least(0));
    v("gyro_bias_walk", self.gyro_bias_walk, "rad/s^2/sqrt(Hz)", "bias random walk", at_least(0));
    v("accel_bias_walk", self.accel_bias_walk, "m/s^3/sqrt(Hz)", "bias random walk", at_least(0));
    v("body_from_imu", self.body_from_imu, "m, quaternion", "x y z qx qy qz qw");
  }
};

/// All sensors on one body.
struct Rig {
  std::string body_frame = "body";
  std::vector<LidarInfo> lidars;
  std::vector<ImuInfo> imus;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("body_frame", self.body_frame, "", "name of the body frame");
    v("lidars", self.lidars, "", "LiDARs and their mounting");
    v("imus", self.imus, "", "IMUs and their mounting");
  }

  /// The LiDAR named `id`, or the only one if `id` is empty; nullptr if there is none.
  const LidarInfo* find_lidar(const std::string& id) const;
  /// The IMU built into `lidar`, which has the same id, or else the first one; nullptr if there is
  /// none.
  const ImuInfo* imu_beside(const LidarInfo& lidar) const;
};

}  // namespace lidarena
