// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/flight/flight.hpp"
#include "lidarena/sensor/error_config.hpp"
#include "lidarena/sensor/field_of_view.hpp"
#include "lidarena/sensor/return_config.hpp"
#include "lidarena/sensor/scan_pattern.hpp"
#include "lidarena/sensor/shape_config.hpp"
#include "lidarena/sensor/spinning_head.hpp"

namespace lidarena::sensor {

enum class LidarModel {
  kLivoxMid360,
  kLivoxMid40,
  kLivoxMid70,
  kLivoxAvia,
  kOusterOs0128,
  kLivoxCsv,   ///< rays of a table in Livox's format
  kBeamTable,  ///< a spinning head with the beams of a table
};
constexpr auto enum_names(LidarModel) {
  return std::array{std::pair{"livox_mid360", LidarModel::kLivoxMid360},
                    std::pair{"livox_mid40", LidarModel::kLivoxMid40},
                    std::pair{"livox_mid70", LidarModel::kLivoxMid70},
                    std::pair{"livox_avia", LidarModel::kLivoxAvia},
                    std::pair{"ouster_os0_128", LidarModel::kOusterOs0128},
                    std::pair{"livox_csv", LidarModel::kLivoxCsv},
                    std::pair{"beam_table", LidarModel::kBeamTable}};
}

/// How a scan is affected by motion during it. All modes but the first reproduce faults of earlier
/// simulators, for comparison.
enum class ScanMode {
  kRolling,          ///< every shot from the pose at its own instant
  kFrozen,           ///< all shots from the pose at the stamp, but with the times of each shot
  kFrozenUnstamped,  ///< all shots from the pose at the stamp, without per-point times
  kFrozenRamp,  ///< all shots from the pose at the stamp; times are a ramp over the points, see
                ///< ramp_s
  kOfficial,    ///< as kFrozenUnstamped, and every range too short by the minimum range
};
constexpr auto enum_names(ScanMode) {
  return std::array{
      std::pair{"rolling", ScanMode::kRolling}, std::pair{"frozen", ScanMode::kFrozen},
      std::pair{"frozen_unstamped", ScanMode::kFrozenUnstamped},
      std::pair{"frozen_ramp", ScanMode::kFrozenRamp}, std::pair{"official", ScanMode::kOfficial}};
}

/// A tone of the airframe's vibration, as felt by the IMU: on each axis a sine with a phase of its
/// own, drawn once per unit. The frequency is fixed. Without `bandwidth_hz` there is no filter
/// before sampling: a tone above half the IMU's rate is aliased.
struct VibrationTone {
  double frequency_hz = 100.0;
  Eigen::Vector3d accel_amplitude = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_amplitude = Eigen::Vector3d::Zero();
  bool grows_with_thrust = true;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("frequency_hz", self.frequency_hz, "Hz",
      "frequency of the tone, e.g. revolutions per second of a propeller", above(0));
    v("accel_amplitude", self.accel_amplitude, "m/s^2", "amplitude x y z in hover", at_least(0));
    v("gyro_amplitude", self.gyro_amplitude, "rad/s", "amplitude x y z in hover", at_least(0));
    v("grows_with_thrust", self.grows_with_thrust, "",
      "true: amplitudes proportional to thrust, as of an unbalanced propeller; false: constant");
  }
};

