// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/status.hpp"

#include <algorithm>
#include <chrono>
#include <map>

#include "lidarena/dataset/json_file.hpp"
#include "lidarena/study/claim.hpp"
#include "lidarena/study/stages.hpp"
#include "lidarena/study/workplace.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

std::vector<Worker> workers_of(const fs::path& study) {
  using Seconds = std::chrono::duration<double>;
  const double now = Seconds(std::chrono::system_clock::now().time_since_epoch()).count();
  std::vector<Worker> workers;
  for (const ClaimSeen& claim : all_claims(study / "claims")) {
    const ClaimOwner& owner = claim.owner;
    workers.push_back({.host = owner.host,
                       .process = owner.process,
                       .job = owner.job,
                       .dataset = claim.unit,
                       .doing = told_by(study, owner.token),
                       .since_s = std::max(0.0, now - owner.since),
                       .silent_s = claim.silent_s,
                       .dead = claim.dead});
  }
  std::ranges::sort(workers, {}, &Worker::dataset);
  return workers;
}

FailedCell failure_of(const Stage& stage) {
  FailedCell failed{stage.cell->name, "", (stage.folder / "lidarena.log").string()};
  if (!fs::exists(failed.log)) failed.log.clear();
  try {
    failed.reason = dataset::read_json(stage.folder / "manifest.json").value("failed", "");
  } catch (const Error&) {
    failed.reason = "its manifest.json cannot be read";
  }
  return failed;
}

/// Seconds of work, expected when it was planned and measured.
struct Work {
  double left = 0.0;  ///< expected, of cells without a state
  double done = 0.0;  ///< expected, of cells with one
  double took = 0.0;  ///< measured, of the same
};

/// Counts a cell that has a state.
void count_result(const Stage& stage, const StageResult& result, StudyStatus& status, Work& work) {
  work.done += stage.weight;
  work.took += result.seconds;
  if (result.state == StageState::kFailed) {
    ++status.failed;
    status.failures.push_back(failure_of(stage));
  } else {
    ++status.done;
    status.diverged += result.state == StageState::kDiverged ? 1 : 0;
  }
}

}  // namespace

StudyStatus read_status(const fs::path& study) {
  const StudyPlan plan = read_plan(study);
  const Stages stages(plan, study);
  StudyStatus status;
  status.title = plan.spec.title;
  status.workers = workers_of(study);
  std::map<std::string, std::size_t> workers;  // alive, by unit
  for (const Worker& worker : status.workers) workers[worker.dataset] += worker.dead ? 0 : 1;
  Work work;
  for (const PlanUnit& unit : plan.units) {
    for (const std::size_t cell : unit.cells) {
      const Stage stage = stages.run(unit, cell);
      const StageResult result = stage.result();
      ++status.cells;
      if (result.state == StageState::kMissing) {
        ++(workers[unit.dataset] > 0 ? status.running : status.missing);
        work.left += stage.weight;
      } else {
        count_result(stage, result, status, work);
      }
    }
  }
  const auto alive = std::ranges::count(status.workers, false, &Worker::dead);
  if (work.done > 0.0 && alive > 0)
    status.seconds_left = work.left * work.took / work.done / static_cast<double>(alive);
  return status;
}

}  // namespace lidarena::study
