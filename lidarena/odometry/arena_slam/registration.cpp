// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_slam/registration.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::arena_slam {
namespace {

using Eigen::Vector3d;

constexpr double kMinPlaneRatio = 0.05;   // minimum spread of a plane's narrow side / wide side
constexpr float kMaxNeighbor = 1.0F;      // m, maximum distance of the fifth neighbor
constexpr double kMinLineRatio = 3.0;     // minimum spread along a line / across it
constexpr double kMinWeight = 0.1;        // minimum weight of a match
constexpr std::size_t kMinMatches = 50;   // fewer do not determine a pose
constexpr double kMinEigenvalue = 100.0;  // of J^T J, LIO-SAM's value
constexpr double kMinShare = 0.003;       // minimum share of a direction; isotropic: 1/6

PointResidual residual_along(const Vector3d& direction, double distance, const Vector3d& arm,
                             double weight) {
  PointResidual residual{weight * distance, {}};
  residual.row << arm.cross(direction).transpose(), direction.transpose();
  residual.row *= weight;
  return residual;
}

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
    matches[i] = found == kNeighbors ? fit(near) : std::nullopt;
  });
}

template <class Shape, class Residual>
PoseEquations sum_of(const std::vector<Eigen::Vector3f>& points, const Matches<Shape>& matches,
                     const Pose& pose, const Parallel& parallel, Residual&& residual_of) {
  return estimation::accumulate_normal_equations<6>(
      parallel, points.size(), [&](std::size_t i, PoseEquations& sum) {
        if (!matches[i]) return;
        const auto residual = residual_of(points[i].cast<double>(), *matches[i], pose);
        if (residual) sum.add<1>(residual->row, Eigen::Matrix<double, 1, 1>(residual->distance), 1);
      });
}

/// Lines and planes of all points, kept until the next search.
class Matcher {
 public:
  Matcher(const Features& features, const FeatureMap& map, const Config& config,
          const Parallel& parallel)
      : features_(features),
        map_(map),
        config_(config),
        parallel_(parallel),
        lines_(features.edges.size()),
        planes_(features.surfaces.size()) {}

  PoseEquations equations(const Pose& pose, bool search_again) {
    if (search_again) {
      search(features_.edges, map_.edges, pose, parallel_, fit_line, lines_);
      search(
          features_.surfaces, map_.surfaces, pose, parallel_,
          [&](const Neighbors& near) {
            return estimation::fit_plane(map::columns_of(near), config_.plane_fit,
                                         config_.max_plane_thickness_m, kMinPlaneRatio);
          },
          planes_);
    }
    PoseEquations sum = sum_of(features_.edges, lines_, pose, parallel_, edge_residual);
    sum += sum_of(features_.surfaces, planes_, pose, parallel_, surface_residual);
    return sum;
  }

 private:
  const Features& features_;
  const FeatureMap& map_;
  const Config& config_;
  const Parallel& parallel_;
  Matches<Line> lines_;
  Matches<estimation::Plane> planes_;
};

/// Root mean square of the points' ranges.
double lever_of(const std::vector<Eigen::Vector3f>& points) {
  double sum = 0.0;
  for (const Eigen::Vector3f& p : points) sum += static_cast<double>(p.squaredNorm());
  return points.empty() ? 1.0 : std::sqrt(sum / static_cast<double>(points.size()));
}

}  // namespace

std::optional<Line> fit_line(const Neighbors& points) {
  const estimation::PrincipalAxes principal = estimation::principal_axes(map::columns_of(points));
  if (!(principal.spread[2] > kMinLineRatio * principal.spread[1])) return std::nullopt;
  return Line{principal.center, principal.axes.col(2)};
}

std::optional<PointResidual> edge_residual(const Vector3d& point, const Line& line,
                                           const Pose& map_from_lidar) {
  const Vector3d arm = map_from_lidar.linear() * point;
  const Vector3d from_center = arm + map_from_lidar.translation() - line.center;
  const Vector3d away = from_center - line.direction.dot(from_center) * line.direction;
  const double distance = away.norm();
  const double weight = 1.0 - 0.9 * distance;
  if (weight <= kMinWeight || distance == 0.0) return std::nullopt;
  return residual_along(away / distance, distance, arm, weight);
}

std::optional<PointResidual> surface_residual(const Vector3d& point, const estimation::Plane& plane,
                                              const Pose& map_from_lidar) {
  const Vector3d arm = map_from_lidar.linear() * point;
  const double distance = plane.normal.dot(arm + map_from_lidar.translation()) + plane.offset;
  const double weight = 1.0 - 0.9 * std::abs(distance) / std::sqrt(point.norm());
  if (!(weight > kMinWeight)) return std::nullopt;
  return residual_along(plane.normal, distance, arm, weight);
}

Degenerate find_degenerate(const PoseEquations& equations, double lever, Degeneracy rule) {
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  Vector6 unit = Vector6::Ones();  // scale of each error that makes them comparable
  double threshold = kMinEigenvalue;
  if (rule == Degeneracy::kShare) {
    unit.head<3>().setConstant(1.0 / lever);
    threshold = kMinShare * static_cast<double>(equations.count);
  }
  const Matrix6 scaled = unit.asDiagonal() * equations.hessian * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(scaled);
  Degenerate result;
  Matrix6 kept = Matrix6::Zero();
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (solver.eigenvalues()[i] < threshold) {
      ++result.directions;
    } else {
      kept += solver.eigenvectors().col(i) * solver.eigenvectors().col(i).transpose();
    }
  }
  if (result.directions > 0)
    result.observed = unit.asDiagonal() * kept * unit.cwiseInverse().asDiagonal();
  return result;
}

Registration register_features(const Features& features, const FeatureMap& map, const Pose& guess,
                               const Config& config, const Parallel& parallel) {
  Registration result;
  result.map_from_lidar = guess;
  Matcher matcher(features, map, config, parallel);
  Degenerate degenerate;
  const double lever = lever_of(features.surfaces);
  double step_size = 1.0;
  while (result.iterations < config.max_iterations && !result.converged) {
    const PoseEquations points =
        matcher.equations(result.map_from_lidar, step_size > config.reassociation_distance_m);
    if (points.count < kMinMatches) break;
    if (result.iterations == 0) degenerate = find_degenerate(points, lever, config.degeneracy);
    const Eigen::Matrix<double, 6, 1> step = degenerate.observed * points.solve();
    result.map_from_lidar.linear() = so3::exp(step.head<3>()) * result.map_from_lidar.linear();
    result.map_from_lidar.translation() += step.tail<3>();
    result.points = points;
    result.degenerate_directions = degenerate.directions;
    step_size = step.tail<3>().norm() + lever * step.head<3>().norm();
    result.converged = step.head<3>().norm() < config.convergence_rotation_rad &&
                       step.tail<3>().norm() < config.convergence_translation_m;
    ++result.iterations;
  }
  result.map_from_lidar = orthonormalized(result.map_from_lidar);
  return result;
}

}  // namespace lidarena::odometry::arena_slam