/// The IMU inside a LiDAR. Noise densities are continuous: a sample at rate f has the sigma
/// density * sqrt(f). An error set to 0 is off. Order in which the errors are applied: vibration is
/// added to the true values; the sum is delayed and low-pass filtered; scale, misalignment,
/// g-sensitivity and non-linearity distort it; bias and white noise are added; the result is
/// rounded to the resolution and limited to the range. Lost samples and jitter of stamps come last.
/// Sources of the model: IEEE Std 1431-2004 (gyros), IEEE Std 1293-2018 (accelerometers).
struct ImuConfig {
  std::string model;
  double rate_hz = 200.0;
  double error_factor = 1.0;
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
  double gyro_g_sensitivity = 0.0;
  double gyro_nonlinearity = 0.0;
  double accel_nonlinearity = 0.0;
  double bandwidth_hz = 0.0;
  double delay_s = 0.0;
  double stamp_jitter_s = 0.0;
  double lost_share = 0.0;
  double gravity = flight::kGravity;
  std::vector<VibrationTone> vibration;
  BroadbandConfig broadband;
  bool vibration_moves_lidar = false;
  Pose lidar_from_imu = Pose::Identity();

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("model", self.model, "", "part number");
    v("rate_hz", self.rate_hz, "Hz", "samples per second", above(0));
    v("error_factor", self.error_factor, "",
      "all noise, bias, scale, misalignment, g-sensitivity and non-linearity errors times this",
      at_least(0));
    v("gyro_noise_density", self.gyro_noise_density, "rad/s/sqrt(Hz)", "white noise", at_least(0));
    v("accel_noise_density", self.accel_noise_density, "m/s^2/sqrt(Hz)", "white noise",
      at_least(0));
    v("gyro_bias_walk", self.gyro_bias_walk, "rad/s^2/sqrt(Hz)", "bias random walk", at_least(0));
    v("accel_bias_walk", self.accel_bias_walk, "m/s^3/sqrt(Hz)", "bias random walk", at_least(0));
    v("gyro_turn_on_bias", self.gyro_turn_on_bias, "rad/s", "sigma of each axis' turn-on bias",
      at_least(0));
    v("accel_turn_on_bias", self.accel_turn_on_bias, "m/s^2", "sigma of each axis' turn-on bias",
      at_least(0));
    v("gyro_scale_error", self.gyro_scale_error, "", "sigma of each axis' relative scale error",
      at_least(0));
    v("accel_scale_error", self.accel_scale_error, "", "sigma of each axis' relative scale error",
      at_least(0));
    v("gyro_misalignment", self.gyro_misalignment, "rad",
      "sigma of the two small misalignment angles of each axis", at_least(0));
    v("accel_misalignment", self.accel_misalignment, "rad",
      "sigma of the two small misalignment angles of each axis", at_least(0));
    v("gyro_range", self.gyro_range, "rad/s", "largest rate measured, 0 = no limit", at_least(0));
    v("accel_range", self.accel_range, "m/s^2", "largest specific force measured, 0 = no limit",
      at_least(0));
    v("gyro_resolution", self.gyro_resolution, "rad/s",
      "quantization step of the samples, 0 = none", at_least(0));
    v("accel_resolution", self.accel_resolution, "m/s^2",
      "quantization step of the samples, 0 = none", at_least(0));
    v("gyro_g_sensitivity", self.gyro_g_sensitivity, "rad/s/(m/s^2)",
      "sigma of each element of the matrix by which the gyro feels the specific force",
      at_least(0));
    v("gyro_nonlinearity", self.gyro_nonlinearity, "",
      "sigma of each axis' quadratic error at gyro_range, as share of the range", at_least(0));
    v("accel_nonlinearity", self.accel_nonlinearity, "",
      "sigma of each axis' quadratic error at accel_range, as share of the range", at_least(0));
    v("bandwidth_hz", self.bandwidth_hz, "Hz",
      "-3 dB frequency of the low-pass before sampling (Butterworth, second order), 0 = none",
      between(0, 1000));
    v("delay_s", self.delay_s, "s", "a sample is this much older than its stamp says",
      between(0, 1));
    v("stamp_jitter_s", self.stamp_jitter_s, "s",
      "sigma of the error of each sample's stamp, limited to 0.45 of the period", at_least(0));
    v("lost_share", self.lost_share, "", "share of the samples that are lost, each by itself",
      between(0, 0.9));
    v("gravity", self.gravity, "m/s^2",
      "gravity where the flight is; methods are not told (9.78 to 9.83 on the ground)",
      between(9, 11));
    v("vibration", self.vibration, "", "vibration tones of the airframe");
    v("broadband", self.broadband, "", "vibration with a spectrum that follows the rotors' speed");
    v("vibration_moves_lidar", self.vibration_moves_lidar, "",
      "true: LiDAR and IMU vibrate as one rigid body; false: the IMU alone feels the vibration");
    v("lidar_from_imu", self.lidar_from_imu, "m, quaternion", "x y z qx qy qz qw");
  }
};

/// The IMU whose errors are multiplied by its error_factor, which is then 1.
ImuConfig with_error_factor(ImuConfig imu);

