// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "lidarena/base/config.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena::scenes {

/// A closed maze of winding tunnels, arranged as a ladder: each loop is one cell between two rungs.
struct CaveConfig {
  int loops = 4;
  double cell_length_m = 26;
  double cell_width_m = 22;
  double winding_m = 2;
  double relief_m = 2;
  double width_min_m = 2;
  double width_max_m = 4;
  double roughness_2m_m = 0.35;
  double roughness_03m_m = 0.1;
  double roughness_005m_m = 0.02;
  double voxel_size_m = 0.125;

  /// Former names, for the message that names the new one.
  static constexpr RenamedKey renamed_keys[] = {{"resolution_m", "voxel_size_m"}};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("loops", self.loops, "", "number of loops in a row; neighboring loops share a tunnel",
      between(1, 12));
    v("cell_length_m", self.cell_length_m, "m", "distance between cross tunnels, before winding",
      between(8, 100));
    v("cell_width_m", self.cell_width_m, "m", "length of a cross tunnel, before winding",
      between(8, 100));
    v("winding_m", self.winding_m, "m", "maximum sideways deviation of a tunnel from straight",
      between(0, 2.5));
    v("relief_m", self.relief_m, "m", "maximum height of a junction above or below the mean height",
      between(0, 4));
    v("width_min_m", self.width_min_m, "m", "width of the narrowest places", between(1.6, 6));
    v("width_max_m", self.width_max_m, "m", "width of the widest tunnels (junctions are wider)",
      between(1.6, 6));
    v("roughness_2m_m", self.roughness_2m_m, "m",
      "amplitude of the surface noise with a lattice step of 2 m", between(0, 0.5));
    v("roughness_03m_m", self.roughness_03m_m, "m",
      "amplitude of the surface noise with a lattice step of 0.3 m", between(0, 0.15));
    v("roughness_005m_m", self.roughness_005m_m, "m",
      "amplitude of the surface noise with a lattice step of 0.05 m", between(0, 0.03));
    v("voxel_size_m", self.voxel_size_m, "m",
      "edge of a grid cell; triangles are about this large (finer roughness is exact at the "
      "vertices only)",
      between(0.02, 0.3));
  }
};

/// Returns the cave's rock surface (one closed 2-manifold, normals into free space) and one closed
/// route along the centerlines of all tunnels; its first and last points are equal. The same
/// (config, seed) give bit-identical results. Throws InputError when `width_min_m` and
/// `width_max_m` differ by too little for the roughness, or are in the wrong order.
world::WorldModel make_cave(const CaveConfig& config, std::uint64_t seed);

}  // namespace lidarena::scenes
