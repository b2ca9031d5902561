// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/scored_returns.hpp"

#include <variant>

namespace lidarena::evaluation {

std::optional<dataset::Event> ScoredEvents::next() {
  std::optional<dataset::Event> event = source_->next();
  if (event) {
    if (auto* scan = std::get_if<Scan>(&event->data)) keep_scored(scan->points, max_count_);
  }
  return event;
}

std::optional<dataset::ScanTruth> ScoredTruth::next() {
  std::optional<dataset::ScanTruth> truth = source_->next();
  if (truth) keep_scored(truth->points, max_count_);
  return truth;
}

}  // namespace lidarena::evaluation
