// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/normal_pairs.hpp"

#include <numbers>

namespace lidarena::sensor {
namespace {

/// The uniform number of CounterRandom: 53 bits.
std::int64_t fraction(std::uint32_t high, std::uint32_t low) {
  return static_cast<std::int64_t>(((static_cast<std::uint64_t>(high) << 32U) | low) >> 11U);
}

/// 1 minus the uniform number, in (0, 1].
float complement(std::int64_t fraction) {
  return static_cast<float>((std::int64_t{1} << 53U) - fraction) * 0x1.0p-53F;
}

/// In [0, 2 pi], rad.
float full_circle(std::int64_t fraction) {
  return static_cast<float>(fraction) * (2.0F * std::numbers::pi_v<float> * 0x1.0p-53F);
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
    radius_[static_cast<Eigen::Index>(i)] = complement(fraction(bits[0], bits[1]));
    angle_[static_cast<Eigen::Index>(i)] = full_circle(fraction(bits[2], bits[3]));
  }
  radius_ = (-2.0F * radius_.log()).sqrt();  // Box and Muller
  first_ = radius_ * angle_.cos();
  second_ = radius_ * angle_.sin();
}

}  // namespace lidarena::sensor
