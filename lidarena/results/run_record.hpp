// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/dataset/dataset_manifest.hpp"
#include "lidarena/dataset/run_manifest.hpp"
#include "lidarena/results/expectation.hpp"
#include "lidarena/results/figures.hpp"
#include "lidarena/results/known_row.hpp"
#include "lidarena/results/run_metrics.hpp"

namespace lidarena::results {

/// What a run's dataset was simulated from, as `lidarena simulate` takes it: names in configs/, or
/// files.
struct Sources {
  std::string world, flight;
  std::vector<std::string> sensors;
};

/// One run in the report.
struct RunRecord {
  std::string name;  ///< name of the run's folder
  std::filesystem::path folder;
  std::string world, flight, sensor, algorithm, preset;
  std::string mode;       ///< timing mode of the sensors if the study sets one: "rolling", ...
  std::string variation;  ///< what differs from the base of the study; empty: nothing
  Json varied = Json::object();      ///< each key that the study varies, with its value in this run
  std::vector<std::string> differs;  ///< those whose value is not that of the base, or a set's name
  std::uint64_t seed = 0;
  std::string status = "ok";  ///< ok, diverged, failed, not scored, not flown, ...
  std::string reason;
  std::optional<RunMetrics> metrics;  ///< empty if the run was not scored
  std::optional<KnownRow> known;      ///< its figures, if they are all that is left of it
  std::string key;                    ///< of code, settings and seed, in a study; may be empty
  std::optional<dataset::RunManifest> manifest;
  std::optional<LidarInfo> lidar;                       ///< in its dataset's rig
  std::optional<dataset::SimulationRecord> simulation;  ///< how its dataset was simulated
  Sources sources;
};

/// Runs are compared only within one reading: the preset, or "PRESET-MODE" if the study sets timing
/// modes.
std::string variant_of(const RunRecord& row);
std::string variant_of(const std::string& preset, const std::string& mode);
/// The algorithm with its variant: "fast_lio2 (indoor)"; "arena_lio" if it has no presets.
std::string label_of(const RunRecord& row);

/// The figure of a scored run; empty if it has none.
std::optional<double> value_of(const RunRecord& run, const Figure& figure);
/// The upper bound (%) of a share of which 0 of N points were found; empty for any other figure.
std::optional<double> zero_bound_of(const RunRecord& run, const Figure& figure);
/// Share of the flight (%) that the final trajectory covers; empty if the run was not scored.
std::optional<double> coverage_of(const RunRecord& run);
/// When the method ended itself, s after the begin; empty if it did not, or if that is not known.
std::optional<double> ended_at_s(const RunRecord& run);
/// The varied keys of all runs, in their order.
std::vector<std::string> varied_keys(const std::vector<RunRecord>& runs);
/// Sets the metrics and the status.
void set_metrics(RunRecord& run, RunMetrics metrics);

/// Status of a planned run that has no files yet.
inline constexpr const char* kMissing = "missing";
/// Status of a run whose flight could not be simulated: no method has seen it.
inline constexpr const char* kNotFlown = "not flown";
/// What the reason of such a run begins with.
inline constexpr const char* kFlightFailed = "flight: ";

struct StudyResults {
  std::string title;
  std::vector<RunRecord> rows;
  /// Missing or not flown: they count for no method and are in no figure.
  std::vector<RunRecord> without_result;
  std::vector<Expectation> expect;
  std::vector<ReferenceFigure> reference;  ///< published figures, shown beside those of the runs
};

/// Reads a study's folder (plan.json names the runs; one without files is missing) or
/// one RUN folder. Throws InputError if it is neither.
StudyResults read_results(const std::filesystem::path& folder);
/// Merges the parts of one study, or several studies. Of runs with the same name, the first one
/// that was scored is kept, else the first one that is not missing, else the first one.
StudyResults merged(std::vector<StudyResults> parts);

/// One row per run with all figures (see column_of()); empty cells for figures that do not exist.
std::string results_csv(const StudyResults& results);
/// The main figures, aligned for a terminal.
std::string results_text(const StudyResults& results);

}  // namespace lidarena::results
