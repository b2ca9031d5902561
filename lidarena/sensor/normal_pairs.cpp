// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/normal_pairs.hpp"

#include <numbers>

namespace lidarena::sensor {
namespace {

/// Uniform bits as a number in (0, 1], 1 minus that of CounterRandom::uniform(). The smallest
/// value is that of a normal number of 6.7 sigma.
float positive_unit(std::uint32_t bits) {
  return (static_cast<float>(static_cast<std::int32_t>(~bits >> 1U)) + 0.5F) * 0x1.0p-31F;
}

/// In [0, 2 pi), rad.
float full_circle(std::uint32_t bits) {
  constexpr float kStep = 2.0F * std::numbers::pi_v<float> * 0x1.0p-31F;
  return static_cast<float>(static_cast<std::int32_t>(bits >> 1U)) * kStep;
}

}  // namespace

void NormalPairs::draw(const CounterRandom& random, std::uint64_t first, std::size_t count,
                       std::uint32_t draw) {
  // The arrays end with unused values up to a whole number of SIMD registers, since the last values
  // would be computed, and rounded, differently from the others.
  constexpr std::size_t kLanes = 16;
  const auto padded = static_cast<Eigen::Index>((count + kLanes - 1) / kLanes * kLanes);
  if (radius_.size() != padded) {
    radius_.setOnes(padded);
    angle_.setZero(padded);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const auto bits = random.bits(first + i, draw);
    radius_[static_cast<Eigen::Index>(i)] = positive_unit(bits[0]);
    angle_[static_cast<Eigen::Index>(i)] = full_circle(bits[2]);
  }
  radius_ = (-2.0F * radius_.log()).sqrt();  // Box and Muller
  first_ = radius_ * angle_.cos();
  second_ = radius_ * angle_.sin();
}

}  // namespace lidarena::sensor
