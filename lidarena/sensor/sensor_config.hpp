// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/sensor/field_of_view.hpp"
#include "lidarena/sensor/return_config.hpp"
#include "lidarena/sensor/scan_pattern.hpp"
#include "lidarena/sensor/spinning_head.hpp"

namespace lidarena {

enum class LidarModel {
  kLivoxMid360,
  kLivoxMid40,
  kLivoxMid70,
  kLivoxAvia,
  kOusterOs0128,
  kLivoxCsv,   ///< rays of a table in Livox's format
  kBeamTable,  ///< a spinning head with the beams of a table
};
template <>
struct EnumNames<LidarModel> {
  static constexpr std::array names{std::pair{"livox_mid360", LidarModel::kLivoxMid360},
                                    std::pair{"livox_mid40", LidarModel::kLivoxMid40},
                                    std::pair{"livox_mid70", LidarModel::kLivoxMid70},
                                    std::pair{"livox_avia", LidarModel::kLivoxAvia},
                                    std::pair{"ouster_os0_128", LidarModel::kOusterOs0128},
                                    std::pair{"livox_csv", LidarModel::kLivoxCsv},
                                    std::pair{"beam_table", LidarModel::kBeamTable}};
};

/// How a scan relates to the motion during it. All but the first are faults of earlier simulators,
/// kept for comparisons.
enum class ScanMode {
  kRolling,          ///< every shot from the pose at its own instant
  kFrozen,           ///< all shots from the pose at the stamp, stamped as if the sensor had moved
  kFrozenUnstamped,  ///< all shots from the pose at the stamp, without per-point times
  kOfficial,         ///< as kFrozenUnstamped, and every range too short by the minimum range
};
template <>
struct EnumNames<ScanMode> {
  static constexpr std::array names{std::pair{"rolling", ScanMode::kRolling},
                                    std::pair{"frozen", ScanMode::kFrozen},
                                    std::pair{"frozen_unstamped", ScanMode::kFrozenUnstamped},
                                    std::pair{"official", ScanMode::kOfficial}};
};

/// A tone of the airframe's vibration as the IMU feels it (and the LiDAR does not): each axis
/// swings as a sine of its own phase, drawn once a unit. The frequency is fixed, and there is no
/// filter before sampling: a tone above half the IMU's rate shows up folded, as in a part without
/// one.
struct VibrationTone {
  double frequency_hz = 100.0;
  Eigen::Vector3d accel_amplitude = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_amplitude = Eigen::Vector3d::Zero();
  bool grows_with_thrust = true;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("frequency_hz", self.frequency_hz, "Hz", "of the tone, e.g. turns per second of a propeller",
      above(0));
    v("accel_amplitude", self.accel_amplitude, "m/s^2", "x y z, when hovering", at_least(0));
    v("gyro_amplitude", self.gyro_amplitude, "rad/s", "x y z, when hovering", at_least(0));
    v("grows_with_thrust", self.grows_with_thrust, "",
      "amplitudes are proportional to thrust, as an unbalanced propeller's; else they are fixed");
  }
};

/// The IMU inside a LiDAR. Densities are continuous: a sample at rate f has density * sqrt(f).
/// Every error is off at zero. The order in which they act: vibration is added to what the IMU
/// feels; scale and misalignment distort that; bias and white noise are added; the result is
/// rounded to the resolution and held within the range.
struct ImuConfig {
  std::string model;
  double rate_hz = 200.0;
  double gyro_noise_density = 0.0;
  double accel_noise_density = 0.0;
  double gyro_bias_walk = 0.0;
  double accel_bias_walk = 0.0;
  double gyro_turn_on_bias = 0.0;
  double accel_turn_on_bias = 0.0;
  double gyro_scale_error = 0.0;
  double accel_scale_error = 0.0;
  double gyro_misalignment = 0.0;
  double accel_misalignment = 0.0;
  double gyro_range = 0.0;
  double accel_range = 0.0;
  double gyro_resolution = 0.0;
  double accel_resolution = 0.0;
  std::vector<VibrationTone> vibration;
  Pose lidar_from_imu = Pose::Identity();

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("model", self.model, "", "part number");
    v("rate_hz", self.rate_hz, "Hz", "samples per second", above(0));
    v("gyro_noise_density", self.gyro_noise_density, "rad/s/sqrt(Hz)", "white noise", at_least(0));
    v("accel_noise_density", self.accel_noise_density, "m/s^2/sqrt(Hz)", "white noise",
      at_least(0));
    v("gyro_bias_walk", self.gyro_bias_walk, "rad/s^2/sqrt(Hz)", "bias random walk", at_least(0));
    v("accel_bias_walk", self.accel_bias_walk, "m/s^3/sqrt(Hz)", "bias random walk", at_least(0));
    v("gyro_turn_on_bias", self.gyro_turn_on_bias, "rad/s", "sigma of each axis' first bias",
      at_least(0));
    v("accel_turn_on_bias", self.accel_turn_on_bias, "m/s^2", "sigma of each axis' first bias",
      at_least(0));
    v("gyro_scale_error", self.gyro_scale_error, "", "sigma of each axis' relative scale error",
      at_least(0));
    v("accel_scale_error", self.accel_scale_error, "", "sigma of each axis' relative scale error",
      at_least(0));
    v("gyro_misalignment", self.gyro_misalignment, "rad",
      "sigma of the two small angles by which each axis leans", at_least(0));
    v("accel_misalignment", self.accel_misalignment, "rad",
      "sigma of the two small angles by which each axis leans", at_least(0));
    v("gyro_range", self.gyro_range, "rad/s", "largest rate read, 0 = no limit", at_least(0));
    v("accel_range", self.accel_range, "m/s^2", "largest specific force read, 0 = no limit",
      at_least(0));
    v("gyro_resolution", self.gyro_resolution, "rad/s", "step of the read-out, 0 = none",
      at_least(0));
    v("accel_resolution", self.accel_resolution, "m/s^2", "step of the read-out, 0 = none",
      at_least(0));
    v("vibration", self.vibration, "", "tones of the airframe");
    v("lidar_from_imu", self.lidar_from_imu, "m, quaternion", "x y z qx qy qz qw");
  }
};

