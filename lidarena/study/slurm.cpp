// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/slurm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/study/process.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

/// Share of the time after the warning that runs in progress may use to finish.
constexpr double kGrace = 0.75;

constexpr const char* kTasks = R"sh(#!/usr/bin/env bash
#SBATCH --job-name=lidarena
#SBATCH --array=1-{tasks}
#SBATCH --nodes=1 --ntasks=1 --cpus-per-task={cpus}
{options}#SBATCH --requeue
#SBATCH --signal=B:USR1@{warning}
#SBATCH --output={logs}/task-%a.log --open-mode=append
# Each task takes datasets of the study that nobody has, with their runs, until none is left. Soon
# before the limit of time Slurm sends USR1: the worker ends what it does and is requeued.
# Submitting this again does what is missing. See docs/cluster.md.
echo "== task $SLURM_ARRAY_TASK_ID, job $SLURM_JOB_ID on $SLURMD_NODENAME, restart ${{SLURM_RESTART_COUNT:-0}}"
exec {program} study --worker --out {study} --scratch "{scratch}" \
  --threads "$SLURM_CPUS_PER_TASK" --grace {grace} --quiet{configs}
)sh";

constexpr const char* kReport = R"sh(#!/usr/bin/env bash
#SBATCH --job-name=lidarena-report
#SBATCH --nodes=1 --ntasks=1 --cpus-per-task={cpus}
{options}#SBATCH --output={logs}/report.log --open-mode=append
# Writes the report; exit code 1: runs of the study are missing, submit tasks.sh again.
exec {program} report {study} --threads "$SLURM_CPUS_PER_TASK"
)sh";

/// For a shell and for #SBATCH lines, which know no escapes.
std::string quoted(const std::string& path) {
  if (path.find_first_of("'\"\\\n%") != std::string::npos) {
    throw InputError(path, "has quotes, backslashes or % in its name",
                     "Slurm takes no such path, choose another one");
  }
  return "'" + path + "'";
}

std::string option_lines(const SlurmOptions& options) {
  std::string lines;
  if (!options.partition.empty()) lines += "#SBATCH --partition=" + options.partition + "\n";
  if (!options.time.empty()) lines += "#SBATCH --time=" + options.time + "\n";
  for (const std::string& more : options.sbatch) lines += "#SBATCH " + more + "\n";
  return lines;
}

fs::path write_script(const fs::path& file, const std::string& text) {
  dataset::write_text_file(file, text);
  fs::permissions(file, fs::perms::owner_exec | fs::perms::group_exec, fs::perm_options::add);
  return file;
}

/// Calls a program of Slurm; returns what it printed on any output.
Answer call(const std::string& program, const std::vector<std::string>& arguments) {
  Command command;
  command.arguments = {"/bin/sh", "-c", "exec " + program + " \"$@\" 2>&1", "sh"};
  command.arguments.insert(command.arguments.end(), arguments.begin(), arguments.end());
  Answer answer = answer_of(command);
  while (answer.text.ends_with('\n')) answer.text.pop_back();
  return answer;
}

/// Calls sbatch; returns the number of the job.
std::string submit_one(const std::vector<std::string>& arguments) {
  const Answer answer = call("sbatch --parsable", arguments);
  if (answer.end.exit_code != 0) {
    throw InputError(
        "sbatch", answer.text.empty() ? "failed" : answer.text,
        "if jobs are submitted on another machine, call it there for " + arguments.back());
  }
  return answer.text.substr(0, answer.text.find(';'));  // JOB;CLUSTER
}

}  // namespace

SlurmJobs write_slurm_jobs(const StudyPlan& plan, const fs::path& study, const fs::path& program,
                           const SlurmOptions& options) {
  using fmt::arg;
  const fs::path folder = fs::canonical(study);
  fs::create_directories(folder / "logs");
  const int tasks = std::min(static_cast<int>(plan.units.size()), options.array_limit);
  const std::string scratch =
      options.scratch.empty() ? "${SLURM_TMPDIR:-${TMPDIR:-/tmp}}" : options.scratch;
  const std::string lines = option_lines(options), logs = quoted((folder / "logs").string());
  const std::string at = quoted(folder.string()), calls = quoted(fs::canonical(program).string());
  SlurmJobs jobs;
  jobs.tasks = write_script(
      folder / "tasks.sh",
      fmt::format(kTasks, arg("tasks", tasks), arg("cpus", options.cpus), arg("options", lines),
                  arg("warning", options.warning_s),
                  arg("grace", static_cast<int>(kGrace * options.warning_s)), arg("logs", logs),
                  arg("study", at), arg("program", calls), arg("scratch", scratch),
                  arg("configs", options.configs.empty()
                                     ? ""
                                     : " --configs " + quoted(fs::canonical(options.configs)))));
  jobs.report =
      write_script(folder / "report.sh",
                   fmt::format(kReport, arg("cpus", options.cpus), arg("options", lines),
                               arg("logs", logs), arg("study", at), arg("program", calls)));
  return jobs;
}

std::string submit(const SlurmJobs& jobs) {
  const std::string job = submit_one({jobs.tasks.string()});
  submit_one({"--dependency=afterany:" + job, jobs.report.string()});
  return job;
}

bool is_slurm_job() { return std::getenv("SLURM_JOB_ID") != nullptr; }

void requeue_this_job() {
  const Answer answer = call("scontrol requeue", {std::getenv("SLURM_JOB_ID")});
  if (answer.end.exit_code != 0) throw Error("scontrol requeue: " + answer.text);
}

}  // namespace lidarena::study
