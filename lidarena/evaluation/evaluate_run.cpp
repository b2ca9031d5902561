// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/evaluate_run.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lidarena/evaluation/diagnosis/suspicion.hpp"
#include "lidarena/evaluation/metrics_json.hpp"
#include "lidarena/evaluation/resources.hpp"

namespace lidarena::evaluation {
namespace {

constexpr double kLowCoverage = 0.9;     // below, numbers describe only a part of the flight
constexpr double kLateStamps_s = 0.005;  // 5 cm at 10 m/s
constexpr double kHighFloor = 0.5;       // floor / error; above, the error is mostly interpolation
constexpr double kSmallFloor_m = 0.005;  // smaller floors cause no warning

struct Status {
  std::string name = "ok";
  std::string reason;
};

/// "`reason`; `suspicion`", or the reason alone without a suspicion.
std::string with_suspicion(std::string reason, const std::string& suspicion) {
  return suspicion.empty() ? reason : reason + "; " + suspicion;
}

Status status_of(const Trajectory& estimate, const Trajectory& truth) {
  if (estimate.empty()) return {"no_output", "the estimate has no poses"};
  if (estimate.size() == 1) return {"no_output", "the estimate has a single pose"};
  const std::string divergence = divergence_of(estimate, truth);
  if (!divergence.empty()) {
    return {"diverged", with_suspicion(divergence, suspect_quaternion_order(estimate, truth))};
  }
  if (matched_poses(estimate, truth).empty()) {
    return {"no_overlap", with_suspicion("no estimate lies inside the truth's time span",
                                         suspect_times(estimate, truth))};
  }
  return {};
}

/// The status of the manifest unless it is "ok", else that of the poses.
Status status_of(const dataset::RunFiles& run, const Trajectory& truth) {
  if (run.manifest.is_object()) {
    const std::string manifest_status = run.manifest.value("status", "ok");
    if (manifest_status != "ok")
      return {manifest_status, run.manifest.value("reason", "its manifest gives no reason")};
  }
  return status_of(run.trajectory, truth);
}

Json describe_truth(const Trajectory& truth) {
  if (truth.empty()) return nullptr;
  return {{"poses", truth.size()},
          {"rate_hz", 1.0 / std::max(1e-9, to_seconds(median_period(truth)))},
          {"duration_s", to_seconds(truth.end_time() - truth.begin_time())},
          {"path_m", truth.path_length()}};
}

/// The poses of a perfect estimate at the same instants.
Trajectory truth_at_estimates(const Trajectory& estimate, const Trajectory& truth) {
  std::vector<StampedPose> poses;
  for (const PosePair& pair : matched_poses(estimate, truth)) {
    poses.push_back({pair.stamp, pair.truth});
  }
  return Trajectory(std::move(poses), "truth at the estimates");
}

Json warnings_of(const Trajectory& estimate, const Trajectory& truth) {
  Json warnings = Json::array();
  const Association found = associate(estimate, truth);
  if (found.coverage < kLowCoverage) {
    warnings.push_back(
        fmt::format("the estimate covers {:.0f} % of the flight", 100.0 * found.coverage));
  }
  const std::optional<TimeOffset> offset = time_offset(estimate, truth);
  if (offset && std::abs(offset->late_s) > kLateStamps_s + 3.0 * offset->sigma_s) {
    warnings.push_back(fmt::format("the estimate's stamps seem {:.0f} ms late (not corrected)",
                                   1e3 * offset->late_s));
  }
  const double rpe = relative_pose_error(estimate, truth).translation_m.rmse;
  const double floor =
      relative_pose_error(truth_at_estimates(estimate, truth), truth).translation_m.rmse;
  if (floor > kHighFloor * rpe && floor > kSmallFloor_m) {
    warnings.push_back(
        fmt::format("of the {:.2f} cm of RPE per meter with interpolated ends, {:.2f} cm come from "
                    "interpolation between the estimates and would remain for a perfect "
                    "estimate: use the RPE between poses, or give poses more often",
                    100.0 * rpe, 100.0 * floor));
  }
  const std::string quaternions = suspect_quaternion_order(estimate, truth);
  const std::optional<LeverArm> arm = find_lever_arm(estimate, truth);
  for (const std::string& warning :
       {suspect_times(estimate, truth), quaternions,
        arm && quaternions.empty() ? warning_of(*arm) : std::string()}) {
    if (!warning.empty()) warnings.push_back(warning);
  }
  return warnings;
}

/// A relative error with its floor: the same error of a perfect estimate, which is caused by
/// interpolation between the estimates alone.
Json with_floor(const RelativePoseError& error, const RelativePoseError& of_perfect) {
  Json json = to_json(error);
  json["floor"] = nullptr;
  if (of_perfect.used > 0) {
    json["floor"] = {{"translation_rmse_m", of_perfect.translation_m.rmse},
                     {"rotation_rmse_rad", of_perfect.rotation_rad.rmse}};
  }
  return json;
}

/// Null when the run has no such map.
Json evaluate_map_of(const dataset::Cloud& cloud, const dataset::RunFiles& run,
                     const Trajectory& truth, const world::World& world, const Parallel& parallel,
                     const SeenSurface* seen, const IdentifiedMap* identified = nullptr) {
  if (cloud.points.empty()) return nullptr;
  return evaluate_map(cloud.points, run.trajectory, truth, world, parallel, seen, identified);
}

}  // namespace

std::string divergence_of(const Trajectory& estimate, const Trajectory& truth) {
  const std::vector<PosePair> pairs = matched_poses(estimate, truth);
  const Alignment alignment = align(pairs, Gauge::kFirstPose);
  const double limit = 2.0 * truth.path_length() + 1.0;
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d p = alignment.truth_from_estimate * pair.estimate.translation();
    const double error = (p - pair.truth.translation()).norm();
    if (error <= limit) continue;
    return fmt::format("{:.3g} m from the truth {:.1f} s into a flight of {:.3g} m", error,
                       to_seconds(pair.stamp - truth.begin_time()), truth.path_length());
  }
  return {};
}

