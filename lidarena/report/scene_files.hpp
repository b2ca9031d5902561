// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>

#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/report/scene.hpp"

namespace lidarena::report {

/// Which maps of a RUN folder are shown.
enum class MapChoice {
  kReprojected,  ///< sampled returns, placed along the estimated path
  kOwn,          ///< the map that the algorithm publishes
  kBoth,
  kScored  ///< the sample of returns that evaluation kept, with its distances
};
constexpr auto enum_names(MapChoice) {
  return std::array{std::pair{"reprojected", MapChoice::kReprojected},
                    std::pair{"own", MapChoice::kOwn}, std::pair{"both", MapChoice::kBoth},
                    std::pair{"scored", MapChoice::kScored}};
}

struct SceneOptions {
  std::size_t max_points = 5'000'000;  ///< per cloud; a larger one is thinned at random
  std::size_t max_poses = 20'000;      ///< per path; more would not be visible
  MapChoice map = MapChoice::kReprojected;
};

/// Adds a .ply or .pcd file of points, with distance, intensity and time (s) if it has them. Throws
/// InputError.
void add_cloud_file(Scene& scene, const std::filesystem::path& file, const SceneOptions& options);

/// Adds a trajectory of any supported format. Throws InputError.
void add_path_file(Scene& scene, const std::filesystem::path& file);

/// Adds the points of all LiDARs of a dataset, each transformed to the world frame by the true pose
/// at its own instant, the true path and the mesh. Without a truth, points stay in the sensor's
/// frame and one scan is shown at a time. Throws InputError.
void add_dataset(Scene& scene, dataset::Dataset dataset, const SceneOptions& options, LogSink& log);

/// Adds the maps and the path of a RUN folder, aligned to the truth by the alignment in its
/// metrics.json if there is one, and the truth and the mesh of its dataset, if found. Throws
/// InputError if the folder is not a finished run.
void add_run(Scene& scene, const std::filesystem::path& folder, const SceneOptions& options,
             LogSink& log);

/// Computes the distances to the scene's meshes for every cloud that has none; does nothing without
/// a mesh. Points farther than 2 m from the meshes get NaN.
void measure_distances(Scene& scene, const Parallel& parallel);

}  // namespace lidarena::report
