// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "lidarena/scenes/gradient_noise.hpp"
#include "lidarena/scenes/mine_plan.hpp"
#include "lidarena/scenes/sparse_field.hpp"

namespace lidarena::scenes {

/// Approximate signed distance to the rock of a mine (m; positive in rock, negative in free space):
/// the distance to rounded boxes, blended where they meet, plus noise of two scales, which is
/// weaker near the floor.
class MineField {
 public:
  MineField(const MinePlan& plan, const MineConfig& config, std::uint64_t seed);

  /// Field value (m) at p; valid within about 1 m of the surface, +1 m where no drift is near.
  double operator()(const Eigen::Vector3d& p) const;
  /// Samples the field wherever the surface may pass, on a grid of the configured resolution.
  SparseField sample() const;

 private:
  using Near = std::vector<std::uint32_t>;  ///< indices of drifts
  struct Space {
    double distance;     ///< m, without noise
    double above_floor;  ///< m, height in the nearest drift
  };

  double noise_bound() const;
  Space space_at(const Near& near, const Eigen::Vector3d& p) const;
  double noise(const Eigen::Vector3d& p, double above_floor) const;
  void index_drifts();
  Eigen::Vector3d block_center(const Eigen::Vector3i& block) const;

  MineConfig config_;
  double block_m_;  ///< edge of a block
  std::vector<Drift> drifts_;
  GradientNoise large_, small_;
  std::vector<Eigen::Vector3i> blocks_;  ///< near a drift, in order of discovery
  std::unordered_map<std::uint64_t, Near> near_;
};

}  // namespace lidarena::scenes
