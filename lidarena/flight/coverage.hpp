// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/flight/flight.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {

/// A point of a surface; each stands for the same area.
struct SurfaceSample {
  Eigen::Vector3d point;
  std::uint32_t triangle;
};

/// `count` points spread evenly over the mesh's area, one drawn from each of as many equal shares.
std::vector<SurfaceSample> sample_surface(const TriangleMesh& mesh, std::size_t count);

/// Of each sample, 1 when it is seen.
using Seen = std::vector<std::uint8_t>;

/// What a sensor at `place` sees that looks in all directions up to `range_m`: a sample is seen
/// when nothing lies on the straight way to it (up to 2 mm before it).
Seen seen_from(const World& world, const Eigen::Vector3d& place,
               std::span<const SurfaceSample> samples, double range_m);
/// The same from each of many places, each row a Seen.
std::vector<Seen> seen_from_each(const World& world, std::span<const Eigen::Vector3d> places,
                                 std::span<const SurfaceSample> samples, double range_m,
                                 const Parallel& parallel);
/// What is seen along a flight, from places at most `spacing_m` apart.
Seen seen_along(const World& world, const Flight& flight, std::span<const SurfaceSample> samples,
                double range_m, double spacing_m);

/// Adds what `other` sees to `seen`.
void add_seen(Seen& seen, const Seen& other);
std::size_t count_seen(const Seen& seen);

/// Rows of `views` that together see at least `share` of what all see together, each chosen because
/// it adds the most to those before it (greedy set cover; of equals the first).
std::vector<std::size_t> choose_views(std::span<const Seen> views, double share);

}  // namespace lidarena
