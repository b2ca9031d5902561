// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "lidarena/estimation/feature_residuals.hpp"
#include "lidarena/map/feature_map.hpp"

namespace lidarena::odometry {

/// How planes are fitted to the neighbors of a surface point, see estimation::fit_plane.
struct PlaneRule {
  estimation::PlaneFit fit = estimation::PlaneFit::kPrincipal;
  double max_thickness_m = 0.0;
  double min_aspect = 0.0;
};

/// Matches the features of a scan with lines and planes through their five nearest points of the
/// map, up to 1 m away (LIO-SAM, section III-C.4). The arguments must outlive it.
class FeatureMatcher {
 public:
  FeatureMatcher(const map::Features& features, const map::FeatureMap& map, const PlaneRule& planes,
                 const Parallel& parallel);

  /// Sum of the residuals at `map_from_lidar`. Without `search` the lines and planes are those of
  /// the last search.
  estimation::PoseEquations equations(const Pose& map_from_lidar, bool search);

 private:
  const map::Features& features_;
  const map::FeatureMap& map_;
  PlaneRule plane_rule_;
  const Parallel& parallel_;
  std::vector<std::optional<estimation::Line>> lines_;    ///< of the edges
  std::vector<std::optional<estimation::Plane>> planes_;  ///< of the surface points
};

}  // namespace lidarena::odometry
