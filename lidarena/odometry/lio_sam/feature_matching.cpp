// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/feature_matching.hpp"

#include <array>
#include <vector>

namespace lidarena::odometry::lio_sam {
namespace {

using estimation::FivePoints;
using estimation::PoseEquations;

constexpr float kMaxNeighbor = 1.0F;        // m, maximum distance of the fifth neighbor
constexpr double kMaxPlaneThickness = 0.2;  // m, maximum distance of a neighbor from the plane

std::optional<estimation::Plane> plane_through(const FivePoints& near) {
  return estimation::fit_plane(near, kMaxPlaneThickness);
}

template <class Fit, class Residual>
PoseEquations sum_of(const std::vector<Eigen::Vector3f>& points, const map::KdTree& map,
                     const Pose& pose, const Parallel& parallel, Fit&& fit,
                     Residual&& residual_of) {
  return estimation::accumulate_normal_equations<6>(
      parallel, points.size(), [&](std::size_t i, PoseEquations& sum) {
        const Eigen::Vector3d point = points[i].cast<double>();
        std::array<map::Neighbor, 5> near;
        const auto found = map.nearest((pose * point).cast<float>(), near, kMaxNeighbor);
        if (found < near.size()) return;
        const auto shape = fit(map::columns_of(near));
        if (!shape) return;
        const auto residual = residual_of(point, *shape, pose);
        if (residual) residual->add_to(sum);
      });
}

}  // namespace

PoseEquations match_features(const map::Features& features, const map::FeatureMap& map,
                             const Pose& map_from_lidar, const Parallel& parallel) {
  PoseEquations sum = sum_of(features.edges, map.edges.tree(), map_from_lidar, parallel,
                             estimation::fit_line, estimation::edge_residual);
  sum += sum_of(features.surfaces, map.surfaces.tree(), map_from_lidar, parallel, plane_through,
                estimation::surface_residual);
  return sum;
}

}  // namespace lidarena::odometry::lio_sam
