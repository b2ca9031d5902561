// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/evaluate_run.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lidarena/evaluation/diagnosis/suspicion.hpp"
#include "lidarena/evaluation/resources.hpp"
#include "lidarena/evaluation/trajectory/hover_jitter.hpp"
#include "lidarena/evaluation/trajectory/kitti_error.hpp"
#include "lidarena/evaluation/trajectory/trajectory_metrics.hpp"

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
    const std::string unit = suspect_length_unit(estimate, truth);
    return {"diverged",
            with_suspicion(divergence,
                           unit.empty() ? suspect_quaternion_order(estimate, truth) : unit)};
  }
  if (matched_poses(estimate, truth).empty()) {
    return {"no_overlap", with_suspicion("no estimate lies inside the truth's time span",
                                         suspect_times(estimate, truth))};
  }
  return {};
}

/// The status of the manifest unless it is "ok", else that of the poses.
Status status_of(const dataset::RunFiles& run, const Trajectory& truth) {
  if (run.manifest.status == dataset::RunStatus::kOk) return status_of(run.trajectory, truth);
  return {value_to_json(run.manifest.status).get<std::string>(),
          run.manifest.reason.empty() ? "its manifest gives no reason" : run.manifest.reason};
}

results::TruthFacts facts_of(const Trajectory& truth) {
  if (truth.empty()) return {};
  return {truth.size(), 1.0 / std::max(1e-9, to_seconds(median_period(truth))),
          to_seconds(truth.end_time() - truth.begin_time()), truth.path_length()};
}

/// Says that the truth is sampled more coarsely than the estimate.
std::string warning_of_rates(const Trajectory& estimate, const Trajectory& truth) {
  if (!is_coarser(truth, estimate)) return {};
  return fmt::format(
      "the truth has {:.3g} poses a second, the estimate {:.3g}: they are compared at the truth's "
      "stamps only, and its path, a chord between them, is a lower bound of the length",
      1.0 / to_seconds(median_period(truth)), 1.0 / to_seconds(median_period(estimate)));
}

std::vector<std::string> warnings_of(const Trajectory& estimate, const Trajectory& truth) {
  std::vector<std::string> warnings;
  if (const std::string rates = warning_of_rates(estimate, truth); !rates.empty()) {
    warnings = warnings_of(at_truth_stamps(estimate, truth), truth);
    warnings.push_back(rates);
    return warnings;
  }
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
       {suspect_times(estimate, truth), suspect_length_unit(estimate, truth),
        suspect_constant_rotation(estimate, truth), quaternions,
        arm && quaternions.empty() ? warning_of(*arm) : std::string()}) {
    if (!warning.empty()) warnings.push_back(warning);
  }
  return warnings;
}

/// Says that scans were refused; empty if none was.
std::string warning_of_refused(const results::ScansOfRun& scans) {
  if (scans.refused == 0) return {};
  return fmt::format(
      "{} of {} scans were refused, because they are not later than the scan before: check the "
      "stamps of the recording",
      scans.refused, scans.registered + scans.refused);
}

/// Warnings about the maps that the run has.
std::vector<std::string> warnings_of_maps(const dataset::RunFiles& run, const world::World& world) {
  std::vector<std::string> warnings;
  for (const auto& [name, cloud] :
       {std::pair("own", &run.map), {"reprojected", &run.reprojected}}) {
    for (const std::string& warning : map_warnings(cloud->points, world)) {
      warnings.push_back(fmt::format("{} map: {}", name, warning));
    }
  }
  return warnings;
}

/// Errors over pieces of each length and duration, with the floors of a perfect estimate.
results::RpeByLength rpe_by_length(const Trajectory& estimate, const Trajectory& truth,
                                   const RelativePoseError& at_poses) {
  const Trajectory perfect = truth_at_estimates(estimate, truth);
  results::RpeByLength rpe;
  for (std::size_t i = 0; i < kRpeLengths_m.size(); ++i) {
    const double length = kRpeLengths_m[i];
    const RelativePoseError floor = relative_pose_error(perfect, truth, length, length);
    rpe.lengths[i] = metrics_of(relative_pose_error(estimate, truth, length, length), &floor);
  }
  rpe.at_poses_1m = metrics_of(at_poses);
  if (const auto best = relative_pose_error_at_best_offset(estimate, truth))
    rpe.at_best_offset_1m = metrics_of(*best);
  const RelativePoseError floor = relative_pose_error_over_time(perfect, truth);
  rpe.over_1s = metrics_of(relative_pose_error_over_time(estimate, truth), &floor);
  return rpe;
}

/// Whether a method that does not revise its past gave both.
bool are_same(const Trajectory& a, const Trajectory& b) {
  return std::ranges::equal(a.poses(), b.poses(), [](const StampedPose& p, const StampedPose& q) {
    return p.stamp == q.stamp && p.world_from_body.matrix() == q.world_from_body.matrix();
  });
}

/// The scores of both trajectories.
void score_trajectories(const dataset::RunFiles& run, const Trajectory& truth,
                        const Trajectory* at_clock, results::RunMetrics& metrics) {
  metrics.final = evaluate_trajectory(run.trajectory, truth, at_clock);
  metrics.live = are_same(run.live, run.trajectory)
                     ? metrics.final
                     : evaluate_trajectory(run.live, truth, at_clock);
}

/// When a run ended itself, and its scores until then if it has poses that can be scored.
void score_until_end(const dataset::RunFiles& run, const Trajectory& truth,
                     const Trajectory* at_clock, results::RunMetrics& metrics) {
  if (run.trajectory.empty() || truth.empty()) return;
  metrics.ended_at_s = to_seconds(run.trajectory.end_time() - truth.begin_time());
  if (status_of(run.trajectory, truth).name == "ok")
    score_trajectories(run, truth, at_clock, metrics);
}

