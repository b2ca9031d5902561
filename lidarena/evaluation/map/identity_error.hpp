// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/dataset/point_truth.hpp"
#include "lidarena/evaluation/map/reproject.hpp"
#include "lidarena/results/map_metrics.hpp"

namespace lidarena::evaluation {

/// A re-projected map with the true hit of each point.
struct IdentifiedMap {
  std::vector<Eigen::Vector3f> points;    ///< m, the estimate's world frame
  std::vector<dataset::PointTruth> hits;  ///< one per point
};

/// Finds the true hit of the return that each map point came from; points whose scan or return is
/// missing in the truth are left out. `origins` as reproject() returns them, with ascending scan
/// numbers.
IdentifiedMap identify(std::span<const Eigen::Vector3f> map, std::span<const ReturnOrigin> origins,
                       dataset::ScanTruthSource& truth);

using results::IdentityError;
IdentityError identity_error(const IdentifiedMap& map, const Pose& mesh_from_map);

}  // namespace lidarena::evaluation
