// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/trajectories/trajectory_io.hpp"
#include "lidarena/results/run_metrics.hpp"

namespace lidarena::stages {

/// What of a run is scored. The trajectory always is.
enum class ScorePart {
  kTrajectory,
  kMap,
  kVertices  ///< of the maps, the distance to the vertices of the mesh as well
};
constexpr auto enum_names(ScorePart) {
  return std::array{std::pair{"trajectory", ScorePart::kTrajectory},
                    std::pair{"map", ScorePart::kMap}, std::pair{"vertices", ScorePart::kVertices}};
}
using ScoreParts = std::vector<ScorePart>;
/// Whether maps are scored: an empty list means trajectory and map.
bool scores_maps(const ScoreParts& parts);

/// A true trajectory that is not that of the run's dataset.
struct GivenTruth {
  dataset::FramedTrajectory poses;
  std::string lever;                    ///< as given, for the metrics; may be empty
  std::optional<Pose> truth_from_body;  ///< pose of the run's body in the frame of the truth
};

/// Scores the RUN folder against the truth and the mesh of the dataset that its manifest names, or
/// against `given`.
/// `parts`: without kMap and kVertices the maps are not read and have no metrics. Writes
/// metrics.json, resources.json and scored.ply (at most 400,000 map points in the mesh's frame with
/// their distance, for pictures). Throws InputError if the dataset has no truth.
results::RunMetrics score_run(const std::filesystem::path& run, const ScoreParts& parts,
                              const Parallel& parallel, LogSink& log,
                              const GivenTruth* given = nullptr);

/// Deletes the maps of a scored RUN folder and the motion that they were made with; trajectories,
/// metrics and manifest stay.
void remove_maps(const std::filesystem::path& run);

}  // namespace lidarena::stages
