// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/dataset/point_truth.hpp"
#include "lidarena/evaluation/reproject.hpp"
#include "lidarena/evaluation/summary.hpp"

namespace lidarena {

/// A re-projected map whose points know what they really hit.
struct IdentifiedMap {
  std::vector<Eigen::Vector3f> points;  ///< m, the estimate's world frame
  std::vector<PointTruth> hits;         ///< one a point
};

/// Follows each point to its return and that to its true hit; points whose scan or return the truth
/// lacks are left out. `origins` as reproject() gives them, so scans in order.
IdentifiedMap identify(std::span<const Eigen::Vector3f> map, std::span<const ReturnOrigin> origins,
                       ScanTruthSource& truth);

/// Distance of each point from where its own ray really hit, not from whatever surface is nearest:
/// what the distance to the mesh is a lower bound of. All in m.
struct IdentityError {
  Summary distance_m;
  Summary normal_m;      ///< its part along the surface's normal, without sign
  Summary tangential_m;  ///< its part along the surface
};
IdentityError identity_error(const IdentifiedMap& map, const Pose& mesh_from_map);

}  // namespace lidarena
