// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "lidarena/base/point_truth.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/evaluation/map/reproject.hpp"
#include "lidarena/results/map_metrics.hpp"

namespace lidarena::evaluation {

/// A re-projected map with the true hit of each point.
struct IdentifiedMap {
  std::vector<Eigen::Vector3f> points;   ///< m, the estimate's world frame
  std::vector<PointTruth> hits;          ///< one per point
  std::vector<PointClass> classes = {};  ///< one per point of the whole map
};

/// Finds the true hit of the return that each point of a map came from. Points whose scan or return
/// is missing in the truth are left out and have no class. `map` has origins, as reproject() gives
/// them; `triangles` is the number of the world's.
IdentifiedMap identify(const dataset::Cloud& map, ScanTruthSource& truth, std::size_t triangles);

using results::IdentityError;
IdentityError identity_error(const IdentifiedMap& map, const Pose& mesh_from_map);

}  // namespace lidarena::evaluation
