// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/dataset/trajectories/tum.hpp"
#include "lidarena/report/scene_files.hpp"
#include "lidarena/report/simplified_mesh.hpp"
#include "lidarena/report/top_view.hpp"
#include "lidarena/results/study_cells.hpp"
#include "lidarena/world/mesh_io.hpp"

namespace lidarena::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPointsOfMesh = 200'000;
constexpr int kPlaceWidth = 420;
constexpr int kMapWidth = 560;

/// Positions of the estimate in the mesh's frame, by the alignment in its metrics.
std::vector<Eigen::Vector3d> aligned_positions(const results::RunRecord& row,
                                               const Trajectory& estimate) {
  const Pose gauge = (row.metrics ? results::truth_from_estimate(*row.metrics) : std::nullopt)
                         .value_or(Pose::Identity());
  std::vector<Eigen::Vector3d> positions;
  for (const StampedPose& p : estimate.poses()) {
    positions.push_back(gauge * p.world_from_body.translation());
  }
  return positions;
}

Picture map_picture(const results::RunRecord& row) {
  const auto truth = dataset::load_truth(row.folder / row.manifest.value("dataset", ""));
  const Trajectory estimate = dataset::read_tum(row.folder / "trajectory.tum");
  dataset::Cloud map;
  if (fs::exists(row.folder / "scored.ply")) map = dataset::read_cloud(row.folder / "scored.ply");
  TopView view;
  view.title = fmt::format("{}, {}", row.sensor, results::label_of(row));
  view.map = &map;
  view.truth = truth ? &*truth : nullptr;
  view.estimate = aligned_positions(row, estimate);
  view.width = kMapWidth;
  const std::string variant = results::variant_of(row);
  return {fmt::format("map-{}-{}-{}{}{}", row.world, row.sensor, row.algorithm,
                      variant.empty() ? "" : "-", variant),
          top_view_svg(view)};
}

std::vector<Picture> map_pictures(const results::StudyResults& results, const std::string& world) {
  std::vector<Picture> pictures;
  for (const results::RunRecord* row : first_seed_rows(results, world)) {
    if (fs::exists(row->folder / "trajectory.tum")) pictures.push_back(map_picture(*row));
  }
  return pictures;
}

/// The true path of a dataset; empty if it is not known.
std::vector<Eigen::Vector3d> positions_of(const fs::path& dataset) {
  std::vector<Eigen::Vector3d> positions;
  const auto truth = dataset::load_truth(dataset);
  if (!truth) return positions;
  for (const StampedPose& p : truth->poses()) {
    positions.push_back(p.world_from_body.translation());
  }
  return positions;
}

Picture place_picture(const std::string& id, const std::string& title, const dataset::Cloud& cloud,
                      std::vector<Eigen::Vector3d> path = {}) {
  TopView view;
  view.title = title;
  view.map = &cloud;
  view.estimate = std::move(path);
  view.width = kPlaceWidth;
  return {id, top_view_svg(view)};
}

std::vector<Picture> place_pictures(const results::StudyResults& results,
                                    const std::string& world) {
  std::vector<Picture> pictures;
  const auto first = std::ranges::find_if(results.rows, [&](const results::RunRecord& row) {
    return row.world == world && row.manifest.is_object() && row.manifest.contains("dataset");
  });
  if (first == results.rows.end()) return pictures;
  const fs::path dataset = first->folder / first->manifest.value("dataset", "");
  if (const auto mesh = dataset::find_world_mesh(dataset)) {
    dataset::Cloud surface;
    surface.points = points_on(world::load_mesh(*mesh), kPointsOfMesh);
    pictures.push_back(place_picture("world-" + world, world + ", with the flight path", surface,
                                     positions_of(dataset)));
  }
  struct Scan {
    const char* id;
    const char* file;
    const char* title;
  };
  std::set<std::string> sensors;
  for (const results::RunRecord& row : results.rows) {
    if (row.world != world || !sensors.insert(row.sensor).second) continue;
    for (const Scan& scan :
         {Scan{"scan", "_scan.ply", "one scan, de-skewed by the true motion"},
          Scan{"skewed", "_scan_skewed.ply", "the same scan without de-skewing"}}) {
      const fs::path file = dataset / (row.sensor + scan.file);
      if (!fs::exists(file)) continue;
      pictures.push_back(place_picture(fmt::format("{}-{}-{}", scan.id, world, row.sensor),
                                       row.sensor + ": " + scan.title, dataset::read_cloud(file)));
    }
  }
  return pictures;
}

}  // namespace

std::vector<const results::RunRecord*> first_seed_rows(const results::StudyResults& results,
                                                       const std::string& world) {
  std::vector<const results::RunRecord*> rows;
  std::set<std::string> seen;
  for (const results::RunRecord& row : results.rows) {
    if (row.world != world || row.status != "ok") continue;
    if (seen.insert(row.sensor + "|" + results::label_of(row)).second) {
      rows.push_back(&row);
    }
  }
  return rows;
}

std::vector<WorldPictures> draw_pictures(const results::StudyResults& results) {
  std::vector<WorldPictures> pictures;
  for (const std::string& world : results::StudyCells(results, "").worlds()) {
    pictures.push_back({world, place_pictures(results, world), map_pictures(results, world)});
  }
  return pictures;
}

}  // namespace lidarena::report
