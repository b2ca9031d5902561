// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/edge_points.hpp"

#include <algorithm>
#include <cmath>

namespace lidarena::estimation {
namespace {

constexpr int kAdjacent = 10;           // columns: points farther apart are not neighbors
constexpr float kOcclusionJump = 0.3F;  // m, range difference of neighbors that indicates occlusion
constexpr int kSectors = 6;             // per row
constexpr int kSuppressed = 5;          // points on each side of an edge that cannot be edges

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
                            double threshold_m2) {
  std::vector<int> found;
  for (int i = begin; i < end; ++i) {
    if (double{rough[static_cast<std::size_t>(i)]} > threshold_m2) found.push_back(i);
  }
  std::sort(found.begin(), found.end(), [&](int a, int b) {
    const float ra = rough[static_cast<std::size_t>(a)];
    const float rb = rough[static_cast<std::size_t>(b)];
    return ra != rb ? ra > rb : a < b;
  });
  return found;
}

}  // namespace

std::vector<bool> non_edge_points(std::span<const Pixel> row, const EdgeRule& rule) {
  Flags excluded(row.size(), false);
  const int size = static_cast<int>(row.size());
  const auto range = [&](int i) { return row[static_cast<std::size_t>(i)].range; };
  const auto column = [&](int i) { return row[static_cast<std::size_t>(i)].column; };
  for (int i = 1; i + 1 < size; ++i) {
    if (column(i + 1) - column(i) < kAdjacent) {
      const float jump = range(i + 1) - range(i);
      if (jump < -kOcclusionJump)
        exclude(excluded, i + 1 - rule.occluded_points, rule.occluded_points);
      if (jump > kOcclusionJump) exclude(excluded, i + 1, rule.occluded_points);
    }
    const auto grazing = static_cast<float>(rule.grazing_share) * range(i);
    if (std::abs(range(i - 1) - range(i)) > grazing && std::abs(range(i + 1) - range(i)) > grazing)
      excluded[static_cast<std::size_t>(i)] = true;
  }
  return excluded;
}

std::vector<float> roughness(std::span<const Pixel> row, int neighbors) {
  std::vector<float> rough(row.size(), 0.0F);
  const auto w = static_cast<std::size_t>(neighbors);
  for (std::size_t i = w; i + w < row.size(); ++i) {
    float sum = 0.0F;
    for (std::size_t k = 1; k <= w; ++k)
      sum += row[i - k].range + row[i + k].range - 2.0F * row[i].range;
    rough[i] = sum * sum;
  }
  return rough;
}

std::vector<bool> find_edges(std::span<const Pixel> row, const EdgeRule& rule) {
  Flags excluded = non_edge_points(row, rule);
  const std::vector<float> rough = roughness(row, rule.neighbors);
  Flags edges(row.size(), false);
  const int margin = rule.neighbors;
  const int usable = static_cast<int>(row.size()) - 2 * margin;
  for (int sector = 0; sector < kSectors && usable > 0; ++sector) {
    const int begin = margin + usable * sector / kSectors;
    const int end = margin + usable * (sector + 1) / kSectors;
    int count = 0;
    for (const int i : candidates(rough, begin, end, rule.threshold_m2)) {
      if (excluded[static_cast<std::size_t>(i)]) continue;
      if (count++ == rule.per_sector) break;
      edges[static_cast<std::size_t>(i)] = true;
      excluded[static_cast<std::size_t>(i)] = true;
      suppress(row, excluded, i, 1);
      suppress(row, excluded, i, -1);
    }
  }
  return edges;
}

}  // namespace lidarena::estimation
