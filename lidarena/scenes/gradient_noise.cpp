// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/gradient_noise.hpp"

#include <array>
#include <cmath>

namespace lidarena::scenes {
namespace {

/// The output function of SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number
/// generators", OOPSLA 2014): every input bit affects every output bit.
std::uint64_t mix(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15U;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31);
}

/// Dot product of `offset` and the gradient of the noise at lattice point `cell`. The gradient is
/// one of twelve vectors that point to the edges of a cube.
double slope(std::uint64_t seed, const Eigen::Vector3i& cell, const Eigen::Vector3d& offset) {
  // 21 bits per coordinate distinguish all lattice points of a world that is 2 million steps wide.
  constexpr std::uint64_t kMask = (1U << 21) - 1;
  const std::uint64_t key = (static_cast<std::uint64_t>(cell.x()) & kMask) |
                            ((static_cast<std::uint64_t>(cell.y()) & kMask) << 21) |
                            ((static_cast<std::uint64_t>(cell.z()) & kMask) << 42);
  const std::uint64_t hash = mix(mix(seed) ^ key);
  const auto without = static_cast<int>((hash >> 32) % 3);  // axis along which the gradient is 0
  const double a = offset[(without + 1) % 3];
  const double b = offset[(without + 2) % 3];
  return ((hash & 1) != 0 ? a : -a) + ((hash & 2) != 0 ? b : -b);
}

/// Blending function whose first and second derivatives are 0 at 0 and 1, so that the noise has a
/// continuous slope and curvature at the lattice points.
double fade(double t) { return t * t * t * (t * (6 * t - 15) + 10); }

}  // namespace

double GradientNoise::operator()(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d floor(std::floor(p.x()), std::floor(p.y()), std::floor(p.z()));
  const Eigen::Vector3i cell = floor.cast<int>();
  const Eigen::Vector3d t = p - floor;
  const std::array<double, 3> w{fade(t.x()), fade(t.y()), fade(t.z())};
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3i step(corner & 1, (corner >> 1) & 1, corner >> 2);
    double weight = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const double share = w[static_cast<std::size_t>(axis)];
      weight *= step[axis] == 1 ? share : 1 - share;
    }
    sum += weight * slope(seed_, cell + step, t - step.cast<double>());
  }
  return sum;
}

}  // namespace lidarena::scenes
