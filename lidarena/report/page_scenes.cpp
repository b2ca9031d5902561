// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/page_scenes.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "lidarena/report/scene_files.hpp"
#include "lidarena/report/simplified_mesh.hpp"
#include "lidarena/results/lost.hpp"
#include "lidarena/results/study_cells.hpp"

namespace lidarena::report {
namespace {

namespace fs = std::filesystem;

// A point takes 8 bytes and a triangle about 18, a third more as text.
constexpr std::size_t kMaxPointsOfRun = 40'000;
constexpr std::size_t kGoodPointsOfRun = 18'000;  // as long as all runs together allow it
constexpr std::size_t kMinPointsOfRun = 2'000;    // fewer show nothing: the run is left out
constexpr std::size_t kPoints = 560'000;          // of all runs, where they have enough of them
constexpr std::size_t kMaxPoints = 3'500'000;     // of all runs together
constexpr std::size_t kPointsOfScan = 20'000;
constexpr std::size_t kPosesOfPath = 2'000;
constexpr std::size_t kTriangles = 100'000;  // of all meshes

std::size_t points_of_each(std::size_t runs) {
  const std::size_t share = std::clamp(kPoints / runs, kGoodPointsOfRun, kMaxPointsOfRun);
  return std::min(share, kMaxPoints / runs);
}

/// The first run of each flight, sensor and method, one that is not lost if there is one.
std::vector<const results::RunRecord*> shown_rows(const results::StudyResults& results,
                                                  const std::string& world) {
  std::vector<const results::RunRecord*> rows;
  std::map<std::string, std::size_t> places;
  for (const results::RunRecord& row : results.rows) {
    if (row.world != world || !fs::exists(row.folder / "scored.ply")) continue;
    const std::string cell = row.flight + "|" + row.sensor + "|" + results::label_of(row);
    const auto [place, is_new] = places.emplace(cell, rows.size());
    if (is_new) {
      rows.push_back(&row);
    } else if (results::is_lost(*rows[place->second]) && !results::is_lost(row)) {
      rows[place->second] = &row;
    }
  }
  return rows;
}

void add_scans(Scene& scene, const results::RunRecord& row) {
  SceneOptions options;
  options.max_points = kPointsOfScan;
  const fs::path dataset = row.folder / row.manifest->dataset;
  for (const auto& [name, ending] :
       {std::pair{"scan ", "_scan.ply"}, {"skewed ", "_scan_skewed.ply"}}) {
    const fs::path file = dataset / (row.sensor + ending);
    if (!fs::exists(file)) continue;
    add_cloud_file(scene, file, options);
    scene.clouds.back().name = name + row.sensor;
    scene.clouds.back().visible = false;
    scene.clouds.back().intensity.clear();
    scene.clouds.back().time.clear();
  }
}

/// Flights of one world have the same mesh.
void keep_one_mesh(Scene& scene, std::size_t max_triangles) {
  if (scene.meshes.empty()) return;
  scene.meshes.erase(scene.meshes.begin() + 1, scene.meshes.end());
  scene.meshes[0].name = "mesh";
  scene.meshes[0].mesh = simplified(scene.meshes[0].mesh, max_triangles);
}

Scene scene_of(const results::StudyResults& results, const std::string& world,
               const std::vector<const results::RunRecord*>& rows, std::size_t points,
               LogSink& log) {
  Scene scene;
  scene.title = world;
  SceneOptions options;
  options.map = MapChoice::kScored;
  options.max_points = points;
  options.max_poses = kPosesOfPath;
  for (const results::RunRecord* row : rows) {
    const std::size_t known = scene.paths.size();
    add_run(scene, row->folder, options, log);
    scene.clouds.back().name = row->name;
    for (std::size_t i = known; i < scene.paths.size(); ++i) {
      if (scene.paths[i].role == PathRole::kEstimate) scene.paths[i].name = row->name;
    }
  }
  std::set<std::string> sensors;
  for (const results::RunRecord& row : results.rows) {
    if (row.world == world && row.manifest && !row.manifest->dataset.empty() &&
        sensors.insert(row.sensor).second)
      add_scans(scene, row);
  }
  return scene;
}

}  // namespace

std::vector<PackedScene> page_scenes(const results::StudyResults& results, const Parallel& parallel,
                                     LogSink& log) {
  std::vector<PackedScene> scenes;
  const std::vector<std::string> worlds = results::StudyCells(results, "").worlds();
  std::size_t runs = 0;
  for (const std::string& world : worlds) runs += shown_rows(results, world).size();
  if (runs == 0) return scenes;
  const std::size_t points = points_of_each(runs);
  if (points < kMinPointsOfRun) {
    log.info("the page has no maps: the study has too many runs; `lidarena view RUN` shows them");
    return scenes;
  }
  for (const std::string& world : worlds) {
    Scene scene = scene_of(results, world, shown_rows(results, world), points, log);
    if (scene.clouds.empty()) continue;
    keep_one_mesh(scene, kTriangles / worlds.size());
    scenes.push_back(pack(scene, parallel));
  }
  return scenes;
}

}  // namespace lidarena::report
