// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lidarena/study/plan.hpp"

namespace lidarena::study {

struct SlurmOptions {
  std::string partition;  ///< empty = the cluster's default
  std::string time;       ///< limit of a task, as sbatch takes it; empty = the partition's
  int cpus = 2;           ///< of a task
  int array_limit = 64;   ///< tasks at the same time; at most one a unit is started
  int warning_s = 120;    ///< before the limit of time, when a task is told to end
  std::vector<std::string> sbatch;  ///< more options of sbatch, e.g. --account=NAME
  std::string configs;              ///< folder given with --configs; empty = the tasks search
  std::string command;  ///< that calls lidarena on a node; empty = this program at its path
  std::string scratch;  ///< folder on the nodes; empty = $TMPDIR or /tmp there
};

/// The two batch scripts of a planned study.
struct SlurmJobs {
  std::filesystem::path tasks;   ///< an array job, whose tasks take units until none is left
  std::filesystem::path report;  ///< writes the report once all tasks have ended
};

/// Writes the batch scripts into the study's folder. `program`: lidarena, at a path that is the
/// same on all nodes. Writing again gives the same bytes.
SlurmJobs write_slurm_jobs(const StudyPlan& plan, const std::filesystem::path& study,
                           const std::filesystem::path& program, const SlurmOptions& options);

/// Submits both; returns the number of the array job. Throws InputError if there is no sbatch or it
/// refuses.
std::string submit(const SlurmJobs& jobs);

}  // namespace lidarena::study