/// Product data for comparing sensors; not used by the simulation.
struct SensorFacts {
  std::string source;  ///< source of the figures in the file
  double weight_kg = 0.0;
  double power_min_w = 0.0;
  double power_max_w = 0.0;
  std::string price;
  std::string approximate;
  std::optional<FieldOfView> fov;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("source", self.source, "", "source of the figures in this file");
    v("weight_kg", self.weight_kg, "kg", "weight, 0 if unknown", at_least(0));
    v("power_min_w", self.power_min_w, "W", "minimum power consumption, 0 if unknown", at_least(0));
    v("power_max_w", self.power_max_w, "W", "maximum power consumption, 0 if unknown", at_least(0));
    v("price", self.price, "", "price as text, empty if unknown");
    v("approximate", self.approximate, "",
      "which parts of the pattern are approximate, empty if none");
    v("fov", self.fov, "", "field of view according to the data sheet");
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
  ShapeConfig shape{};
  double rate_hz = 10.0;
  double min_range_m = 0.1;
  double max_range_m = 70.0;
  double range_noise_m = 0.0;
  NoiseConfig noise;
  ReturnConfig returns;
  ScanMode mode = ScanMode::kRolling;
  double ramp_s = 0.05;
  Pose body_from_lidar = Pose::Identity();
  MountConfig mount{};
  std::optional<ImuConfig> imu;
  ToldConfig told;
  SensorFacts facts;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "id in the dataset; if empty, the file name without extension");
    v("model", self.model, "", "scan pattern");
    v("columns", self.columns, "", "columns (firings) per revolution; spinning sensors only",
      at_least(0));
    v("pattern_file", self.pattern_file, "",
      "table of livox_csv (CSV) or beam_table (YAML), relative to this file");
    v("row_rate_hz", self.row_rate_hz, "Hz", "rows per second of livox_csv", between(0, 1e7));
    v("lines", self.lines, "", "number of laser lines that alternate in the rows of livox_csv",
      between(1, 65535));
    v("beam_table", self.beam_table, "", "the beam table itself, instead of pattern_file");
    v("shape", self.shape, "", "changes of the scan pattern, to find out what matters");
    v("rate_hz", self.rate_hz, "Hz", "scans per second", at_least(0.5));  // dt_ns covers 2.1 s
    v("min_range_m", self.min_range_m, "m", "nearest range reported", at_least(0));
    v("max_range_m", self.max_range_m, "m", "farthest range reported", above(0));
    v("range_noise_m", self.range_noise_m, "m", "sigma of the range noise", at_least(0));
    v("noise", self.noise, "",
      "further measurement errors, and the conditions for detecting an echo");
    v("returns", self.returns, "",
      "which of a shot's echoes are reported, and the kind of intensity");
    v("mode", self.mode, "", "rolling; or a fault of earlier simulators, for comparison");
    v("ramp_s", self.ramp_s, "s",
      "mean length of the ramp of times in mode frozen_ramp; that of each scan is drawn from half "
      "to one and a half of it",
      between(0.001, 1));
    v("body_from_lidar", self.body_from_lidar, "m, quaternion",
      "x y z qx qy qz qw; mount turns and moves it further");
    v("mount", self.mount, "", "another mounting, in angles; the IMU inside moves along");
    v("imu", self.imu, "", "the IMU inside the LiDAR, if any");
    v("told", self.told, "", "what the rig tells the methods where it differs from what is so");
    v("facts", self.facts, "", "weight, power, price, source");
  }
};

/// The pose of the LiDAR in the body: body_from_lidar, turned and moved by `mount`.
Pose mounted(const SensorConfig& sensor);

/// The field of view of the data sheet as `shape` changes it; empty if the data sheet's is unknown.
std::optional<FieldOfView> field_of_view(const SensorConfig& sensor);

/// Reads an optional part over the one that is there, so that a file may state only what differs
/// from its base (and `--set imu.rate_hz=100` changes that alone); null removes the part.
template <ConfigStruct C>
void read_value(const ConfigNode& node, std::optional<C>& out, const Limits& limits) {
  C value = out.value_or(C{});
  lidarena::read_value(node, value, limits);
  out = node.is_null() ? std::nullopt : std::optional(std::move(value));
}

/// The keys of a sensor file: those of the sensor and its base.
struct SensorFile {
  std::string base;
  SensorConfig sensor;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("base", self.base, "",
      "the sensor whose values hold where this file has none: a file relative to this one, or a "
      "name "
      "in configs/sensors; maps are merged key by key, lists and single values are replaced");
    SensorConfig::visit(self.sensor, v);
  }
};

/// The file and, from base to base, those on which it is based. A base is a path relative to the
/// file that names it, or the name of a sensor in the same folder or in `shipped`. Throws
/// InputError if there is no such file, or if a base leads back to a file before it.
std::vector<std::filesystem::path> sensor_files(const std::filesystem::path& file,
                                                const std::filesystem::path& shipped = {});

/// Reads a sensor file, as in configs/sensors, over its base if it names one (see sensor_files()).
/// The name is never that of the base. A beam table is read into `beam_table`, and the
/// `pattern_file` of a livox_csv is made absolute, so that the configuration does not depend on
/// where its file is. `set`: "key=value", applied last. Throws InputError naming file, line and key
/// if a key is unknown, a value is out of range, or the values contradict each other.
SensorConfig load_sensor(const std::filesystem::path& file,
                         const std::filesystem::path& shipped = {},
                         const std::vector<std::string>& set = {});

/// The scan pattern of the sensor's model. Throws InputError (place: the sensor's name) if the
/// model does not have this mode.
std::unique_ptr<ScanPattern> make_pattern(const SensorConfig& sensor);
/// The same, with `place` as the place in error messages.
std::unique_ptr<ScanPattern> make_pattern(const SensorConfig& sensor, const std::string& place);

}  // namespace lidarena::sensor
