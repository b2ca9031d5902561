// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/scored_returns.hpp"

#include <variant>

namespace lidarena {

std::optional<Event> ScoredEvents::next() {
  std::optional<Event> event = source_->next();
  if (event) {
    if (auto* scan = std::get_if<Scan>(&event->data)) keep_scored(scan->points, most_);
  }
  return event;
}

std::optional<ScanTruth> ScoredTruth::next() {
  std::optional<ScanTruth> truth = source_->next();
  if (truth) keep_scored(truth->points, most_);
  return truth;
}

}  // namespace lidarena
