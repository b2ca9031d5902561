// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

namespace lidarena {

/// Philox4x32-10 of Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3"
/// (SC 2011): 128 random bits that depend on nothing but `counter` and `key`.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                    std::array<std::uint32_t, 2> key);

/// Counter-based random numbers: a value depends only on (seed, stream, index, draw), so threads
/// can compute them in any order. `stream` separates sensors and purposes; `index` is e.g. the
/// number of the ray.
class CounterRandom {
 public:
  explicit CounterRandom(std::uint64_t seed, std::uint32_t stream = 0);

  /// Uniform in [0, 1).
  double uniform(std::uint64_t index, std::uint32_t draw = 0) const;
  /// Two independent standard normals (Box-Muller).
  std::array<double, 2> normals(std::uint64_t index, std::uint32_t draw = 0) const;
  /// 128 raw bits.
  std::array<std::uint32_t, 4> bits(std::uint64_t index, std::uint32_t draw = 0) const;

 private:
  std::array<std::uint32_t, 2> key_;
};

/// The same numbers one after the other, for sequential code (world generators, the samples of one
/// IMU).
class SequentialRandom {
 public:
  explicit SequentialRandom(std::uint64_t seed, std::uint32_t stream = 0) : random_(seed, stream) {}

  double uniform() { return random_.uniform(next_++); }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double normal() { return random_.normals(next_++)[0]; }
  /// Uniform integer in [low, high].
  int integer(int low, int high) { return low + static_cast<int>(uniform() * (high - low + 1)); }

 private:
  CounterRandom random_;
  std::uint64_t next_ = 0;
};

/// A stream number from a name: equal names give equal streams (FNV-1a, 32 bit).
constexpr std::uint32_t stream_of(const char* name) {
  std::uint32_t hash = 2166136261U;
  for (; *name != '\0'; ++name) hash = (hash ^ static_cast<unsigned char>(*name)) * 16777619U;
  return hash;
}

}  // namespace lidarena
