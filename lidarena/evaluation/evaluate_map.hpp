// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/evaluation/completeness.hpp"
#include "lidarena/evaluation/identity_error.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {

/// What the flight's rays saw, made once for all maps of a run.
struct SeenSurface {
  ObservedSurface observed;
  SurfaceSamples samples;
  IdentifiedMap identified;  ///< the re-projected map; empty where no hits are known
};
/// What is known of a flight's rays.
struct RayTruth {
  ObservedSurface observed;
  IdentifiedMap identified;
};
SeenSurface make_seen_surface(RayTruth truth, const World& world, const Parallel& parallel);

/// One map (in the estimate's world frame) against the mesh, by gauge: "first_pose", "se3", and
/// "robust", which starts from "se3" (from "first_pose" where that is refused). Without `seen` the
/// signed distance and the completeness are null. Of maps beyond 2 million points (lost ones:
/// 200,000) an even sample of at most so many is scored (completeness looks at all). `identified`,
/// if given, is the same map with its hits, for the identity error. A gauge that cannot be had says
/// why under "refused".
Json evaluate_map(std::span<const Eigen::Vector3f> map, const Trajectory& estimate,
                  const Trajectory& truth, const World& world, const Parallel& parallel,
                  const SeenSurface* seen = nullptr, const IdentifiedMap* identified = nullptr);

/// What looks wrong before any distance is taken: a mesh or a map that seems to be in millimeters,
/// coordinates so large that single precision is too coarse, points that are not finite.
std::vector<std::string> map_warnings(std::span<const Eigen::Vector3f> map, const World& world);

}  // namespace lidarena
