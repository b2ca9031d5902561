// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/known_rows.hpp"

#include <map>

#include "lidarena/dataset/json_file.hpp"
#include "lidarena/results/known_row.hpp"
#include "lidarena/study/tasks.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

/// manifest.json last, so that a folder with it is whole.
void write_run(const Task& task, const results::KnownRow& row) {
  fs::create_directories(task.folder);
  dataset::write_json(task.folder / results::kKnownRow, to_json(row));
  dataset::RunManifest manifest;
  manifest.algorithm = task.cell->algorithm;
  manifest.preset = task.cell->preset;
  manifest.sensor = row.sensor;
  manifest.own_map = row.own_map;
  manifest.reason = row.reason;
  const bool diverged = row.status == "diverged";
  if (diverged) manifest.status = dataset::RunStatus::kDiverged;
  dataset::write_run_manifest(task.folder, manifest);
  task.record(task.steps.size() - 1, 0.0, diverged);
}

}  // namespace

KnownRows take_known_rows(const StudyPlan& plan, const fs::path& out, const fs::path& csv) {
  std::map<std::string, results::KnownRow> rows;
  for (results::KnownRow& row : results::read_known_rows(csv)) rows[row.name] = std::move(row);
  const Tasks tasks(plan, out);
  KnownRows known;
  for (const PlanUnit& unit : plan.units) {
    for (const std::size_t cell : unit.cells) {
      const auto row = rows.find(plan.cells[cell].name);
      if (row == rows.end()) continue;
      const Task task = tasks.run(unit, cell);
      if (row->second.key != task.key()) {
        ++known.other;
      } else if (task.result().state == TaskState::kMissing) {
        write_run(task, row->second);
        ++known.taken;
      }
    }
  }
  return known;
}

}  // namespace lidarena::study
