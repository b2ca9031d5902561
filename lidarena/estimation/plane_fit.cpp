// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/plane_fit.hpp"

#include <Eigen/Dense>

namespace lidarena::estimation {
namespace {

/// In single precision, as the published programs solve it.
Plane unit_offset_plane(const FivePoints& points) {
  const Eigen::Matrix<float, 5, 3> rows = points.transpose().cast<float>();
  const Eigen::Vector3f a =
      rows.colPivHouseholderQr().solve(Eigen::Matrix<float, 5, 1>::Constant(-1.0F));
  const double length = a.cast<double>().norm();
  return {a.cast<double>() / length, 1.0 / length};
}

}  // namespace

PrincipalAxes principal_axes(const FivePoints& points) {
  const Eigen::Vector3d center = points.rowwise().mean();
  const FivePoints centered = points.colwise() - center;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(centered * centered.transpose());
  return {center, solver.eigenvalues(), solver.eigenvectors()};
}

std::optional<Plane> fit_plane(const FivePoints& points, PlaneFit method, double max_distance,
                               double min_aspect) {
  Plane plane;
  if (method == PlaneFit::kUnitOffset) {
    plane = unit_offset_plane(points);
  } else {
    const PrincipalAxes principal = principal_axes(points);
    const bool is_line = principal.spread[1] < min_aspect * principal.spread[2];
    if (min_aspect > 0.0 && is_line) return std::nullopt;
    plane.normal = principal.axes.col(0);
    plane.offset = -plane.normal.dot(principal.center);
  }
  const auto distances = (plane.normal.transpose() * points).array() + plane.offset;
  // Not "greater than": a fit that failed is not finite.
  if (!(distances.abs().maxCoeff() <= max_distance)) return std::nullopt;
  return plane;
}

}  // namespace lidarena::estimation
