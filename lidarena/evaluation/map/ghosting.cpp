// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/ghosting.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "lidarena/evaluation/map/parallel_sort.hpp"
#include "lidarena/map/voxel_key.hpp"

namespace lidarena::evaluation {
namespace {

struct Entry {
  map::VoxelKey cube;
  std::uint32_t axis;  ///< of the normal's largest component
  float height;
  bool same_patch(const Entry& other) const { return cube == other.cube && axis == other.axis; }
  /// Equal entries are interchangeable, so the sorted list does not depend on how it is sorted.
  bool operator<(const Entry& other) const {
    if (cube != other.cube) return cube < other.cube;
    if (axis != other.axis) return axis < other.axis;
    return height < other.height;
  }
};

std::vector<Entry> entries_of(std::span<const PointScore> scores, const world::TriangleMesh& mesh) {
  constexpr auto kCubesPerMeter = static_cast<float>(1.0 / Ghosting::kPatch_m);
  std::vector<Entry> entries;
  entries.reserve(scores.size());
  for (const PointScore& score : scores) {
    if (score.distance > Ghosting::kReach_m) continue;
    const Eigen::Vector3d normal = mesh.cross(score.triangle);
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    const map::VoxelKey cube = map::voxel_key(map::voxel_of(score.foot_offset, kCubesPerMeter));
    entries.push_back({cube, static_cast<std::uint32_t>(axis),
                       normal[axis] > 0.0 ? score.height : -score.height});
  }
  return entries;
}

double quantile_of_sorted(std::span<const float> values, double p) {
  const double rank = p * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  const double low = values[below];
  return low + (rank - static_cast<double>(below)) * (double{values[above]} - low);
}

struct Moments {
  double count = 0.0, sum = 0.0, squares = 0.0;
  void add(double value) {
    count += 1.0;
    sum += value;
    squares += value * value;
  }
  Moments operator-(const Moments& part) const {
    return {count - part.count, sum - part.sum, squares - part.squares};
  }
  double mean() const { return sum / count; }
  double variance() const { return std::max(0.0, squares / count - mean() * mean()); }
};

Moments moments(std::span<const float> values) {
  Moments all;
  for (const float value : values) all.add(value);
  return all;
}

/// Number of points in the middle third between the parts' means.
double points_near_middle(std::span<const float> values, const Sheets& sheets) {
  const auto near = std::count_if(values.begin(), values.end(), [&](double h) {
    return std::abs(h - sheets.middle_m) < sheets.separation_m / 6.0;
  });
  return static_cast<double>(near);
}

}  // namespace

Sheets split_sheets(std::span<const float> sorted_heights) {
  const Moments all = moments(sorted_heights);
  Sheets best;
  double best_between = -1.0;
  Moments low;
  for (std::size_t k = 1; k < sorted_heights.size(); ++k) {
    low.add(sorted_heights[k - 1]);
    const Moments high = all - low;
    const double mean_difference = high.mean() - low.mean();
    const double between = low.count * high.count * mean_difference * mean_difference;
    if (between <= best_between) continue;
    best_between = between;
    best.separation_m = mean_difference;
    best.middle_m = 0.5 * (high.mean() + low.mean());
    best.smaller_share = std::min(low.count, high.count) / all.count;
    const double spread = std::sqrt(0.5 * (low.variance() + high.variance()));
    best.ashman_d =
        spread > 0.0 ? mean_difference / spread : std::numeric_limits<double>::infinity();
  }
  const double smaller = best.smaller_share * all.count;
  best.are_two = best.separation_m > Ghosting::kMinMeanDistance_m &&
                 best.ashman_d > Ghosting::kMinAshmanD &&
                 best.smaller_share >= Ghosting::kMinShare && smaller >= Ghosting::kMinInPart &&
                 points_near_middle(sorted_heights, best) < Ghosting::kValley * smaller;
  return best;
}

Ghosting ghosting(std::span<const PointScore> scores, const world::World& world,
                  const Parallel& parallel) {
  std::vector<Entry> entries = entries_of(scores, world.mesh());
  parallel_sort(std::span(entries), parallel);
  Ghosting result;
  std::vector<double> thickness, separation;
  std::vector<float> heights;
  for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
    heights.clear();
    for (; end < entries.size() && entries[end].same_patch(entries[begin]); ++end) {
      heights.push_back(entries[end].height);
    }
    if (heights.size() < Ghosting::kMinPoints) continue;
    thickness.push_back(quantile_of_sorted(heights, 0.95) - quantile_of_sorted(heights, 0.05));
    const Sheets sheets = split_sheets(heights);
    if (sheets.are_two) separation.push_back(sheets.separation_m);
  }
  result.patches = thickness.size();
  result.thickness_m = results::summarize(thickness);
  result.double_patches = separation.size();
  if (result.patches == 0) return result;
  result.double_percent =
      100.0 * static_cast<double>(separation.size()) / static_cast<double>(result.patches);
  if (!separation.empty()) result.median_separation_m = results::quantile(separation, 0.5);
  return result;
}

}  // namespace lidarena::evaluation
