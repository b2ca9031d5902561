// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/status.hpp"

#include <algorithm>
#include <chrono>
#include <map>

#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/run_manifest.hpp"
#include "lidarena/study/lease.hpp"
#include "lidarena/study/tasks.hpp"
#include "lidarena/study/workplace.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

std::vector<Worker> workers_of(const fs::path& study) {
  using Seconds = std::chrono::duration<double>;
  const double now = Seconds(std::chrono::system_clock::now().time_since_epoch()).count();
  std::vector<Worker> workers;
  for (const LeaseSeen& lease : all_leases(study / "leases")) {
    const LeaseOwner& owner = lease.owner;
    workers.push_back({.host = owner.host,
                       .process = owner.process,
                       .job = owner.job,
                       .dataset = lease.unit,
                       .doing = told_by(study, owner.token),
                       .since_s = std::max(0.0, now - owner.since),
                       .silent_s = lease.silent_s,
                       .dead = lease.dead});
  }
  std::ranges::sort(workers, {}, &Worker::dataset);
  return workers;
}

FailedCell failure_of(const Task& task) {
  FailedCell failed{task.cell->name, "", (task.folder / "lidarena.log").string()};
  if (!fs::exists(failed.log)) failed.log.clear();
  try {
    failed.reason = dataset::read_run_manifest(task.folder).reason;
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
void count_result(const Task& task, const TaskResult& result, StudyStatus& status, Work& work) {
  work.done += task.weight;
  work.took += result.seconds;
  if (result.state == TaskState::kFailed) {
    ++status.failed;
    status.failures.push_back(failure_of(task));
  } else {
    ++status.done;
    status.diverged += result.state == TaskState::kDiverged ? 1 : 0;
  }
}

}  // namespace

StudyStatus read_status(const fs::path& study) {
  const StudyPlan plan = read_plan(study);
  const Tasks tasks(plan, study);
  StudyStatus status;
  status.title = plan.spec.title;
  status.workers = workers_of(study);
  std::map<std::string, std::size_t> workers;  // alive, by unit
  for (const Worker& worker : status.workers) workers[worker.dataset] += worker.dead ? 0 : 1;
  Work work;
  for (const PlanUnit& unit : plan.units) {
    for (const std::size_t cell : unit.cells) {
      const Task task = tasks.run(unit, cell);
      const TaskResult result = task.result();
      ++status.cells;
      if (result.state == TaskState::kMissing) {
        ++(workers[unit.dataset] > 0 ? status.running : status.missing);
        work.left += task.weight;
      } else {
        count_result(task, result, status, work);
      }
    }
  }
  const auto alive = std::ranges::count(status.workers, false, &Worker::dead);
  if (work.done > 0.0 && alive > 0)
    status.seconds_left = work.left * work.took / work.done / static_cast<double>(alive);
  return status;
}

}  // namespace lidarena::study
