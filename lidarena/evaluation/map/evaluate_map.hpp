// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/evaluation/map/completeness.hpp"
#include "lidarena/evaluation/map/identity_error.hpp"
#include "lidarena/results/map_metrics.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::evaluation {

/// The surface that the flight's rays hit; computed once for all maps of a run.
struct SeenSurface {
  ObservedSurface observed;
  SurfaceSamples samples;
  IdentifiedMap identified;  ///< the re-projected map; empty when the true hits are not known
};
/// Ground truth of a flight's rays.
struct RayTruth {
  ObservedSurface observed;
  IdentifiedMap identified;
};
SeenSurface make_seen_surface(RayTruth truth, const world::World& world, const Parallel& parallel);

/// Scores one map (in the estimate's world frame) against the mesh in each gauge: "first_pose",
/// "se3", and "robust", which starts from "se3" (from "first_pose" where "se3" is refused). Without
/// `seen` the signed distance and the completeness are empty. Maps of more than 2 million points
/// (200,000 if more than 95 % of the points are beyond 20 cm) are evenly sampled to at most that
/// number; completeness uses all points. `identified`, if given, is the same map with its true
/// hits, for the identity error. A gauge that is not determined has a reason.
results::MapMetrics evaluate_map(std::span<const Eigen::Vector3f> map, const Trajectory& estimate,
                                 const Trajectory& truth, const world::World& world,
                                 const Parallel& parallel, const SeenSurface* seen = nullptr,
                                 const IdentifiedMap* identified = nullptr);

/// Warnings about the inputs: a mesh or a map that seems to be in millimeters, coordinates too
/// large for single precision, points that are not finite.
std::vector<std::string> map_warnings(std::span<const Eigen::Vector3f> map,
                                      const world::World& world);

}  // namespace lidarena::evaluation
