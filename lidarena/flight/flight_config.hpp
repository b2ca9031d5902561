// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/flight/quadrotor_config.hpp"

namespace lidarena {

/// Where the path comes from.
enum class FlightKind { kWaypoints, kRoute, kReplay, kAuto };
template <>
struct EnumNames<FlightKind> {
  static constexpr std::array names{
      std::pair{"waypoints", FlightKind::kWaypoints}, std::pair{"route", FlightKind::kRoute},
      std::pair{"replay", FlightKind::kReplay}, std::pair{"auto", FlightKind::kAuto}};
};

/// How hard the body is flown.
enum class FlightStyle { kGentle, kBrisk, kAggressive };
template <>
struct EnumNames<FlightStyle> {
  static constexpr std::array names{std::pair{"gentle", FlightStyle::kGentle},
                                    std::pair{"brisk", FlightStyle::kBrisk},
                                    std::pair{"aggressive", FlightStyle::kAggressive}};
};

/// Bounds that hold at every instant of a flight through waypoints.
struct FlightLimits {
  double max_speed = 0.0;         ///< m/s
  double max_acceleration = 0.0;  ///< m/s^2, without gravity
  double max_jerk = 0.0;          ///< m/s^3
  double max_tilt = 0.0;          ///< rad, of the body's z axis from the vertical
  double max_yaw_rate = 0.0;      ///< rad/s
};

/// Limits of a style: a careful inspection, an everyday flight, a race through rooms.
FlightLimits limits_of(FlightStyle style);

/// Limits that differ from the style's.
struct LimitsConfig {
  std::optional<double> max_speed, max_acceleration, max_jerk, max_tilt, max_yaw_rate;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("max_speed", self.max_speed, "m/s", "top speed", above(0));
    v("max_acceleration", self.max_acceleration, "m/s^2", "without gravity", above(0));
    v("max_jerk", self.max_jerk, "m/s^3", "lower means softer turns and brakes", above(0));
    v("max_tilt", self.max_tilt, "rad", "of the body from the vertical", Limits{0.0, 1.5, true});
    v("max_yaw_rate", self.max_yaw_rate, "rad/s", "of the heading", above(0));
  }
};

enum class HeadingMode { kAlongPath, kFixed, kSweep };
template <>
struct EnumNames<HeadingMode> {
  static constexpr std::array names{std::pair{"along_path", HeadingMode::kAlongPath},
                                    std::pair{"fixed", HeadingMode::kFixed},
                                    std::pair{"sweep", HeadingMode::kSweep}};
};

struct HeadingConfig {
  HeadingMode mode = HeadingMode::kAlongPath;
  double yaw = 0.0;
  double amplitude = 0.6;
  double period_s = 3.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("mode", self.mode, "", "along_path, fixed, or sweep: to and fro about the path's direction");
    v("yaw", self.yaw, "rad", "heading of `fixed`, from the world's x axis");
    v("amplitude", self.amplitude, "rad", "of `sweep`", at_least(0));
    v("period_s", self.period_s, "s", "of `sweep`", above(0));
  }
};

/// How a tour is planned (kind auto), see plan_tour().
struct TourConfig {
  std::optional<Eigen::Vector3d> start;
  double coverage = 0.9;
  double range_m = 20.0;
  double margin_m = 0.0;
  double cell_m = 0.1;
  int max_cells = 300000;
  int max_views = 800;
  int samples = 5000;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("start", self.start, "m", "where it begins and ends; found when absent");
    v("coverage", self.coverage, "", "share of what can be seen that its views see, by area",
      between(0.01, 1));
    v("range_m", self.range_m, "m", "from how far a surface counts as seen", above(0));
    v("margin_m", self.margin_m, "m", "kept beyond clearance_m: for what a quadrotor strays",
      at_least(0));
    v("cell_m", self.cell_m, "m", "edge of the grid's cells; larger where max_cells asks for it",
      Limits{0.02, 10.0, false});
    v("max_cells", self.max_cells, "", "most cells; bounds time and memory", between(100, 1e8));
    v("max_views", self.max_views, "", "most places to choose views from", between(2, 1e5));
    v("samples", self.samples, "", "points of the surface by which coverage is measured",
      between(10, 1e7));
  }
};

/// A file of configs/flights.
struct FlightConfig {
  FlightKind kind = FlightKind::kWaypoints;
  std::vector<Eigen::Vector3d> waypoints;
  int route = 0;
  std::string replay;
  double replay_step_s = 0.0;
  Pose world_from_recording = Pose::Identity();
  Pose recorded_from_body = Pose::Identity();
  TourConfig tour;
  FlightStyle style = FlightStyle::kBrisk;
  LimitsConfig limits;
  HeadingConfig heading;
  double corner_m = 0.15;
  double clearance_m = 0.3;
  double duration_s = 0.0;
  double hover_s = 1.0;
  std::optional<DynamicsConfig> dynamics;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("kind", self.kind, "",
      "waypoints, route (one of the world's own), replay (a TUM file) or auto (a planned tour)");
    v("waypoints", self.waypoints, "m", "list of [x, y, z]; the path is the line through them");
    v("route", self.route, "", "which of the world's routes", at_least(0));
    v("replay", self.replay, "", "TUM file, relative to this file");
    v("replay_step_s", self.replay_step_s, "s",
      "least time between poses that are used; more keeps a recording's noise out of the rates",
      at_least(0));
    v("world_from_recording", self.world_from_recording, "", "where a replay is flown");
    v("recorded_from_body", self.recorded_from_body, "",
      "our body (x forward, z up) in the frame whose poses were recorded");
    v("tour", self.tour, "", "how kind auto plans");
    v("style", self.style, "", "gentle, brisk or aggressive: the limits that `limits` starts from");
    v("limits", self.limits, "", "limits that differ from the style's");
    v("heading", self.heading, "", "where the body's x axis looks");
    v("corner_m", self.corner_m, "m",
      "largest distance between the path and the line; smaller means slower corners",
      Limits{0.001, 100.0, false});
    v("clearance_m", self.clearance_m, "m", "least distance from body center to any surface",
      at_least(0));
    v("duration_s", self.duration_s, "s",
      "length of the flight: it loops (to and fro when the line is open) or stops early; 0 = once "
      "through",
      at_least(0));
    v("hover_s", self.hover_s, "s", "rest at begin and end; estimators initialize in it",
      at_least(0));
    v("dynamics", self.dynamics, "",
      "a quadrotor that follows the path as well as it can, {} for the default one; without this "
      "key the path is followed exactly");
  }
};

/// The style's limits with the file's changes.
FlightLimits limits_of(const FlightConfig& config);

}  // namespace lidarena
