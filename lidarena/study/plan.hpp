// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/stages/config_folder.hpp"
#include "lidarena/study/program.hpp"
#include "lidarena/study/study_spec.hpp"

namespace lidarena::study {

/// A dataset with its cells: the part of a study that one worker does at a time.
struct PlanUnit {
  std::string dataset;
  std::vector<std::size_t> cells;  ///< indices into StudyPlan::cells
  double seconds = 0.0;            ///< expected, of all its cells on two cores
  std::uint64_t data_bytes = 0;    ///< expected size of its measurements
  int shard = 1;                   ///< 1 to StudyPlan::shards
  Json flight;                     ///< all that the dataset depends on, see Tasks

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("dataset", self.dataset, "", "");
    v("cells", self.cells, "", "");
    v("seconds", self.seconds, "s", "");
    v("data_bytes", self.data_bytes, "", "");
    v("shard", self.shard, "", "");
    v("flight", self.flight, "", "");
  }
};

/// What a study does, written once into its folder as plan.json. Workers on any machine, the status
/// and the report read it there.
struct StudyPlan {
  StudySpec spec;
  Json code;        ///< of the program that planned, see ProgramCode
  int shards = 1;   ///< parts for --shard K/N
  int attempt = 1;  ///< a cell that failed in an earlier attempt is run again
  std::vector<PlannedRun> cells;
  std::vector<double> seconds;  ///< expected, of each cell on two cores
  std::vector<PlanUnit> units;  ///< longest first, so that no long one begins last
  std::vector<results::ReferenceFigure> reference;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("spec", self.spec, "", "");
    v("code", self.code, "", "");
    v("shards", self.shards, "", "");
    v("attempt", self.attempt, "", "");
    v("runs", self.cells, "", "");
    v("seconds", self.seconds, "s", "");
    v("units", self.units, "", "");
    v("reference", self.reference, "", "");
  }
};

/// Plans a study; paths in the specification become absolute. Throws InputError as
/// planned_cells() does.
StudyPlan make_plan(StudySpec spec, const stages::ConfigFolder& configs, const ProgramCode& code,
                    int shards = 1);

/// The sensors that fly in the unit's dataset: those of the study that have a cell in it.
std::vector<std::string> sensors_of(const StudyPlan& plan, const PlanUnit& unit);

/// All that the unit's dataset depends on, from the configuration files as they are here.
Json flight_key(const StudyPlan& plan, const PlanUnit& unit, const stages::ConfigFolder& configs);

/// Indices of the units of a shard; of all units if `shard.of` is 1.
std::vector<std::size_t> units_of(const StudyPlan& plan, const Shard& shard);

/// Throws InputError if plan.json is missing or damaged.
StudyPlan read_plan(const std::filesystem::path& study);
void write_plan(const std::filesystem::path& study, const StudyPlan& plan);

}  // namespace lidarena::study
