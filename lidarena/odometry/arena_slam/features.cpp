// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_slam/features.hpp"

#include <algorithm>
#include <cmath>

#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::odometry::arena_slam {
namespace {

constexpr int kAdjacent = 10;           // columns: points farther apart are not neighbors
constexpr float kOcclusionJump = 0.3F;  // m, range difference of neighbors that indicates occlusion
constexpr int kSectors = 6;             // per row
constexpr int kSuppressed = 5;          // points on each side of an edge that cannot be edges
constexpr std::size_t kRows = 8;        // per task

using Flags = std::vector<bool>;

void exclude(Flags& flags, int first, int count) {
  const int size = static_cast<int>(flags.size());
  for (int i = std::max(first, 0); i < std::min(first + count, size); ++i)
    flags[static_cast<std::size_t>(i)] = true;
}

/// Flags an edge's neighbors on one side, up to a gap between columns.
void suppress(std::span<const Pixel> row, Flags& flags, int at, int step) {
  const int size = static_cast<int>(row.size());
  for (int k = 1; k <= kSuppressed; ++k) {
    const int i = at + k * step;
    if (i < 0 || i >= size) return;
    const auto here = static_cast<std::size_t>(i);
    const auto before = static_cast<std::size_t>(i - step);
    if (std::abs(row[here].column - row[before].column) > kAdjacent) return;
    flags[here] = true;
  }
}

/// Indices in [begin, end) rough enough for edges, the roughest first.
std::vector<int> candidates(const std::vector<float>& rough, int begin, int end,
                            const Config& config) {
  std::vector<int> found;
  for (int i = begin; i < end; ++i) {
    if (double{rough[static_cast<std::size_t>(i)]} > config.edge_threshold_m2) found.push_back(i);
  }
  std::sort(found.begin(), found.end(), [&](int a, int b) {
    const float ra = rough[static_cast<std::size_t>(a)];
    const float rb = rough[static_cast<std::size_t>(b)];
    return ra != rb ? ra > rb : a < b;
  });
  return found;
}

Flags edges_of(std::span<const Pixel> row, const Config& config) {
  Flags excluded = non_edge_points(row, config);
  const std::vector<float> rough = roughness(row, config);
  Flags edges(row.size(), false);
  const int margin = config.smoothness_neighbors;
  const int usable = static_cast<int>(row.size()) - 2 * margin;
  for (int sector = 0; sector < kSectors && usable > 0; ++sector) {
    const int begin = margin + usable * sector / kSectors;
    const int end = margin + usable * (sector + 1) / kSectors;
    int count = 0;
    for (const int i : candidates(rough, begin, end, config)) {
      if (excluded[static_cast<std::size_t>(i)]) continue;
      if (count++ == config.edges_per_sector) break;
      edges[static_cast<std::size_t>(i)] = true;
      excluded[static_cast<std::size_t>(i)] = true;
      suppress(row, excluded, i, 1);
      suppress(row, excluded, i, -1);
    }
  }
  return edges;
}

}  // namespace

std::vector<bool> non_edge_points(std::span<const Pixel> row, const Config& config) {
  Flags excluded(row.size(), false);
  const int size = static_cast<int>(row.size());
  const auto range = [&](int i) { return row[static_cast<std::size_t>(i)].range; };
  const auto column = [&](int i) { return row[static_cast<std::size_t>(i)].column; };
  for (int i = 1; i + 1 < size; ++i) {
    if (column(i + 1) - column(i) < kAdjacent) {
      const float jump = range(i + 1) - range(i);
      if (jump < -kOcclusionJump)
        exclude(excluded, i + 1 - config.occluded_points, config.occluded_points);
      if (jump > kOcclusionJump) exclude(excluded, i + 1, config.occluded_points);
    }
    const auto grazing = static_cast<float>(config.grazing_share) * range(i);
    if (std::abs(range(i - 1) - range(i)) > grazing && std::abs(range(i + 1) - range(i)) > grazing)
      excluded[static_cast<std::size_t>(i)] = true;
  }
  return excluded;
}

std::vector<float> roughness(std::span<const Pixel> row, const Config& config) {
  std::vector<float> rough(row.size(), 0.0F);
  const auto w = static_cast<std::size_t>(config.smoothness_neighbors);
  for (std::size_t i = w; i + w < row.size(); ++i) {
    float sum = 0.0F;
    for (std::size_t k = 1; k <= w; ++k)
      sum += row[i - k].range + row[i + k].range - 2.0F * row[i].range;
    rough[i] = sum * sum;
  }
  return rough;
}

Features extract_features(const RangeImage& image, const Config& config, const Parallel& parallel) {
  return parallel.reduce(
      image.row_end.size(), kRows, Features{},
      [&](std::size_t begin, std::size_t end) {
        Features part;
        for (std::size_t r = begin; r < end; ++r) {
          const std::span<const Pixel> row = image.row(r);
          const Flags edges = edges_of(row, config);
          for (std::size_t i = 0; i < row.size(); ++i)
            (edges[i] ? part.edges : part.surfaces).push_back(row[i].position);
        }
        return part;
      },
      [](Features& all, const Features& part) {
        all.edges.insert(all.edges.end(), part.edges.begin(), part.edges.end());
        all.surfaces.insert(all.surfaces.end(), part.surfaces.begin(), part.surfaces.end());
      });
}

Features thinned(const Features& features, const Config& config) {
  return {map::voxel_means(features.edges, config.edge_voxel_size_m, config.grid_axes),
          map::voxel_means(features.surfaces, config.surface_voxel_size_m, config.grid_axes)};
}

}  // namespace lidarena::odometry::arena_slam
