// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "lidarena/base/random.hpp"

namespace lidarena::estimation {

/// A vector of three normal draws with the standard deviation `sigma`.
inline Eigen::Vector3d random_vector(SequentialRandom& random, double sigma) {
  const double x = random.normal();
  const double y = random.normal();
  return sigma * Eigen::Vector3d(x, y, random.normal());
}

}  // namespace lidarena::estimation
