// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/study.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lidarena/dataset/existing_folder.hpp"
#include "lidarena/study/known_rows.hpp"
#include "lidarena/study/lease.hpp"
#include "lidarena/study/program.hpp"
#include "lidarena/study/runner.hpp"
#include "lidarena/study/tasks.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

/// The plan in the folder, if there is one that can be read.
std::optional<StudyPlan> existing_plan(const fs::path& out) {
  try {
    return read_plan(out);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

StudyOptions with_absolute_paths(StudyOptions options) {
  options.program = find_program(options.program);
  if (!options.scratch.empty()) options.scratch = fs::absolute(options.scratch);
  return options;
}

/// Whether the plans differ in more than the attempt.
bool is_same(const StudyPlan& a, StudyPlan b) {
  b.attempt = a.attempt;
  return to_json(a) == to_json(b);
}

StudyOutcome outcome_of(const StudyPlan& plan, const fs::path& out, const Shard& shard,
                        const WorkDone& done) {
  StudyOutcome outcome;
  const Tasks tasks(plan, out);
  for (const std::size_t i : units_of(plan, shard)) {
    for (const std::size_t cell : plan.units[i].cells) {
      const TaskState state = tasks.run(plan.units[i], cell).result().state;
      ++outcome.cells;
      outcome.runs += state == TaskState::kMissing ? 0 : 1;
      outcome.failed += state == TaskState::kFailed ? 1 : 0;
      outcome.diverged += state == TaskState::kDiverged ? 1 : 0;
    }
  }
  outcome.reused = outcome.runs - std::min(outcome.runs, done.runs);
  outcome.is_interrupted = done.is_interrupted;
  outcome.has_advanced = done.runs + done.flights > 0;
  return outcome;
}

void check_shards(const StudyPlan& plan, const fs::path& out, const Shard& shard) {
  if (shard.of == 1 || shard.of == plan.shards) return;
  throw InputError((out / "plan.json").string(),
                   fmt::format("has {} shards, not {}", plan.shards, shard.of),
                   "give the same N in --shard K/N to all parts, or another folder");
}

StudyOutcome work(const StudyPlan& plan, const fs::path& out, const stages::ConfigFolder& configs,
                  const StudyOptions& options, LogSink& log) {
  check_shards(plan, out, options.shard);
  return outcome_of(plan, out, options.shard, work_on(plan, configs, out, options, log));
}

}  // namespace

StudyPlan plan_study(const StudySpec& spec, const stages::ConfigFolder& configs,
                     const fs::path& out, const StudyOptions& options) {
  const ProgramCode code = ProgramCode::ask(find_program(options.program));
  fs::create_directories(out);
  const std::optional<StudyPlan> known = existing_plan(out);
  const bool has_shards = known && known->shards > 1;
  if (has_shards) check_shards(*known, out, options.shard);
  StudyPlan plan = make_plan(spec, configs, code, has_shards ? known->shards : options.shard.of);
  if (std::ranges::any_of(all_leases(out / "leases"),
                          [](const LeaseSeen& lease) { return !lease.dead; })) {
    if (known && is_same(*known, plan)) return *known;
    throw InputError(out.string(), "another study is running in this folder",
                     "wait until it ends, or give another folder with --out");
  }
  if (known) plan.attempt = known->attempt + 1;
  write_plan(out, plan);
  return plan;
}

StudyOutcome work_on_study(const fs::path& out, const stages::ConfigFolder& configs,
                           const StudyOptions& options, LogSink& log) {
  const StudyOptions found = with_absolute_paths(options);
  const StudyPlan plan = read_plan(out);
  if (ProgramCode::ask(found.program).json() != plan.code) {
    throw InputError(found.program.string(), "is not the program that planned the study",
                     "install the same one on all machines, or plan again");
  }
  return work(plan, fs::absolute(out), configs, found, log);
}

StudyOutcome run_study(const StudySpec& spec, const stages::ConfigFolder& configs,
                       const fs::path& out, const StudyOptions& options, LogSink& log) {
  const StudyOptions found = with_absolute_paths(options);
  const StudyPlan plan = plan_study(spec, configs, out, found);
  for (const fs::path& csv : options.known) {
    const KnownRows known = take_known_rows(plan, out, csv);
    log.info(fmt::format("{}: {} runs are known", csv.string(), known.taken));
    if (known.other > 0)
      log.warn(fmt::format("{}: {} rows were made by other code or settings, and are not used",
                           csv.string(), known.other));
  }
  return work(plan, fs::absolute(out), configs, found, log);
}

std::uint64_t default_scratch_bytes(const fs::path& folder) {
  return fs::space(dataset::existing_folder(folder)).available / 2;
}

}  // namespace lidarena::study
