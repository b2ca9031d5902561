// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/slices.hpp"

#include <algorithm>
#include <cmath>

namespace lidarena::odometry::arena_lio {
namespace {

constexpr int kMaxSlices = 8;

/// The intervals between two instants, the outer ones cut.
std::vector<estimation::ImuInterval> between(const std::vector<estimation::ImuInterval>& intervals,
                                             Time begin, Time end) {
  std::vector<estimation::ImuInterval> part;
  for (estimation::ImuInterval interval : intervals) {
    interval.begin = std::max(interval.begin, begin);
    interval.end = std::min(interval.end, end);
    if (interval.begin < interval.end) part.push_back(interval);
  }
  return part;
}

}  // namespace

int slices_needed(const std::vector<estimation::ImuInterval>& intervals, double density,
                  double max_error) {
  if (intervals.empty()) return 1;
  const double seconds = to_seconds(intervals.back().end - intervals.front().begin);
  const double sigma = density * std::sqrt(seconds * seconds * seconds / 3.0);
  const double slices = std::pow(sigma / max_error, 2.0 / 3.0);
  return static_cast<int>(std::clamp(std::ceil(slices), 1.0, double{kMaxSlices}));
}

std::vector<Slice> sliced(const Scan& scan, Time end,
                          const std::vector<estimation::ImuInterval>& intervals, int count) {
  std::vector<Slice> slices(static_cast<std::size_t>(count));
  if (count == 1) {
    slices.front() = {scan, intervals};
    return slices;
  }
  for (Slice& slice : slices)
    slice.points = {.stamp = scan.stamp, .points = {}, .timed = true, .origins = scan.origins};
  const Time duration = end - scan.stamp;
  const auto begin_of = [&](int slice) {
    if (slice == 0) return Time::min();
    return slice == count ? Time::max() : scan.stamp + duration * slice / count;
  };
  for (int k = 0; k < count; ++k)
    slices[static_cast<std::size_t>(k)].intervals =
        between(intervals, begin_of(k), begin_of(k + 1));
  for (const Point& point : scan.points) {
    const std::int64_t k = (time_of(scan, point) - scan.stamp) * count / duration;
    slices[static_cast<std::size_t>(std::clamp<std::int64_t>(k, 0, count - 1))]
        .points.points.push_back(point);
  }
  return slices;
}

}  // namespace lidarena::odometry::arena_lio
