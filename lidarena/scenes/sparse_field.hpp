// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace lidarena::scenes {

/// Samples of a scalar field (negative in free space, positive in rock) on the grid
/// step * (i, j, k), stored in blocks of 8^3 samples and only near the surface.
class SparseField {
 public:
  static constexpr int kBlock = 8;
  using Values = std::array<float, kBlock * kBlock * kBlock>;
  struct Block {
    Eigen::Vector3i coordinates;  ///< grid coordinates of the first sample divided by kBlock
    Values values;                ///< x runs fastest
  };

  explicit SparseField(double step) : step_(step) {}

  double step() const { return step_; }
  Eigen::Vector3d position(const Eigen::Vector3i& sample) const {
    return step_ * sample.cast<double>();
  }
  /// The blocks in the order in which they were added.
  const std::vector<Block>& blocks() const { return blocks_; }
  /// Adds a block and returns its values for the caller to fill.
  Values& add_block(const Eigen::Vector3i& coordinates);
  /// The stored sample, or null where there is no block.
  const float* find(const Eigen::Vector3i& sample) const;
  float* find(const Eigen::Vector3i& sample);

  /// Index of a sample within its block.
  static std::size_t index_in_block(const Eigen::Vector3i& sample);
  /// A key for hash tables; distinct for |coordinates| < 2^20.
  static std::uint64_t key(const Eigen::Vector3i& coordinates);

 private:
  double step_;
  std::vector<Block> blocks_;
  std::unordered_map<std::uint64_t, std::size_t> index_;
};

}  // namespace lidarena::scenes
