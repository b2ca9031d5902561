// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "lidarena/results/run_record.hpp"

/// Scored runs without files.
namespace lidarena::results::made_up {

/// A summary of 100 values with this RMSE.
inline Summary rmse_of(double rmse) {
  Summary summary;
  summary.count = 100;
  summary.rmse = rmse;
  return summary;
}

/// Metrics with this drift per meter, and a published map with this share of outliers and an RMSE
/// of twice the drift.
inline RunMetrics metrics_of(double rpe_cm, double outliers_percent) {
  RunMetrics metrics;
  metrics.final.emplace().rpe.emplace().at_poses_1m.translation = rmse_of(0.01 * rpe_cm);
  MapScores& map = metrics.maps.own.emplace().se3;
  map.points = 100;
  map.distance_m = rmse_of(0.02 * rpe_cm);
  map.rmse_inliers_m = 0.01 * rpe_cm;
  map.outliers_percent = map.point_vertex.outliers_percent = outliers_percent;
  map.histogram.counts.assign(DistanceHistogram::kBins, 5);
  return metrics;
}

/// A run of the preset `indoor`.
inline RunRecord run_of(const std::string& world, const std::string& sensor,
                        const std::string& algorithm, double rpe_cm, double outliers_percent,
                        std::uint64_t seed = 1) {
  RunRecord run;
  run.name = world + "-" + sensor + "-" + algorithm + "-" + std::to_string(seed);
  run.world = run.flight = world;
  run.sensor = sensor;
  run.algorithm = algorithm;
  run.preset = "indoor";
  run.seed = seed;
  set_metrics(run, metrics_of(rpe_cm, outliers_percent));
  return run;
}

/// Makes a run one that diverged.
inline void lose(RunRecord& run) {
  run.status = "diverged";
  run.reason = "12 m from the truth";
  run.metrics.reset();
}

/// The published figures of a study, as if they were our runs, in the order of the study.
inline StudyResults runs_of_reference(std::vector<ReferenceFigure> reference) {
  StudyResults results;
  results.title = "published";
  results.reference = std::move(reference);
  for (const ReferenceFigure& drift : results.reference) {
    if (drift.figure != "rpe_1m_at_poses_translation") continue;
    const double outliers = reference_of(results, drift.world, drift.sensor, drift.algorithm,
                                         "own_map_outliers_vertices")
                                .value_or(0.0);
    results.rows.push_back(
        run_of(drift.world, drift.sensor, drift.algorithm, drift.value, outliers));
  }
  return results;
}

}  // namespace lidarena::results::made_up
