// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace lidarena::evaluation {

/// Maximum number of returns of a scan that are scored: all 20,000 of a Mid-360's unless the
/// recording is long, every 7th of an OS0-128's 131,072. With more, the score would depend on the
/// number of points that the sensor measures.
inline constexpr std::size_t kScoredReturns = 20'000;
/// Approximate maximum for a whole recording: from 50 s at 10 Hz on fewer of each scan. With more,
/// the score would depend on its duration.
inline constexpr std::size_t kScoredInAll = 10'000'000;

/// Maximum number of scored returns of a scan in a recording of `scans` scans (0: not known).
inline std::size_t scored_returns(std::size_t scans) {
  return scans == 0 ? kScoredReturns
                    : std::clamp<std::size_t>(kScoredInAll / scans, 1, kScoredReturns);
}

/// The stride k of scoring every k-th point of a scan of `points` points, so that no more than
/// `max_count` are scored: 1, or an odd number, so that no row of a spinning sensor is skipped (its
/// columns have a power of two of points).
inline std::size_t scoring_stride(std::size_t points, std::size_t max_count) {
  const std::size_t stride = (points + max_count - 1) / max_count;
  return stride <= 1 ? 1 : stride | 1U;
}

/// Removes the returns that are not scored and keeps the order. Keeps the same returns of a scan
/// and of its truth.
template <class P>
void keep_scored(std::vector<P>& points, std::size_t max_count) {
  const std::size_t stride = scoring_stride(points.size(), max_count);
  if (stride == 1) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); i += stride) points[kept++] = points[i];
  points.resize(kept);
}

}  // namespace lidarena::evaluation
