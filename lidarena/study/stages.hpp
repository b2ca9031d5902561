// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lidarena/study/config_folder.hpp"
#include "lidarena/study/program.hpp"
#include "lidarena/study/study_spec.hpp"

namespace lidarena::study {

/// One call of the program.
struct Step {
  std::string name;                                     ///< flight, run or score
  Json key;                                             ///< all that its result depends on
  std::filesystem::path product;                        ///< the last file that it writes
  std::function<std::vector<std::string>()> arguments;  ///< called once the steps before are done
};

/// What is done in one folder of the study: a flight, or running and scoring a cell. The folder's
/// request.json holds the keys of the steps that are done.
struct Stage {
  std::string name;
  const PlannedRun* cell = nullptr;  ///< null for a flight
  std::string dataset;
  std::filesystem::path folder;
  std::vector<Step> steps;
  double weight = 0.0;  ///< expected seconds

  /// Index of the first step that is not done; the number of steps if all are.
  std::size_t first_open_step() const;
  bool is_complete() const { return first_open_step() == steps.size(); }
  /// Records that the step is done.
  void record(std::size_t step) const;
};

/// The stages of a study in the folder `out`.
class Stages {
 public:
  Stages(const StudySpec& spec, const ConfigFolder& configs, std::filesystem::path out,
         ProgramCode code)
      : spec_(spec), configs_(configs), out_(std::move(out)), code_(std::move(code)) {}

  Stage flight(const PlannedRun& cell) const;
  /// `cell` must outlive the stage.
  Stage run(const PlannedRun& cell) const;

 private:
  Json flight_key(const PlannedRun& cell) const;
  Step run_step(const PlannedRun& cell, const std::filesystem::path& folder) const;

  const StudySpec& spec_;
  const ConfigFolder& configs_;
  std::filesystem::path out_;
  ProgramCode code_;
};

}  // namespace lidarena::study
