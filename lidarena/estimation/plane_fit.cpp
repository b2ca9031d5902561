// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/plane_fit.hpp"

#include <Eigen/QR>

namespace lidarena::estimation {

std::optional<Plane> fit_plane(const FivePoints& points, double max_distance) {
  const Eigen::Matrix<float, 5, 3> rows = points.transpose().cast<float>();
  const Eigen::Vector3f a =
      rows.colPivHouseholderQr().solve(Eigen::Matrix<float, 5, 1>::Constant(-1.0F));
  const double length = a.cast<double>().norm();
  const Plane plane{a.cast<double>() / length, 1.0 / length};
  const auto distances = (plane.normal.transpose() * points).array() + plane.offset;
  // Not "greater than": a fit that failed is not finite.
  if (!(distances.abs().maxCoeff() <= max_distance)) return std::nullopt;
  return plane;
}

}  // namespace lidarena::estimation
