// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/evaluation/map/completeness.hpp"
#include "lidarena/evaluation/map/identity_error.hpp"
#include "lidarena/evaluation/map/vertex_distance.hpp"
#include "lidarena/results/run_metrics.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::evaluation {

/// The surface that the flight's rays hit.
struct SeenSurface {
  ObservedSurface observed;
  SurfaceSamples samples;
  IdentifiedMap identified;  ///< the re-projected map; empty when the true hits are not known
};
/// Ground truth of a flight's rays.
struct RayTruth {
  ObservedSurface observed;
  IdentifiedMap identified;
  /// The re-projected map that interpolation between perfect estimates at the same instants gives;
  /// empty if the run tells the motion within its scans. World frame, m.
  std::vector<Eigen::Vector3f> interpolated = {};
};
SeenSurface make_seen_surface(RayTruth truth, const world::World& world, const Parallel& parallel);

/// What the maps of a run are scored against; computed once for all of them.
struct MapReference {
  const world::World& world;
  std::optional<SubdividedMesh> subdivided;  ///< empty: the distance to vertices is empty
  std::optional<SeenSurface> seen;           ///< empty: signed distance and completeness are empty

  explicit MapReference(const world::World& mesh, std::optional<SeenSurface> surface = {},
                        bool vertices = false)
      : world(mesh), seen(std::move(surface)) {
    if (vertices) subdivided.emplace(mesh);
  }
};

/// Distances to the mesh, of every `stride`-th point of a map.
struct ScoredPoints {
  Pose mesh_from_map = Pose::Identity();
  std::size_t stride = 0;        ///< 0: none were scored
  std::vector<float> distances;  ///< m, NaN of points that are not finite
};

/// Scores one map (in the estimate's world frame) against the mesh in each alignment: "first_pose",
/// "se3", and "robust", which starts from "se3" (from "first_pose" where "se3" is refused). Maps of
/// more than 2 million points (200,000 if more than 95 % of the points are beyond 20 cm) are evenly
/// sampled to at most that number in the alignment whose figures tables show ("se3", else
/// "first_pose"), to at most 250,000 in the others and for the distance to vertices. Completeness,
/// which uses all points, signed distance, identity error and classes are of that alignment alone.
/// `identified`, if given, is the same map with its true hits, for the last two. An alignment
/// that is not determined has a reason. `scored`, if given, gets the distances in the alignment
/// "se3".
results::MapMetrics evaluate_map(std::span<const Eigen::Vector3f> map, const Trajectory& estimate,
                                 const Trajectory& truth, const MapReference& reference,
                                 const Parallel& parallel,
                                 const IdentifiedMap* identified = nullptr,
                                 ScoredPoints* scored = nullptr);

/// Errors of `interpolated` (see RayTruth) where it lies; empty without points.
results::InterpolationFloor interpolation_floor(std::span<const Eigen::Vector3f> interpolated,
                                                const world::World& world,
                                                const Parallel& parallel);

/// Warnings about the inputs: a mesh or a map that seems to be in millimeters, coordinates too
/// large for single precision, points that are not finite.
std::vector<std::string> map_warnings(std::span<const Eigen::Vector3f> map,
                                      const world::World& world);

}  // namespace lidarena::evaluation
