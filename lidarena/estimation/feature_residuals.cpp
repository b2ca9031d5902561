// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/feature_residuals.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::estimation {
namespace {

using Eigen::Vector3d;

constexpr double kMinLineRatio = 3.0;  // minimum spread along a line / across it
constexpr double kMinWeight = 0.1;     // minimum weight of a match

FeatureResidual residual_along(const Vector3d& direction, double distance, const Vector3d& arm,
                               double weight) {
  FeatureResidual residual{weight * distance, {}};
  residual.row << arm.cross(direction).transpose(), direction.transpose();
  residual.row *= weight;
  return residual;
}

}  // namespace

Pose moved(const Pose& pose, const PoseEquations::Vector& step) {
  Pose result = pose;
  result.linear() = so3::exp(step.head<3>()) * pose.linear();
  result.translation() += step.tail<3>();
  return result;
}

std::optional<Line> fit_line(const FivePoints& points) {
  const Vector3d center = points.rowwise().mean();
  const FivePoints centered = points.colwise() - center;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread;
  spread.computeDirect(centered * centered.transpose());
  if (!(spread.eigenvalues()[2] > kMinLineRatio * spread.eigenvalues()[1])) return std::nullopt;
  return Line{center, spread.eigenvectors().col(2)};
}

void FeatureResidual::add_to(PoseEquations& sum) const {
  sum.add<1>(row, Eigen::Matrix<double, 1, 1>(distance), 1.0);
}

std::optional<FeatureResidual> edge_residual(const Vector3d& point, const Line& line,
                                             const Pose& map_from_lidar) {
  const Vector3d arm = map_from_lidar.linear() * point;
  const Vector3d from_center = arm + map_from_lidar.translation() - line.center;
  const Vector3d away = from_center - line.direction.dot(from_center) * line.direction;
  const double distance = away.norm();
  const double weight = 1.0 - 0.9 * distance;
  if (weight <= kMinWeight || distance == 0.0) return std::nullopt;
  return residual_along(away / distance, distance, arm, weight);
}

std::optional<FeatureResidual> surface_residual(const Vector3d& point, const Plane& plane,
                                                const Pose& map_from_lidar) {
  const Vector3d arm = map_from_lidar.linear() * point;
  const double distance = plane.normal.dot(arm + map_from_lidar.translation()) + plane.offset;
  const double weight = 1.0 - 0.9 * std::abs(distance) / std::sqrt(point.norm());
  if (!(weight > kMinWeight)) return std::nullopt;
  return residual_along(plane.normal, distance, arm, weight);
}

Degenerate find_degenerate(const PoseEquations::Matrix& hessian, double min_eigenvalue) {
  using Matrix6 = PoseEquations::Matrix;
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(hessian);
  Degenerate result;
  Matrix6 kept = Matrix6::Zero();
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (solver.eigenvalues()[i] < min_eigenvalue) {
      ++result.directions;
    } else {
      kept += solver.eigenvectors().col(i) * solver.eigenvectors().col(i).transpose();
    }
  }
  if (result.directions > 0) result.observed = kept;
  return result;
}

}  // namespace lidarena::estimation
