// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>

#include "lidarena/base/log.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/report/scene.hpp"

namespace lidarena {

/// Which maps of a RUN folder are shown.
enum class MapChoice {
  kReprojected,  ///< all returns with the estimated path
  kOwn,          ///< as the program publishes it
  kBoth,
  kScored  ///< the sample of all returns that evaluation kept, with its distances
};
template <>
struct EnumNames<MapChoice> {
  static constexpr std::array names{
      std::pair{"reprojected", MapChoice::kReprojected}, std::pair{"own", MapChoice::kOwn},
      std::pair{"both", MapChoice::kBoth}, std::pair{"scored", MapChoice::kScored}};
};

struct SceneOptions {
  std::size_t max_points = 5'000'000;  ///< of one cloud; a larger one is thinned at random
  MapChoice map = MapChoice::kReprojected;
};

/// Adds a .ply or .pcd file of points with its distance, intensity and time (s), where it has them.
/// Throws InputError.
void add_cloud_file(Scene& scene, const std::filesystem::path& file, const SceneOptions& options);

/// Adds a trajectory of any format that we read. Throws InputError.
void add_path_file(Scene& scene, const std::filesystem::path& file);

/// Adds the points of all LiDARs of a dataset, each moved to the world by the true motion at its
/// own instant, the true path and the mesh. Without a truth points stay in the sensor's frame, a
/// scan at a time. Throws InputError.
void add_dataset(Scene& scene, Dataset dataset, const SceneOptions& options, LogSink& log);

/// Adds the maps and the path of a RUN folder, laid over the truth by the SE(3) gauge of its
/// metrics.json where there is one, and the truth and the mesh of its dataset, if found. Throws
/// InputError when the folder is no finished run.
void add_run(Scene& scene, const std::filesystem::path& folder, const SceneOptions& options,
             LogSink& log);

/// Gives every cloud that has no distances yet those to the scene's meshes; nothing without a mesh.
/// Points farther than 2 m from them get none (NaN).
void measure_distances(Scene& scene, const Parallel& parallel);

}  // namespace lidarena
