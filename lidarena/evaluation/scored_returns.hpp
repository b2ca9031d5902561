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

/// Every how many points of a scan of `points` are taken so that at most `most` are: 1, or an odd
/// number, so that no row of a spinning sensor's columns (of a power of two) is passed over.
inline std::size_t scoring_stride(std::size_t points, std::size_t most = kScoredReturns) {
  const std::size_t stride = (points + most - 1) / most;
  return stride <= 1 ? 1 : stride | 1U;
}

/// Leaves the returns that are scored, in their order. The same of a scan and of its truth.
template <class P>
void keep_scored(std::vector<P>& points) {
  const std::size_t stride = scoring_stride(points.size());
  if (stride == 1) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); i += stride) points[kept++] = points[i];
  points.resize(kept);
}

/// The events of `source` with the scored returns alone.
class ScoredEvents : public EventSource {
 public:
  explicit ScoredEvents(std::unique_ptr<EventSource> source) : source_(std::move(source)) {}
  std::optional<Event> next() override;

 private:
  std::unique_ptr<EventSource> source_;
};

/// What these hit.
class ScoredTruth : public ScanTruthSource {
 public:
  explicit ScoredTruth(std::unique_ptr<ScanTruthSource> source) : source_(std::move(source)) {}
  std::optional<ScanTruth> next() override;

 private:
  std::unique_ptr<ScanTruthSource> source_;
};

}  // namespace lidarena
