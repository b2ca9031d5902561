// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/flight/imu_spline_fit.hpp"
#include "lidarena/flight/quadrotor_config.hpp"

namespace lidarena::flight {

/// Source of the path.
enum class FlightKind { kWaypoints, kRoute, kReplay, kAuto };
constexpr auto enum_names(FlightKind) {
  return std::array{std::pair{"waypoints", FlightKind::kWaypoints},
                    std::pair{"route", FlightKind::kRoute},
                    std::pair{"replay", FlightKind::kReplay}, std::pair{"auto", FlightKind::kAuto}};
}

/// The IMU's samples on a replay.
enum class ImuSource { kSimulated, kRecorded };
constexpr auto enum_names(ImuSource) {
  return std::array{std::pair{"simulated", ImuSource::kSimulated},
                    std::pair{"recorded", ImuSource::kRecorded}};
}

/// Preset of the flight's limits.
enum class FlightStyle { kGentle, kBrisk, kAggressive };
constexpr auto enum_names(FlightStyle) {
  return std::array{std::pair{"gentle", FlightStyle::kGentle},
                    std::pair{"brisk", FlightStyle::kBrisk},
                    std::pair{"aggressive", FlightStyle::kAggressive}};
}

/// Bounds that hold at every instant of a flight through waypoints.
struct FlightLimits {
  double max_speed = 0.0;         ///< m/s
  double max_acceleration = 0.0;  ///< m/s^2, without gravity
  double max_jerk = 0.0;          ///< m/s^3
  double max_tilt = 0.0;          ///< rad, of the body's z axis from the vertical
  double max_yaw_rate = 0.0;      ///< rad/s
};

/// Limits of a style: gentle for inspection, brisk for ordinary flight, aggressive for racing.
FlightLimits limits_of(FlightStyle style);

/// Limits that override those of the style.
struct LimitsConfig {
  std::optional<double> max_speed, max_acceleration, max_jerk, max_tilt, max_yaw_rate;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("max_speed", self.max_speed, "m/s", "maximum speed", above(0));
    v("max_acceleration", self.max_acceleration, "m/s^2", "maximum acceleration, without gravity",
      above(0));
    v("max_jerk", self.max_jerk, "m/s^3",
      "maximum jerk; a lower value gives smoother turns and braking", above(0));
    v("max_tilt", self.max_tilt, "rad", "maximum tilt of the body from the vertical",
      Limits{0.0, 1.5, true});
    v("max_yaw_rate", self.max_yaw_rate, "rad/s", "maximum rate of the heading", above(0));
  }
};

enum class HeadingMode { kAlongPath, kFixed, kSweep };
constexpr auto enum_names(HeadingMode) {
  return std::array{std::pair{"along_path", HeadingMode::kAlongPath},
                    std::pair{"fixed", HeadingMode::kFixed},
                    std::pair{"sweep", HeadingMode::kSweep}};
}

struct HeadingConfig {
  HeadingMode mode = HeadingMode::kAlongPath;
  double yaw = 0.0;
  double amplitude = 0.6;
  double period_s = 3.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("mode", self.mode, "",
      "along_path, fixed, or sweep: oscillates about the direction of the path");
    v("yaw", self.yaw, "rad", "heading in mode fixed, from the world's x axis");
    v("amplitude", self.amplitude, "rad", "amplitude of the oscillation in mode sweep",
      at_least(0));
    v("period_s", self.period_s, "s", "period of the oscillation in mode sweep", above(0));
  }
};

/// Settings of the tour planner (kind auto), see plan_tour().
struct TourConfig {
  std::optional<Eigen::Vector3d> start;
  double coverage = 0.9;
  double range_m = 20.0;
  double margin_m = 0.0;
  double voxel_size_m = 0.1;
  int max_voxels = 300000;
  int max_views = 800;
  int samples = 5000;

  /// Former names, for the message that names the new one.
  static constexpr RenamedKey renamed_keys[] = {{"cell_m", "voxel_size_m"},
                                                {"max_cells", "max_voxels"}};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("start", self.start, "m", "start and end of the tour; chosen automatically when absent");
    v("coverage", self.coverage, "",
      "share, by area, of the visible surface that the chosen viewpoints must see",
      between(0.01, 1));
    v("range_m", self.range_m, "m", "maximum distance at which a surface counts as seen", above(0));
    v("margin_m", self.margin_m, "m",
      "distance kept in addition to clearance_m, for the tracking error of a quadrotor",
      at_least(0));
    v("voxel_size_m", self.voxel_size_m, "m",
      "edge of the grid's cells; increased if max_voxels requires it", Limits{0.02, 10.0, false});
    v("max_voxels", self.max_voxels, "",
      "upper limit on the number of cells; limits time and memory", between(100, 1e8));
    v("max_views", self.max_views, "", "upper limit on the number of candidate viewpoints",
      between(2, 1e5));
    v("samples", self.samples, "", "number of surface points by which coverage is measured",
      between(10, 1e7));
  }
};