Json evaluate_trajectory(const Trajectory& estimate, const Trajectory& truth) {
  const Status status = status_of(estimate, truth);
  Json json{{"status", status.name}, {"reason", status.reason}};
  const std::optional<TimeOffset> offset =
      status.name == "ok" ? time_offset(estimate, truth) : std::nullopt;
  json["association"] = to_json(associate(estimate, truth), offset);
  if (status.name != "ok") return json;
  json["association"]["lever_arm"] = to_json(find_lever_arm(estimate, truth));

  Json over_time;
  const Trajectory perfect = truth_at_estimates(estimate, truth);
  for (const double length : kRpeLengths_m) {
    const RelativePoseError rpe = relative_pose_error(estimate, truth, length, length);
    json["rpe"][fmt::format("{}m", length)] =
        with_floor(rpe, relative_pose_error(perfect, truth, length, length));
  }
  const RelativePoseError at_poses = relative_pose_error_at_poses(estimate, truth);
  json["rpe"]["1m_at_poses"] = to_json(at_poses);
  over_time["rpe_1m"] = errors_over_time(at_poses.segments, truth.begin_time());
  json["rpe"]["1s"] = with_floor(relative_pose_error_over_time(estimate, truth),
                                 relative_pose_error_over_time(perfect, truth));
  for (const Gauge gauge : {Gauge::kFirstPose, Gauge::kSe3, Gauge::kPosYaw}) {
    const AbsoluteTrajectoryError ate = absolute_trajectory_error(estimate, truth, gauge);
    json["ate"][to_string(gauge)] = to_json(ate);
    if (gauge != Gauge::kPosYaw) {
      over_time[fmt::format("ate_{}", to_string(gauge))] =
          errors_over_time(ate.poses, truth.begin_time());
    }
  }
  json["kitti"] = to_json(kitti_error(estimate, truth));
  json["kitti_short"] = to_json(kitti_error(estimate, truth, kRpeLengths_m));
  json["hover_jitter"] =
      to_json(hover_jitter(matched_poses(estimate, truth), gap_limit_of(estimate)));
  json["errors_over_time"] = over_time;
  return json;
}

Json evaluate_run(const dataset::RunFiles& run, const Trajectory& truth, const world::World* world,
                  const Parallel& parallel, LogSink& log, const Observe& observe) {
  const Status status = status_of(run, truth);
  Json json{{"schema", "lidarena.metrics"},
            {"schema_version", kMetricsSchemaVersion},
            {"status", status.name},
            {"reason", status.reason},
            {"warnings", Json::array()},
            {"truth", describe_truth(truth)},
            {"live", nullptr},
            {"final", nullptr},
            {"resources", resources_json(run.resources)},
            {"maps", {{"own", nullptr}, {"reprojected", nullptr}}}};
  if (status.name != "ok") {
    log.warn(fmt::format("not scored: {} ({})", status.name, status.reason));
    return json;
  }
  json["warnings"] = warnings_of(run.trajectory, truth);
  if (world != nullptr) {
    for (const auto& [name, cloud] :
         {std::pair("own", &run.map), {"reprojected", &run.reprojected}}) {
      for (const std::string& warning : map_warnings(cloud->points, *world)) {
        json["warnings"].push_back(fmt::format("{} map: {}", name, warning));
      }
    }
  }
  for (const Json& warning : json["warnings"]) log.warn(warning.get<std::string>());
  json["live"] = evaluate_trajectory(run.live, truth);
  json["final"] = evaluate_trajectory(run.trajectory, truth);
  if (world == nullptr) return json;
  std::optional<SeenSurface> seen;
  if (observe) {
    if (std::optional<RayTruth> rays = observe()) {
      seen = make_seen_surface(*std::move(rays), *world, parallel);
    }
  }
  const SeenSurface* surface = seen ? &*seen : nullptr;
  json["maps"]["own"] = evaluate_map_of(run.map, run, truth, *world, parallel, surface);
  json["maps"]["reprojected"] = evaluate_map_of(run.reprojected, run, truth, *world, parallel,
                                                surface, seen ? &seen->identified : nullptr);
  return json;
}

}  // namespace lidarena::evaluation
