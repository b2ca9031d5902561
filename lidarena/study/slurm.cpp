// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/slurm.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/stages/process.hpp"

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
# Each task takes datasets of the study that nobody has, with their runs, until none is left.
# Submitting this again does what is missing. See docs/cluster.md.
echo "== task $SLURM_ARRAY_TASK_ID, job $SLURM_JOB_ID on $SLURMD_NODENAME, restart ${{SLURM_RESTART_COUNT:-0}}"
{command} study --worker --out {study} --scratch "{scratch}" \
  --threads "$SLURM_CPUS_PER_TASK" --grace {grace} --quiet{configs} &
worker=$!
warned=
trap 'warned=1; kill -USR1 "$worker" 2>/dev/null' USR1  # soon out of time
trap 'kill -TERM "$worker" 2>/dev/null' TERM
# A signal ends wait (128 + its number), but not the worker.
while wait "$worker"; code=$?; [ "$code" = 138 ] || [ "$code" = 143 ]; do :; done
# 75: it has ended early, with work left. The number of one of the tasks is that of the whole array,
# hence ARRAY_TASK. Slurm ends a requeued script; one that ends by itself may count as completed.
if [ -n "$warned" ] && [ "$code" = 75 ]; then
  scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID" && sleep 60
fi
exit "$code"
)sh";

constexpr const char* kReport = R"sh(#!/usr/bin/env bash
#SBATCH --job-name=lidarena-report
#SBATCH --nodes=1 --ntasks=1 --cpus-per-task={cpus}
{options}#SBATCH --output={logs}/report.log --open-mode=append
# Writes the report; exit code 1: runs of the study are missing, submit tasks.sh again.
exec {command} report {study} --threads "$SLURM_CPUS_PER_TASK"
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

/// Calls sbatch; returns the number of the job.
std::string submit_one(const std::vector<std::string>& arguments) {
  stages::Command command;
  command.arguments = {"/bin/sh", "-c", "exec sbatch --parsable \"$@\" 2>&1", "sh"};
  command.arguments.insert(command.arguments.end(), arguments.begin(), arguments.end());
  stages::Answer answer = stages::answer_of(command);
  while (answer.text.ends_with('\n')) answer.text.pop_back();
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
  const std::string at = quoted(folder.string()),
                    command = options.command.empty() ? quoted(fs::canonical(program).string())
                                                      : options.command;
  SlurmJobs jobs;
  jobs.tasks = write_script(
      folder / "tasks.sh",
      fmt::format(kTasks, arg("tasks", tasks), arg("cpus", options.cpus), arg("options", lines),
                  arg("warning", options.warning_s),
                  arg("grace", static_cast<int>(kGrace * options.warning_s)), arg("logs", logs),
                  arg("study", at), arg("command", command), arg("scratch", scratch),
                  arg("configs", options.configs.empty()
                                     ? ""
                                     : " --configs " + quoted(fs::canonical(options.configs)))));
  jobs.report =
      write_script(folder / "report.sh",
                   fmt::format(kReport, arg("cpus", options.cpus), arg("options", lines),
                               arg("logs", logs), arg("study", at), arg("command", command)));
  return jobs;
}

std::string submit(const SlurmJobs& jobs) {
  const std::string job = submit_one({jobs.tasks.string()});
  submit_one({"--dependency=afterany:" + job, jobs.report.string()});
  return job;
}

}  // namespace lidarena::study
