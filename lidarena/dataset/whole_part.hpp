// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <utility>

#include "lidarena/base/error.hpp"
#include "lidarena/base/log.hpp"
#include "lidarena/dataset/damaged_file.hpp"
#include "lidarena/dataset/dataset.hpp"

namespace lidarena::dataset {

/// The events of a recording up to where it is damaged or cut off: instead of an error, they end,
/// and the report says where. Callers must look at it.
class WholePart final : public EventSource {
 public:
  WholePart(std::unique_ptr<EventSource> events, std::shared_ptr<ReadReport> report)
      : events_(std::move(events)), report_(std::move(report)) {}

  std::optional<Event> next() override {
    if (!report_->ended().empty()) return std::nullopt;
    try {
      return events_->next();
    } catch (const DamagedFile& error) {
      report_->end(error.what());
      return std::nullopt;
    }
  }

 private:
  std::unique_ptr<EventSource> events_;
  std::shared_ptr<ReadReport> report_;
};

/// Makes the events of `dataset` end where its file is damaged.
inline void read_whole_part(Dataset& dataset) {
  dataset.events = std::make_unique<WholePart>(std::move(dataset.events), dataset.report);
}

/// Says what was assumed and what looks wrong when the dataset was opened.
inline void tell_opening(const Dataset& dataset, LogSink& log) {
  for (const std::string& note : dataset.notes) log.info("note: " + note);
  for (const std::string& warning : dataset.warnings) log.warn(warning);
}

/// Says what was left out while its events were read. True if all of the file was read.
inline bool tell_reading(const Dataset& dataset, LogSink& log) {
  for (const std::string& line : dataset.report->lines()) log.warn(line);
  if (dataset.report->ended().empty()) return true;
  log.warn(dataset.report->ended());
  return false;
}

}  // namespace lidarena::dataset