/// What a buyer asks; no part of the simulation.
struct SensorFacts {
  std::string source;  ///< where the figures of the file come from
  double weight_kg = 0.0;
  double power_min_w = 0.0;
  double power_max_w = 0.0;
  std::string price;
  std::string approximate;
  std::optional<FieldOfView> fov;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("source", self.source, "", "where the figures of the file come from");
    v("weight_kg", self.weight_kg, "kg", "weight, 0 if unknown", at_least(0));
    v("power_min_w", self.power_min_w, "W", "least power drawn, 0 if unknown", at_least(0));
    v("power_max_w", self.power_max_w, "W", "most power drawn, 0 if unknown", at_least(0));
    v("price", self.price, "", "in words, empty if unknown");
    v("approximate", self.approximate, "", "what of the pattern is approximate, empty if nothing");
    v("fov", self.fov, "", "the field of view that the data sheet gives");
  }
};

/// One LiDAR, its mounting, its noise, and the IMU inside it if there is one.
struct SensorConfig {
  std::string name;
  LidarModel model = LidarModel::kLivoxMid360;
  int columns = 0;
  std::string pattern_file;
  double row_rate_hz = 0.0;
  int lines = 1;
  std::optional<SpinningHead> beam_table;
  double rate_hz = 10.0;
  double min_range_m = 0.1;
  double max_range_m = 70.0;
  double range_noise_m = 0.0;
  NoiseConfig noise;
  ReturnConfig returns;
  ScanMode mode = ScanMode::kRolling;
  Pose body_from_lidar = Pose::Identity();
  std::optional<ImuConfig> imu;
  SensorFacts facts;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "id in the dataset; the file's stem if empty");
    v("model", self.model, "", "scan pattern");
    v("columns", self.columns, "", "firings per turn; spinning sensors only", at_least(0));
    v("pattern_file", self.pattern_file, "",
      "table of livox_csv (CSV) or beam_table (YAML), relative to this file");
    v("row_rate_hz", self.row_rate_hz, "Hz", "rows per second of livox_csv", between(0, 1e7));
    v("lines", self.lines, "", "laser lines that take turns in the rows of livox_csv",
      between(1, 65535));
    v("beam_table", self.beam_table, "", "the table itself, instead of pattern_file");
    v("rate_hz", self.rate_hz, "Hz", "scans per second", at_least(0.5));  // dt_ns holds 2.1 s
    v("min_range_m", self.min_range_m, "m", "nearest range reported", at_least(0));
    v("max_range_m", self.max_range_m, "m", "farthest range reported", above(0));
    v("range_noise_m", self.range_noise_m, "m", "sigma of the range noise", at_least(0));
    v("noise", self.noise, "", "further errors, and what decides whether an echo is seen");
    v("returns", self.returns, "", "which of a shot's echoes are reported, and how bright");
    v("mode", self.mode, "", "rolling; or a fault of earlier simulators, for comparison");
    v("body_from_lidar", self.body_from_lidar, "m, quaternion", "x y z qx qy qz qw");
    v("imu", self.imu, "", "the IMU inside, if any");
    v("facts", self.facts, "", "weight, power, price, source");
  }
};

/// Reads a file of configs/sensors: a beam table is read into `beam_table`, and the `pattern_file`
/// of a livox_csv made a full path, so that the configuration no longer depends on where its file
/// lies. Throws InputError naming file, line and key when a key is unknown, a value is out of
/// range, or the values do not fit together.
SensorConfig load_sensor(const std::filesystem::path& file);

/// The scan pattern of the sensor's model. Throws InputError (place: the sensor's name) when the
/// model has no such mode.
std::unique_ptr<ScanPattern> make_pattern(const SensorConfig& sensor);
/// The same; `place` stands in messages.
std::unique_ptr<ScanPattern> make_pattern(const SensorConfig& sensor, const std::string& place);

}  // namespace lidarena
