// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/firing_order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>

namespace lidarena::dataset {
namespace {

constexpr int kBucketBits = 12;  // a sweep of 0.1 s: 32 us, less than a column of a spinning LiDAR
constexpr std::size_t kBuckets = std::size_t{1} << kBucketBits;

/// Sorts a bucket, whose points mostly have one time or are in order.
void sort_bucket(std::span<Point> points) {
  if (!std::ranges::is_sorted(points, {}, &Point::dt_ns))
    std::ranges::stable_sort(points, {}, &Point::dt_ns);
}

}  // namespace

void sort_in_firing_order(std::vector<Point>& points) {
  if (std::ranges::is_sorted(points, {}, &Point::dt_ns)) return;
  static thread_local std::vector<Point> unsorted;  // kept, because new memory costs more
  const auto [first, last] = std::ranges::minmax(points, {}, &Point::dt_ns);
  const auto since_first = [from = std::int64_t{first.dt_ns}](const Point& point) {
    return static_cast<std::uint32_t>(point.dt_ns - from);
  };
  const int shift = std::max(0, static_cast<int>(std::bit_width(since_first(last))) - kBucketBits);
  std::array<std::uint32_t, kBuckets> end{};  // size of a bucket, then its next place
  for (const Point& point : points) ++end[since_first(point) >> shift];
  std::uint32_t begin = 0;
  for (std::uint32_t& place : end) begin += std::exchange(place, begin);
  unsorted.swap(points);
  points.resize(unsorted.size());
  for (const Point& point : unsorted) points[end[since_first(point) >> shift]++] = point;
  begin = 0;
  for (const std::uint32_t next : end) {
    sort_bucket(std::span(points).subspan(begin, next - begin));
    begin = next;
  }
}

}  // namespace lidarena::dataset
