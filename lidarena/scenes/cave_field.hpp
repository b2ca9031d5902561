// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "lidarena/scenes/cave.hpp"
#include "lidarena/scenes/cave_graph.hpp"
#include "lidarena/scenes/gradient_noise.hpp"
#include "lidarena/scenes/sparse_field.hpp"

namespace lidarena::scenes {

/// Approximate signed distance to the rock surface (m; positive in rock, negative in free space):
/// the distance to the tunnels, blended smoothly where they meet, plus noise of three scales.
class CaveField {
 public:
  CaveField(const CaveGraph& graph, const CaveConfig& config, std::uint64_t seed);

  /// Field value (m) at p; valid within about 1 m of the surface, +1 m where no tunnel is near.
  double operator()(const Eigen::Vector3d& p) const;
  /// Samples the field wherever the surface may pass, on a grid of the configured resolution.
  SparseField sample() const;

 private:
  /// A piece of a tunnel: the volume swept by a ball that moves from a to b while its radius
  /// changes linearly.
  struct Segment {
    Eigen::Vector3d a, b;
    double radius_a, radius_b;
    std::size_t tunnel;
  };
  using Near = std::vector<std::uint32_t>;  ///< indices of segments, grouped by tunnel

  double noise_bound() const;
  double segment_distance(const Segment& segment, const Eigen::Vector3d& p) const;
  double tunnel_distance(const Near& near, const Eigen::Vector3d& p) const;
  double noise(const Eigen::Vector3d& p) const;
  void index_segments();
  bool may_hold_surface(const Eigen::Vector3i& block, const Near& near) const;
  Eigen::Vector3d block_center(const Eigen::Vector3i& block) const;

  CaveConfig config_;
  double block_m_;  ///< edge of a block
  std::vector<Segment> segments_;
  GradientNoise large_, medium_, small_;
  std::vector<Eigen::Vector3i> blocks_;  ///< near a tunnel, in order of discovery
  std::unordered_map<std::uint64_t, Near> near_;
};

/// Moves the vertices of a surface net onto the field's zero surface by two Newton steps along the
/// gradient, each at most half a grid step. The vertices then also show the roughness that is finer
/// than the grid.
void project_onto_surface(world::TriangleMesh& mesh,
                          const std::function<double(const Eigen::Vector3d&)>& field, double step);

}  // namespace lidarena::scenes
