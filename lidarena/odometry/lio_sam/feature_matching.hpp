// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/parallel.hpp"
#include "lidarena/estimation/feature_residuals.hpp"
#include "lidarena/map/feature_map.hpp"

namespace lidarena::odometry::lio_sam {

/// Sum of the residuals of a scan's features at `map_from_lidar`: of edges to lines and of surface
/// points to planes through their five nearest points of the map, up to 1 m away (section III-C.4).
estimation::PoseEquations match_features(const map::Features& features, const map::FeatureMap& map,
                                         const Pose& map_from_lidar, const Parallel& parallel);

}  // namespace lidarena::odometry::lio_sam
