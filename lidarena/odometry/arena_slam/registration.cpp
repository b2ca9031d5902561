// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_slam/registration.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace lidarena::odometry::arena_slam {
namespace {

using estimation::PoseEquations;

using Neighbors = std::array<map::Neighbor, 5>;

constexpr double kConvergedRotation = 2e-4;     // rad: converged below this step
constexpr double kConvergedTranslation = 2e-4;  // m: likewise
constexpr double kReassociation = 0.01;         // m: after a smaller step matches are kept
constexpr double kMinPlaneRatio = 0.05;  // minimum spread of a plane's narrow side / wide side
constexpr float kMaxNeighbor = 1.0F;     // m, maximum distance of the fifth neighbor
constexpr std::size_t kMinMatches = 50;  // fewer do not determine a pose
constexpr double kMinShare = 0.003;      // minimum share of a direction; isotropic: 1/6

/// Lines or planes matched with the points of one kind.
template <class Shape>
using Matches = std::vector<std::optional<Shape>>;

template <class Shape, class Fit>
void search(const std::vector<Eigen::Vector3f>& points, const map::KdTree& map, const Pose& pose,
            const Parallel& parallel, Fit&& fit, Matches<Shape>& matches) {
  constexpr std::size_t kGrain = 256;
  parallel.for_each(points.size(), kGrain, [&](std::size_t i) {
    Neighbors near;
    const auto found =
        map.nearest((pose * points[i].cast<double>()).cast<float>(), near, kMaxNeighbor);
    matches[i] = found == near.size() ? fit(map::columns_of(near)) : std::nullopt;
  });
}

template <class Shape, class Residual>
PoseEquations sum_of(const std::vector<Eigen::Vector3f>& points, const Matches<Shape>& matches,
                     const Pose& pose, const Parallel& parallel, Residual&& residual_of) {
  return estimation::accumulate_normal_equations<6>(
      parallel, points.size(), [&](std::size_t i, PoseEquations& sum) {
        if (!matches[i]) return;
        const auto residual = residual_of(points[i].cast<double>(), *matches[i], pose);
        if (residual) residual->add_to(sum);
      });
}

/// Lines and planes of all points, kept until the next search.
class Matcher {
 public:
  Matcher(const Features& features, const FeatureMap& map, double max_plane_thickness,
          const Parallel& parallel)
      : features_(features),
        map_(map),
        max_plane_thickness_(max_plane_thickness),
        parallel_(parallel),
        lines_(features.edges.size()),
        planes_(features.surfaces.size()) {}

  PoseEquations equations(const Pose& pose, bool search_again) {
    if (search_again) {
      search(features_.edges, map_.edges.tree(), pose, parallel_, estimation::fit_line, lines_);
      search(
          features_.surfaces, map_.surfaces.tree(), pose, parallel_,
          [&](const estimation::FivePoints& near) {
            return estimation::fit_plane(near, estimation::PlaneFit::kPrincipal,
                                         max_plane_thickness_, kMinPlaneRatio);
          },
          planes_);
    }
    PoseEquations sum = sum_of(features_.edges, lines_, pose, parallel_, estimation::edge_residual);
    sum += sum_of(features_.surfaces, planes_, pose, parallel_, estimation::surface_residual);
    return sum;
  }

 private:
  const Features& features_;
  const FeatureMap& map_;
  double max_plane_thickness_;  // m
  const Parallel& parallel_;
  Matches<estimation::Line> lines_;
  Matches<estimation::Plane> planes_;
};

/// Root mean square of the points' ranges.
double lever_of(const std::vector<Eigen::Vector3f>& points) {
  double sum = 0.0;
  for (const Eigen::Vector3f& p : points) sum += static_cast<double>(p.squaredNorm());
  return points.empty() ? 1.0 : std::sqrt(sum / static_cast<double>(points.size()));
}

}  // namespace

estimation::Degenerate find_degenerate(const PoseEquations& points, double lever) {
  PoseEquations::Vector unit = PoseEquations::Vector::Ones();
  unit.head<3>().setConstant(1.0 / lever);
  return estimation::find_degenerate(points.hessian, unit,
                                     kMinShare * static_cast<double>(points.count));
}

Registration register_features(const Features& features, const FeatureMap& map, const Pose& guess,
                               const RegistrationLimits& limits, const Parallel& parallel) {
  Registration result;
  result.map_from_lidar = guess;
  Matcher matcher(features, map, limits.max_plane_thickness_m, parallel);
  estimation::Degenerate degenerate;
  const double lever = lever_of(features.surfaces);
  double step_size = 1.0;
  while (result.iterations < limits.max_iterations && !result.converged) {
    const PoseEquations points =
        matcher.equations(result.map_from_lidar, step_size > kReassociation);
    if (points.count < kMinMatches) break;
    if (result.iterations == 0) degenerate = find_degenerate(points, lever);
    const PoseEquations::Vector step = degenerate.observed * points.solve();
    result.map_from_lidar = estimation::moved(result.map_from_lidar, step);
    result.points = points;
    result.degenerate_directions = degenerate.directions;
    step_size = step.tail<3>().norm() + lever * step.head<3>().norm();
    result.converged =
        step.head<3>().norm() < kConvergedRotation && step.tail<3>().norm() < kConvergedTranslation;
    ++result.iterations;
  }
  result.map_from_lidar = orthonormalized(result.map_from_lidar);
  return result;
}

}  // namespace lidarena::odometry::arena_slam
