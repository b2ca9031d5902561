// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/results/map_metrics.hpp"
#include "lidarena/results/resource_metrics.hpp"
#include "lidarena/results/trajectory_metrics.hpp"

/// What a run amounts to. Each struct lists its fields once; metrics.json and resources.json, their
/// schema, the tables, Python's dictionaries and the types of the report's page come from these
/// lists. Names contain units.
namespace lidarena::results {

/// Version of metrics.json; increased when a name or a meaning changes.
inline constexpr int kMetricsSchemaVersion = 3;

/// The truth that a run was scored against.
struct TruthFacts {
  std::size_t poses = 0;
  double rate_hz = 0.0, duration_s = 0.0, path_m = 0.0;
  bool empty() const { return poses == 0; }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("poses", self.poses, "", "");
    v("rate_hz", self.rate_hz, "Hz", "1 / median period");
    v("duration_s", self.duration_s, "s", "");
    v("path_m", self.path_m, "m", "length of the path");
  }
};

/// What interpolation between poses costs a re-projected map: the error that it has when the poses
/// are the true ones at the estimates' instants.
struct InterpolationFloor {
  std::size_t points = 0;
  std::optional<double> rmse_m, outliers_percent;
  bool empty() const { return points == 0; }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("points", self.points, "", "scored ones");
    v("rmse_m", self.rmse_m, "m", "root mean square");
    v("outliers_percent", self.outliers_percent, "%", "beyond 20 cm");
  }
};

/// What became of the scans of a run.
struct ScansOfRun {
  std::size_t registered = 0;
  std::size_t refused = 0;  ///< their times are not later than those of the scan before
  std::size_t dropped = 0;  ///< the method was late; paced and live runs only
  bool empty() const { return registered + refused + dropped == 0; }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("registered", self.registered, "", "");
    v("refused", self.refused, "", "not later than the scan before");
    v("dropped", self.dropped, "", "the method was late; paced and live runs only");
  }
};

struct MapsOfRun {
  std::optional<MapMetrics> own, reprojected;
  InterpolationFloor interpolation_floor;  ///< empty if the run tells the motion within its scans

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("own", self.own, "", "the map that the program publishes");
    v("reprojected", self.reprojected, "", "the scored returns placed along the estimated path");
    v("interpolation_floor", self.interpolation_floor, "",
      "of the re-projected map, from true poses at the estimates' instants; null where the run "
      "tells the motion within its scans");
  }
};

/// The body frames of trajectories that were given as files.
struct FramesOfFiles {
  std::string truth, lever;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("truth", self.truth, "", "body frame of the truth");
    v("lever", self.lever, "", "pose of the estimate's body frame in it, as given");
  }
};

/// All metrics of one run.
struct RunMetrics {
  std::string schema = "lidarena.metrics";
  int schema_version = kMetricsSchemaVersion;
  std::string status = "ok";
  std::string reason;
  std::optional<double> ended_at_s;
  std::vector<std::string> warnings;
  TruthFacts truth;
  ScansOfRun scans;
  std::optional<TrajectoryMetrics> live, final;
  MapsOfRun maps;
  std::optional<FramesOfFiles> frames;
  ResourceMetrics resources;  ///< differs between repeated runs, so it has a file of its own

  bool is_ok() const { return status == "ok"; }
  /// "diverged: REASON", or the status alone.
  std::string status_and_reason() const { return reason.empty() ? status : status + ": " + reason; }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("schema", self.schema, "", "");
    v("schema_version", self.schema_version, "", "");
    v("status", self.status, "", "ok, diverged, failed, no_output, no_overlap");
    v("reason", self.reason, "", "");
    v("ended_at_s", self.ended_at_s, "s",
      "last pose of a method that ended itself, since the truth's first pose; live and final are "
      "until then; null otherwise");
    v("warnings", self.warnings, "", "");
    v("truth", self.truth, "", "");
    v("scans", self.scans, "", "what became of them; null without a manifest that counts them");
    v("live", self.live, "", "poses as known at each scan");
    v("final", self.final, "", "poses at the end of the run");
    v("maps", self.maps, "", "");
    v("frames", self.frames, "", "");
    v("resources", self.resources, "", "in resources.json");
  }
};

/// Writes metrics.json (accuracy: the same bytes whenever it is computed) and resources.json.
void write_metrics(const std::filesystem::path& folder, const RunMetrics& metrics);
/// Reads both back; resources stay empty without resources.json. Throws InputError when
/// metrics.json is missing, damaged or of another schema version.
RunMetrics read_metrics(const std::filesystem::path& folder);

/// The alignment of the final trajectory with the truth that pictures use: SE(3) over all positions
/// where that is determined, else the first pose. Empty if the run was not scored.
std::optional<Pose> truth_from_estimate(const RunMetrics& metrics);
/// The scores of a map in that alignment; null if it was not scored.
const MapScores* scores_of(const std::optional<MapMetrics>& map);

/// A run that could not be scored.
RunMetrics failed_metrics(const std::string& reason);

}  // namespace lidarena::results
