// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "lidarena/base/config.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena::scenes {

/// A mine: galleries with floors between junctions of a disturbed grid, dead ends and side
/// chambers, with roof supports, pipes and crates. Some galleries of the grid are missing.
struct MineConfig {
  int columns = 4;
  int rows = 3;
  double spacing_m = 20;
  double width_min_m = 2;
  double width_max_m = 4;
  double height_m = 2.8;
  double relief_m = 1;
  double branches = 0.7;
  double supports = 0.6;
  double roughness_1m_m = 0.12;
  double roughness_03m_m = 0.05;
  double voxel_size_m = 0.125;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("columns", self.columns, "", "junctions along x", between(2, 12));
    v("rows", self.rows, "", "junctions along y", between(2, 12));
    v("spacing_m", self.spacing_m, "m", "mean distance of neighboring junctions", between(18, 60));
    v("width_min_m", self.width_min_m, "m", "width of the narrowest galleries", between(2, 6));
    v("width_max_m", self.width_max_m, "m", "width of the widest galleries", between(2, 6));
    v("height_m", self.height_m, "m", "mean height of the galleries", between(2.6, 5));
    v("relief_m", self.relief_m, "m", "maximum height of a junction above or below the mean",
      between(0, 2));
    v("branches", self.branches, "",
      "share of the grid's cells into which a dead end or a side chamber leads", between(0, 1));
    v("supports", self.supports, "", "share of the galleries with supports and a pipe",
      between(0, 1));
    v("roughness_1m_m", self.roughness_1m_m, "m",
      "amplitude of the rock's noise with a lattice step of 1 m; the floor has a quarter of it",
      between(0, 0.25));
    v("roughness_03m_m", self.roughness_03m_m, "m", "the same with a lattice step of 0.3 m",
      between(0, 0.1));
    v("voxel_size_m", self.voxel_size_m, "m", "edge of a grid cell; triangles are about this large",
      between(0.05, 0.25));
  }
};

/// Returns the rock's surface (one closed 2-manifold, normals into free space) with the fittings
/// (closed meshes of their own), and one closed route through all galleries; it keeps 0.6 m from
/// everything. The same (config, seed) give bit-identical results. Throws InputError when
/// `width_min_m` and `width_max_m` differ by too little for the roughness.
world::WorldModel make_mine(const MineConfig& config, std::uint64_t seed);

}  // namespace lidarena::scenes
