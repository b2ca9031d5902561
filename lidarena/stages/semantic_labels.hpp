// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lidarena/world/mover_config.hpp"
#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::stages {

/// The class that SemanticKITTI (Behley et al., ICCV 2019) has for a kind of object of our worlds,
/// by the number in its label files: those of the table in docs/formats.md, 99 (other-object) for
/// any other kind, 0 (unlabeled) without one.
std::uint16_t semantic_class(const std::string& object);

/// That of a mover: a moving class, unless its path is a single point.
std::uint16_t semantic_class(const world::MoverConfig& mover);

/// A label for each value of PointTruth::triangle in a world with these movers: the class, and in
/// the upper 16 bits the instance. Movers count from 1; the world is instance 0.
std::vector<std::uint32_t> semantic_labels(const world::TriangleMesh& mesh,
                                           const std::vector<world::MoverConfig>& movers);

}  // namespace lidarena::stages
