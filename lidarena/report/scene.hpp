// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/time.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::report {

/// A distance above which a point counts as an outlier, m.
inline constexpr double kOutlier_m = 0.20;

/// Points to show, with their fields. A field is empty or has one value per point, NaN where a
/// point has none.
struct SceneCloud {
  std::string name;
  std::vector<Eigen::Vector3f> points;  ///< m, relative to Scene::origin
  std::vector<float> distance;          ///< to the mesh, m
  std::vector<float> intensity;
  std::vector<float> time;   ///< s since Scene::time_origin
  std::size_t left_out = 0;  ///< points of the file that were dropped
  bool visible = true;       ///< shown at first
};

enum class PathRole { kTruth, kEstimate };

/// A trajectory in the frame of the scene.
struct ScenePath {
  std::string name;
  PathRole role = PathRole::kEstimate;
  Trajectory trajectory;        ///< not relative to Scene::origin
  std::vector<double> error_m;  ///< empty, or one per pose: distance to the truth
};

struct SceneMesh {
  std::string name;
  world::TriangleMesh mesh;  ///< not relative to Scene::origin
};

/// What the 3D view shows: everything in one frame, meters, z up.
struct Scene {
  std::string title;
  std::string frame = "world";                       ///< name of the coordinates' frame
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< keeps single precision accurate
  Time time_origin{0};
  double window_s = 0.0;  ///< length of the time window shown at first; 0 = all
  std::vector<SceneCloud> clouds;
  std::vector<ScenePath> paths;
  std::vector<SceneMesh> meshes;
};

/// Box to show, relative to the origin: contains paths, meshes and, in each direction, 99.8 % of
/// the points of each cloud, so that a few stray points do not shrink the picture. A cube of 1 m
/// for an empty scene.
Eigen::AlignedBox3d bounds_to_show(const Scene& scene);

/// First and last instant of paths and timed points, s since the time origin.
std::optional<std::pair<double, double>> time_span(const Scene& scene);

}  // namespace lidarena::report