/// Why the points of the map that the run publishes have no classes.
std::string no_classes_of(dataset::OwnMap map) {
  return map == dataset::OwnMap::kMeans
             ? "the points are means of returns, which may be of several classes"
             : "the map does not say of which returns its points are";
}

/// Scores of both maps, as far as the run has them.
results::MapsOfRun evaluate_maps(const dataset::RunFiles& run, const Trajectory& truth,
                                 const world::World& world, const Parallel& parallel,
                                 const MapScoring& scoring) {
  results::MapsOfRun maps;
  std::optional<SeenSurface> seen;
  if (scoring.observe) {
    if (std::optional<RayTruth> rays = scoring.observe()) {
      maps.interpolation_floor = interpolation_floor(rays->interpolated, world, parallel);
      seen = make_seen_surface(*std::move(rays), world, parallel);
    }
  }
  const MapReference reference(world, std::move(seen), scoring.vertices);
  if (!run.map.points.empty()) {
    maps.own = evaluate_map(run.map.points, run.trajectory, truth, reference, parallel);
    results::MapScores& shown = maps.own->se3.refused ? maps.own->first_pose : maps.own->se3;
    if (!shown.refused) shown.classes.refused = no_classes_of(run.manifest.own_map);
  }
  if (!run.reprojected.points.empty()) {
    maps.reprojected =
        evaluate_map(run.reprojected.points, run.trajectory, truth, reference, parallel,
                     reference.seen ? &reference.seen->identified : nullptr, scoring.scored);
  }
  return maps;
}

}  // namespace

std::string divergence_of(const Trajectory& estimate, const Trajectory& truth) {
  const std::vector<PosePair> pairs = matched_poses(estimate, truth);
  const Alignment alignment = align(pairs, AlignmentKind::kFirstPose);
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

results::TrajectoryMetrics evaluate_trajectory(const Trajectory& estimate, const Trajectory& truth,
                                               const Trajectory* at_clock) {
  if (is_coarser(truth, estimate))
    return evaluate_trajectory(at_truth_stamps(estimate, truth), truth, at_clock);
  const Status status = status_of(estimate, truth);
  const bool ok = status.name == "ok";
  results::TrajectoryMetrics metrics;
  metrics.status = status.name;
  metrics.reason = status.reason;
  metrics.association =
      metrics_of(associate(estimate, truth), ok ? time_offset(estimate, truth) : std::nullopt,
                 ok ? find_lever_arm(estimate, truth) : std::nullopt);
  if (!ok) return metrics;
  const RelativePoseError at_poses = relative_pose_error_at_poses(estimate, truth);
  const auto ate = [&](AlignmentKind kind) {
    return absolute_trajectory_error(estimate, truth, kind);
  };
  const AbsoluteTrajectoryError first_pose = ate(AlignmentKind::kFirstPose);
  const AbsoluteTrajectoryError se3 = ate(AlignmentKind::kSe3);
  metrics.rpe = rpe_by_length(estimate, truth, at_poses);
  if (at_clock != nullptr)
    metrics.rpe->at_lidar_clock_1m =
        metrics_at_clock(relative_pose_error_at_poses(estimate, *at_clock));
  metrics.ate = {metrics_of(first_pose), metrics_of(se3), metrics_of(ate(AlignmentKind::kPosYaw))};
  metrics.kitti = kitti_error(estimate, truth);
  metrics.kitti_short = kitti_error(estimate, truth, kRpeLengths_m);
  metrics.hover_jitter = hover_jitter(matched_poses(estimate, truth), gap_limit_of(estimate));
  const Time start = truth.begin_time();
  metrics.errors_over_time = {errors_over_time(at_poses.segments, start),
                              errors_over_time(first_pose.poses, start),
                              errors_over_time(se3.poses, start)};
  return metrics;
}

results::RunMetrics evaluate_run(const dataset::RunFiles& run, const Trajectory& truth,
                                 const world::World* world, const Parallel& parallel, LogSink& log,
                                 const MapScoring& maps, const Trajectory* at_clock) {
  const Status status = status_of(run, truth);
  results::RunMetrics metrics;
  metrics.status = status.name;
  metrics.reason = status.reason;
  metrics.truth = facts_of(truth);
  const dataset::RunCounts& counts = run.manifest.summary;
  metrics.scans = {counts.scans, counts.refused, counts.dropped};
  metrics.resources = resource_metrics(run.resources);
  if (!metrics.is_ok()) {
    if (run.manifest.status == dataset::RunStatus::kDiverged)
      score_until_end(run, truth, at_clock, metrics);
    log.warn(fmt::format("not scored{}: {} ({})", metrics.final ? " as a whole" : "", status.name,
                         status.reason));
    return metrics;
  }
  metrics.warnings = warnings_of(run.trajectory, truth);
  if (std::string refused = warning_of_refused(metrics.scans); !refused.empty())
    metrics.warnings.push_back(std::move(refused));
  if (world != nullptr) {
    for (std::string& warning : warnings_of_maps(run, *world)) {
      metrics.warnings.push_back(std::move(warning));
    }
  }
  for (const std::string& warning : metrics.warnings) log.warn(warning);
  score_trajectories(run, truth, at_clock, metrics);
  if (world != nullptr) metrics.maps = evaluate_maps(run, truth, *world, parallel, maps);
  return metrics;
}

}  // namespace lidarena::evaluation
