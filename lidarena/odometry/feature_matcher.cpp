// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/feature_matcher.hpp"

#include <array>

namespace lidarena::odometry {
namespace {

using estimation::PoseEquations;
using Points = std::vector<Eigen::Vector3f>;

constexpr float kMaxNeighbor = 1.0F;  // m, maximum distance of the fifth neighbor
constexpr std::size_t kGrain = 256;   // points per task of a search

template <class Shape, class Fit>
void find_shapes(const Points& points, const map::KdTree& map, const Pose& pose,
                 const Parallel& parallel, Fit&& fit, std::vector<std::optional<Shape>>& shapes) {
  parallel.for_each(points.size(), kGrain, [&](std::size_t i) {
    std::array<map::Neighbor, 5> near;
    const auto found =
        map.nearest((pose * points[i].cast<double>()).cast<float>(), near, kMaxNeighbor);
    shapes[i] = found == near.size() ? fit(map::columns_of(near)) : std::nullopt;
  });
}

template <class Shape, class Residual>
PoseEquations sum_of(const Points& points, const std::vector<std::optional<Shape>>& shapes,
                     const Pose& pose, const Parallel& parallel, Residual&& residual_of) {
  return estimation::accumulate_normal_equations<6>(
      parallel, points.size(), [&](std::size_t i, PoseEquations& sum) {
        if (!shapes[i]) return;
        const auto residual = residual_of(points[i].cast<double>(), *shapes[i], pose);
        if (residual) residual->add_to(sum);
      });
}

}  // namespace

FeatureMatcher::FeatureMatcher(const map::Features& features, const map::FeatureMap& map,
                               const PlaneRule& planes, const Parallel& parallel)
    : features_(features),
      map_(map),
      plane_rule_(planes),
      parallel_(parallel),
      lines_(features.edges.size()),
      planes_(features.surfaces.size()) {}

PoseEquations FeatureMatcher::equations(const Pose& map_from_lidar, bool search) {
  const auto fit_plane = [this](const estimation::FivePoints& near) {
    return estimation::fit_plane(near, plane_rule_.fit, plane_rule_.max_thickness_m,
                                 plane_rule_.min_aspect);
  };
  if (search) {
    find_shapes(features_.edges, map_.edges.tree(), map_from_lidar, parallel_, estimation::fit_line,
                lines_);
    find_shapes(features_.surfaces, map_.surfaces.tree(), map_from_lidar, parallel_, fit_plane,
                planes_);
  }
  PoseEquations sum =
      sum_of(features_.edges, lines_, map_from_lidar, parallel_, estimation::edge_residual);
  sum +=
      sum_of(features_.surfaces, planes_, map_from_lidar, parallel_, estimation::surface_residual);
  return sum;
}

}  // namespace lidarena::odometry
