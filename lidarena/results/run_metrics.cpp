// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/run_metrics.hpp"

#include <fmt/format.h>

#include <cmath>

#include "lidarena/base/config_json.hpp"
#include "lidarena/dataset/json_file.hpp"

namespace lidarena::results {
namespace {

constexpr int kOldestReadableVersion = 2;  // lacks only keys whose value would be null

}  // namespace

const CompletenessRow* Completeness::within(double distance_m) const {
  for (const CompletenessRow& row : rows) {
    if (std::abs(row.within_m - distance_m) < 1e-9) return &row;
  }
  return nullptr;
}

void write_metrics(const std::filesystem::path& folder, const RunMetrics& metrics) {
  Json accuracy = to_json(metrics);
  dataset::write_json(folder / "resources.json", accuracy.at("resources"));
  accuracy.erase("resources");
  dataset::write_json(folder / "metrics.json", accuracy);
}

RunMetrics read_metrics(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "metrics.json";
  RunMetrics metrics;
  const Json json = dataset::read_json(file);
  const int version = json.is_object() ? json.value("schema_version", 0) : 0;
  if (version < kOldestReadableVersion || version > kMetricsSchemaVersion) {
    throw InputError(file.string(),
                     fmt::format("has schema version {}, this program reads {} to {}", version,
                                 kOldestReadableVersion, kMetricsSchemaVersion),
                     "score the run again: lidarena evaluate " + folder.string());
  }
  read_json(json, metrics, file.string());
  if (const std::filesystem::path resources = folder / "resources.json";
      std::filesystem::exists(resources)) {
    read_json(dataset::read_json(resources), metrics.resources, resources.string());
  }
  return metrics;
}

std::optional<Pose> truth_from_estimate(const RunMetrics& metrics) {
  if (!metrics.final || !metrics.final->ate) return std::nullopt;
  const AteByAlignment& ate = *metrics.final->ate;
  return ate.se3.truth_from_estimate ? ate.se3.truth_from_estimate
                                     : ate.first_pose.truth_from_estimate;
}

const MapScores* scores_of(const std::optional<MapMetrics>& map) {
  if (!map) return nullptr;
  const MapScores& scores = map->se3.refused ? map->first_pose : map->se3;
  return scores.refused || scores.points == 0 ? nullptr : &scores;
}

RunMetrics failed_metrics(const std::string& reason) {
  RunMetrics metrics;
  metrics.status = "failed";
  metrics.reason = reason;
  return metrics;
}

}  // namespace lidarena::results
