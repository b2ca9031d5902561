// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "lidarena/base/config.hpp"
#include "lidarena/world/world_model.hpp"

namespace lidarena::scenes {

/// A forest on rough ground, under an open sky: trunks, branches and crowns of single leaves,
/// bushes, boulders and fallen logs. There is hardly a plane in it.
struct ForestConfig {
  double size_m = 60;
  double trees_per_ha = 600;
  double conifers = 0.5;
  double undergrowth = 1;
  double relief_m = 2;
  double roughness_2m_m = 0.2;
  double roughness_04m_m = 0.06;
  double ground_step_m = 0.25;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("size_m", self.size_m, "m", "edge of the square of ground", between(30, 200));
    v("trees_per_ha", self.trees_per_ha, "1/ha",
      "trees per hectare, but for the clearing of the route", between(0, 1500));
    v("conifers", self.conifers, "", "share of the trees that are conical", between(0, 1));
    v("undergrowth", self.undergrowth, "", "factor on the number of bushes, boulders and logs",
      between(0, 3));
    v("relief_m", self.relief_m, "m", "amplitude of the ground with a lattice step of 20 m",
      between(0, 6));
    v("roughness_2m_m", self.roughness_2m_m, "m",
      "amplitude of the ground with a lattice step of 2 m", between(0, 0.5));
    v("roughness_04m_m", self.roughness_04m_m, "m",
      "amplitude of the ground with a lattice step of 0.4 m", between(0, 0.15));
    v("ground_step_m", self.ground_step_m, "m", "distance of the ground's vertices",
      between(0.1, 1));
  }
};

/// Returns the forest on [-size / 2, size / 2]^2 and one closed route, which winds between the
/// trees about 2 m above the ground, and keeps 0.9 m from everything. The same (config, seed) give
/// bit-identical results.
world::WorldModel make_forest(const ForestConfig& config, std::uint64_t seed);

}  // namespace lidarena::scenes
