// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/random.hpp"

#include <cmath>
#include <numbers>

namespace lidarena {
namespace {

// 53 random bits to [0, 1)
double unit_interval(std::uint32_t high, std::uint32_t low) {
  const std::uint64_t bits = (static_cast<std::uint64_t>(high) << 32U) | low;
  return static_cast<double>(bits >> 11U) * 0x1.0p-53;
}

}  // namespace

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> c,
                                    std::array<std::uint32_t, 2> k) {
  constexpr std::uint64_t kMultiplier0 = 0xD2511F53;
  constexpr std::uint64_t kMultiplier1 = 0xCD9E8D57;
  constexpr std::uint32_t kWeyl0 = 0x9E3779B9;  // golden ratio
  constexpr std::uint32_t kWeyl1 = 0xBB67AE85;  // sqrt(3) - 1
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = kMultiplier0 * c[0];
    const std::uint64_t p1 = kMultiplier1 * c[2];
    c = {static_cast<std::uint32_t>(p1 >> 32U) ^ c[1] ^ k[0], static_cast<std::uint32_t>(p1),
         static_cast<std::uint32_t>(p0 >> 32U) ^ c[3] ^ k[1], static_cast<std::uint32_t>(p0)};
    k = {k[0] + kWeyl0, k[1] + kWeyl1};
  }
  return c;
}

CounterRandom::CounterRandom(std::uint64_t seed, std::uint32_t stream) {
  // The stream is mixed into the key, so that (seed, stream) pairs do not overlap.
  const auto mixed =
      philox({stream, 0x4C494441, 0x52454E41, 0},
             {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U)});
  key_ = {mixed[0], mixed[1]};
}

std::array<std::uint32_t, 4> CounterRandom::bits(std::uint64_t index, std::uint32_t draw) const {
  return philox(
      {static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32U), draw, 0}, key_);
}

double CounterRandom::uniform(std::uint64_t index, std::uint32_t draw) const {
  const auto b = bits(index, draw);
  return unit_interval(b[0], b[1]);
}

std::array<double, 2> CounterRandom::normals(std::uint64_t index, std::uint32_t draw) const {
  const auto b = bits(index, draw);
  const double radius = std::sqrt(-2.0 * std::log1p(-unit_interval(b[0], b[1])));
  const double angle = 2.0 * std::numbers::pi * unit_interval(b[2], b[3]);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace lidarena
