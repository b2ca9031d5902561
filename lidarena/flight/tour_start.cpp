// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/tour_start.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;

constexpr int kPointsAcross =
    16;                        // number of grid points along the longest edge of the bounding box
constexpr int kMinPoints = 4;  // minimum number of grid points along any edge
constexpr std::size_t kDirections = 64;

/// Directions distributed evenly over the sphere (golden-angle spiral).
std::vector<Eigen::Vector3f> directions() {
  std::vector<Eigen::Vector3f> all;
  for (std::size_t k = 0; k < kDirections; ++k) {
    const double z = 1.0 - (2.0 * static_cast<double>(k) + 1.0) / kDirections;
    const double angle = static_cast<double>(k) * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double r = std::sqrt(1.0 - z * z);
    all.push_back(Vector3d(r * std::cos(angle), r * std::sin(angle), z).cast<float>());
  }
  return all;
}

std::vector<Vector3d> grid(const Eigen::AlignedBox3d& box) {
  const Vector3d size = box.sizes();
  const double step = size.maxCoeff() / kPointsAcross;
  Eigen::Vector3i count;
  for (int i = 0; i < 3; ++i)
    count[i] = std::max(kMinPoints, static_cast<int>(std::ceil(size[i] / step)));
  std::vector<Vector3d> places;
  for (int z = 0; z < count.z(); ++z) {
    for (int y = 0; y < count.y(); ++y) {
      for (int x = 0; x < count.x(); ++x) {
        const Vector3d share = (Vector3d(x, y, z).array() + 0.5) / count.cast<double>().array();
        places.emplace_back(box.min() + share.cwiseProduct(size));
      }
    }
  }
  return places;
}

struct Score {
  int enclosed = -1;  ///< number of directions that end at a surface; negative: unsuitable place
  double room = 0.0;
  bool operator<(const Score& other) const {
    return enclosed != other.enclosed ? enclosed < other.enclosed : room < other.room;
  }
};

Score score_of(const world::World& world, const Vector3d& place, double clearance) {
  constexpr double kRoom = 1.0;  // m
  const double nearest = world.closest_point(place, clearance + kRoom).distance;
  if (nearest < clearance) return {};
  static const std::vector<Eigen::Vector3f> kSphere = directions();
  std::vector<world::Ray> rays{{place, -Eigen::Vector3f::UnitZ()}};
  for (const Eigen::Vector3f& direction : kSphere) rays.push_back({place, direction});
  std::vector<world::Hit> hits(rays.size());
  world.cast(rays, world.mesh().bounds().diagonal().norm(), hits);
  if (!hits.front().valid()) return {};
  const auto enclosed = std::count_if(hits.begin() + 1, hits.end(),
                                      [](const world::Hit& hit) { return hit.valid(); });
  return {static_cast<int>(enclosed), std::min(nearest, kRoom)};
}

}  // namespace

std::optional<Vector3d> most_enclosed_place(const world::World& world, double clearance,
                                            const Parallel& parallel) {
  const std::vector<Vector3d> places = grid(world.mesh().bounds());
  std::vector<Score> scores(places.size());
  parallel.for_each(places.size(), 16,
                    [&](std::size_t i) { scores[i] = score_of(world, places[i], clearance); });
  const auto best = std::max_element(scores.begin(), scores.end());
  if (best == scores.end() || best->enclosed < 0) return std::nullopt;
  return places[static_cast<std::size_t>(best - scores.begin())];
}

}  // namespace lidarena::flight
