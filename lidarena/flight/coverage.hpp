// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/flight/flight.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::flight {

/// A point of a surface; all samples represent equal areas.
struct SurfaceSample {
  Eigen::Vector3d point;
  std::uint32_t triangle;
};

/// `count` points distributed evenly over the mesh's area: one random point in each of `count`
/// equal shares of the area (stratified sampling).
std::vector<SurfaceSample> sample_surface(const world::TriangleMesh& mesh, std::size_t count);

/// For each sample, 1 when it is seen, otherwise 0.
using Seen = std::vector<std::uint8_t>;

/// The samples that are visible from `place` in any direction up to `range_m`: a sample is visible
/// when no surface intersects the line of sight (up to 2 mm before the sample).
Seen seen_from(const world::World& world, const Eigen::Vector3d& place,
               std::span<const SurfaceSample> samples, double range_m);
/// seen_from() for each of many places.
std::vector<Seen> seen_from_each(const world::World& world, std::span<const Eigen::Vector3d> places,
                                 std::span<const SurfaceSample> samples, double range_m,
                                 const Parallel& parallel);
/// The samples that are seen along a flight, from positions about `spacing_m` apart.
Seen seen_along(const world::World& world, const Flight& flight,
                std::span<const SurfaceSample> samples, double range_m, double spacing_m);

/// Adds the samples that are seen in `other` to `seen`.
void add_seen(Seen& seen, const Seen& other);
std::size_t count_seen(const Seen& seen);

/// Indices of views that together see at least `share` of what all views see together. Each is
/// chosen because it adds the most samples to the previous ones (greedy set cover; of equals the
/// first).
std::vector<std::size_t> choose_views(std::span<const Seen> views, double share);

}  // namespace lidarena::flight
