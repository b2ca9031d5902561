// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "lidarena/scenes/cave.hpp"
#include "lidarena/scenes/forest.hpp"
#include "lidarena/scenes/hall.hpp"
#include "lidarena/scenes/house.hpp"
#include "lidarena/scenes/mine.hpp"
#include "lidarena/scenes/office.hpp"

namespace lidarena::scenes {

/// The house with sizes, heights, doors and furniture drawn from `seed`: from low, bare rooms,
/// symmetric in a quarter of the cases, to high, crowded ones.
HouseConfig drawn_house(HouseConfig config, std::uint64_t seed);

/// The cave with its number of loops, lengths, widths, relief and roughness drawn from `seed`.
CaveConfig drawn_cave(CaveConfig config, std::uint64_t seed);

/// The mine with its size, widths, heights, branches and roughness drawn from `seed`.
MineConfig drawn_mine(MineConfig config, std::uint64_t seed);

/// The forest with its density, kinds of trees, undergrowth and ground drawn from `seed`.
ForestConfig drawn_forest(ForestConfig config, std::uint64_t seed);

/// The hall with its size, aisles, shelves and filling drawn from `seed`.
HallConfig drawn_hall(HallConfig config, std::uint64_t seed);

/// The office with its number of rooms, their sizes and the share of open doors drawn from `seed`.
OfficeConfig drawn_office(OfficeConfig config, std::uint64_t seed);

/// A closed route (the last point equals the first, m) that begins at a point of `route` and goes
/// in a direction drawn from `seed`. An open route is only turned around or not.
std::vector<Eigen::Vector3d> drawn_route(std::vector<Eigen::Vector3d> route, std::uint64_t seed);

}  // namespace lidarena::scenes
