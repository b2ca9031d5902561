// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace lidarena::scenes {

/// Gradient noise on the integer lattice (Perlin, "Improving noise", SIGGRAPH 2002) with gradients
/// chosen by a hash of (seed, lattice point). Smooth, mean zero, |value| < 1.04, standard deviation
/// 0.27; nearly all of its variation has a scale between one half and two lattice steps.
class GradientNoise {
 public:
  explicit GradientNoise(std::uint64_t seed) : seed_(seed) {}

  double operator()(const Eigen::Vector3d& p) const;

 private:
  std::uint64_t seed_;
};

}  // namespace lidarena::scenes
