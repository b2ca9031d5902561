// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lidarena/stages/config_folder.hpp"
#include "lidarena/study/plan.hpp"

namespace lidarena::study {

/// One call of the program.
struct Step {
  std::string name;                                     ///< flight, run or score
  Json key;                                             ///< all that its result depends on
  std::filesystem::path product;                        ///< the last file that it writes
  std::function<std::vector<std::string>()> arguments;  ///< called once the steps before are done
};

enum class TaskState { kMissing, kOk, kDiverged, kFailed };

/// What a folder's request.json says.
struct TaskResult {
  TaskState state = TaskState::kMissing;
  double seconds = 0.0;  ///< that its steps took
  int attempt = 0;       ///< of the plan, in which it failed
};

/// What is done in one folder of the study: a flight, or running and scoring a cell. The folder's
/// request.json holds the keys of the steps that are done, and the result.
struct Task {
  std::string name;
  const PlannedRun* cell = nullptr;  ///< null for a flight
  std::filesystem::path folder;
  std::vector<Step> steps;
  double weight = 0.0;  ///< expected seconds

  /// Index of the first step that is not done; the number of steps if all are.
  std::size_t first_open_step() const;
  TaskResult result() const;
  /// Digest of the keys of all steps: the same for the same code, settings and seed.
  std::string key() const;
  /// Records that the step is done; after the last one, the result.
  void record(std::size_t step, double seconds, bool diverged = false) const;
  void record_failure(double seconds, int attempt) const;
};

/// The tasks of a plan in the folder `root`, which is laid out as the study's own folder.
class Tasks {
 public:
  /// `plan` must outlive this and the tasks.
  Tasks(const StudyPlan& plan, std::filesystem::path root)
      : plan_(plan), root_(std::move(root)), code_(plan.code) {}

  Task flight(const PlanUnit& unit, const stages::ConfigFolder& configs) const;
  /// `cell`: index in the plan.
  Task run(const PlanUnit& unit, std::size_t cell) const;

 private:
  Step run_step(const PlanUnit& unit, const PlannedRun& cell,
                const std::filesystem::path& folder) const;

  const StudyPlan& plan_;
  std::filesystem::path root_;
  ProgramCode code_;
};

}  // namespace lidarena::study
