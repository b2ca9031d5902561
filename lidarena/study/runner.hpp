// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "lidarena/base/log.hpp"
#include "lidarena/study/plan.hpp"
#include "lidarena/study/study.hpp"

namespace lidarena::study {

/// What one worker did.
struct WorkDone {
  std::size_t flights = 0;      ///< finished
  std::size_t runs = 0;         ///< cells that have a state by its work
  bool is_interrupted = false;  ///< ended by StudyOptions::stop, with work left
};

/// Takes units of the plan that nobody has, one after the other, and does what is missing in them,
/// until none is left. Throws Error if a disk is full, InputError if a configuration file differs
/// from the one that was planned.
WorkDone work_on(const StudyPlan& plan, const stages::ConfigFolder& configs,
                 const std::filesystem::path& study, const StudyOptions& options, LogSink& log);

}  // namespace lidarena::study
