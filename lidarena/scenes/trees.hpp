// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "lidarena/base/random.hpp"
#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::scenes {

/// Wood and leaves of plants, which are painted apart. m, world frame.
struct Plants {
  world::TriangleMesh wood, leaves;
};

/// A tree whose trunk stands at `foot`: a bent, knotty trunk of `radius` at breast height, branches
/// from 4 m above the ground on, and single leaves (or tufts of needles) around them.
void add_tree(const Eigen::Vector3d& foot, double radius, bool is_conifer, SequentialRandom& random,
              Plants& plants);

/// A clump of leaves on the ground, `radius` wide.
void add_bush(const Eigen::Vector3d& foot, double radius, SequentialRandom& random, Plants& plants);

/// A log that lies from `a` to `b` on the ground.
void add_log(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius, Plants& plants);

/// A knobby stone around `center`.
world::TriangleMesh boulder(const Eigen::Vector3d& center, double radius, std::uint64_t seed);

}  // namespace lidarena::scenes
