// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "lidarena/dataset/event.hpp"
#include "lidarena/dataset/point_truth.hpp"

namespace lidarena {

/// Of each scan, scoring looks at no more returns than this: all of a Mid-360's, every 15th of an
/// OS0-128's 262,144. What more of them would tell is which sensor has more.
inline constexpr std::size_t kScoredReturns = 20'000;
/// And of a whole recording at about so many: what more of them would tell is how long it took.
inline constexpr std::size_t kScoredInAll = 10'000'000;

/// How many returns of a scan are looked at, at most, where there are `scans` (0: not known).
inline std::size_t scored_returns(std::size_t scans) {
  return scans == 0 ? kScoredReturns
                    : std::clamp<std::size_t>(kScoredInAll / scans, 1, kScoredReturns);
}

/// Every how many points of a scan of `points` are taken so that at most `most` are: 1, or an odd
/// number, so that no row of a spinning sensor's columns (of a power of two) is passed over.
inline std::size_t scoring_stride(std::size_t points, std::size_t most) {
  const std::size_t stride = (points + most - 1) / most;
  return stride <= 1 ? 1 : stride | 1U;
}

/// Leaves the returns that are scored, in their order. The same of a scan and of its truth.
template <class P>
void keep_scored(std::vector<P>& points, std::size_t most) {
  const std::size_t stride = scoring_stride(points.size(), most);
  if (stride == 1) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); i += stride) points[kept++] = points[i];
  points.resize(kept);
}

/// The events of `source` with the scored returns alone, at most `most` of a scan.
class ScoredEvents : public EventSource {
 public:
  ScoredEvents(std::unique_ptr<EventSource> source, std::size_t most)
      : source_(std::move(source)), most_(most) {}
  std::optional<Event> next() override;

 private:
  std::unique_ptr<EventSource> source_;
  std::size_t most_;
};

/// What these hit.
class ScoredTruth : public ScanTruthSource {
 public:
  ScoredTruth(std::unique_ptr<ScanTruthSource> source, std::size_t most)
      : source_(std::move(source)), most_(most) {}
  std::optional<ScanTruth> next() override;

 private:
  std::unique_ptr<ScanTruthSource> source_;
  std::size_t most_;
};

}  // namespace lidarena