/// A flight file (see configs/flights).
struct FlightConfig {
  FlightKind kind = FlightKind::kWaypoints;
  std::vector<Eigen::Vector3d> waypoints;
  int route = 0;
  std::string replay;
  double replay_step_s = 0.0;
  std::string replay_imu;
  ImuFitConfig imu_fit;
  ImuSource imu = ImuSource::kSimulated;
  Pose world_from_recording = Pose::Identity();
  bool find_place = false;
  Pose recorded_from_body = Pose::Identity();
  TourConfig tour;
  FlightStyle style = FlightStyle::kBrisk;
  LimitsConfig limits;
  double speed = 1.0;
  HeadingConfig heading;
  double corner_m = 0.15;
  double clearance_m = 0.3;
  double duration_s = 0.0;
  double hover_s = 1.0;
  std::optional<double> begin_s;
  std::optional<DynamicsConfig> dynamics;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("kind", self.kind, "",
      "waypoints, route (provided by the world), replay (a TUM file) or auto (a planned tour)");
    v("waypoints", self.waypoints, "m", "list of [x, y, z]; the path follows the polyline");
    v("route", self.route, "", "index of the world's route, from 0", at_least(0));
    v("replay", self.replay, "", "TUM file, relative to this file");
    v("replay_step_s", self.replay_step_s, "s",
      "minimum time between the poses used; a larger value reduces the effect of a recording's "
      "noise on the rates",
      at_least(0));
    v("replay_imu", self.replay_imu, "",
      "samples of the IMU whose poses replay has, relative to this file: t gyro x y z accel x y z "
      "(s or ns, rad/s, m/s^2); the motion is a spline fitted to both");
    v("imu_fit", self.imu_fit, "", "settings of that fit");
    v("imu", self.imu, "",
      "recorded: methods get the samples of replay_imu as they are; simulated: those of the "
      "sensor's IMU on the same motion");
    v("world_from_recording", self.world_from_recording, "",
      "pose of the recording's frame in the world");
    v("find_place", self.find_place, "",
      "true: the recording is moved, and turned about z, to where it has most room along the "
      "world's routes, in place of world_from_recording");
    v("recorded_from_body", self.recorded_from_body, "",
      "pose of the body (x forward, z up) in the frame whose poses were recorded");
    v("tour", self.tour, "", "settings of the tour planner (kind auto)");
    v("style", self.style, "", "gentle, brisk or aggressive: preset of the limits");
    v("limits", self.limits, "", "limits that override those of the style");
    v("speed", self.speed, "",
      "factor on the speed along the same path: speed and heading rate change by it, acceleration "
      "by its square, jerk by its cube; max_tilt stays",
      between(0.1, 10));
    v("heading", self.heading, "", "direction of the body's x axis");
    v("corner_m", self.corner_m, "m",
      "maximum distance between the path and the polyline; a smaller value gives slower corners",
      Limits{0.001, 100.0, false});
    v("clearance_m", self.clearance_m, "m", "minimum distance from body center to any surface",
      at_least(0));
    v("duration_s", self.duration_s, "s",
      "duration of what is recorded: the path is repeated (back and forth if it is open) or cut "
      "short; 0 = once through",
      at_least(0));
    v("hover_s", self.hover_s, "s",
      "rest at the start and at the end; estimators initialize during the first", at_least(0));
    v("begin_s", self.begin_s, "s",
      "a start in motion: the recording begins this long after take-off, the end of the rest at "
      "the "
      "start (replay: after the first pose); without this key it begins with the rest",
      at_least(0));
    v("dynamics", self.dynamics, "",
      "simulate a quadrotor that follows the path ({} for the default one); without this key the "
      "path is followed exactly");
  }
};

/// The limits of the style, overridden by those of the file, for its speed.
FlightLimits limits_of(const FlightConfig& config);

}  // namespace lidarena::flight
