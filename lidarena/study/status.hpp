// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"

namespace lidarena::study {

struct FailedCell {
  std::string name;
  std::string reason;
  std::string log;  ///< file; empty if there is none

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "");
    v("reason", self.reason, "", "");
    v("log", self.log, "", "");
  }
};

/// A process that works on a unit of the study.
struct Worker {
  std::string host;
  int process = 0;
  std::string job;        ///< number of its Slurm job; empty outside of Slurm
  std::string dataset;    ///< the unit that it has leased
  std::string doing;      ///< the task that it began last
  double since_s = 0.0;   ///< age of its lease
  double silent_s = 0.0;  ///< since its last sign of life
  bool dead = false;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("host", self.host, "", "");
    v("process", self.process, "", "");
    v("job", self.job, "", "");
    v("dataset", self.dataset, "", "");
    v("doing", self.doing, "", "");
    v("since_s", self.since_s, "s", "");
    v("silent_s", self.silent_s, "s", "");
    v("dead", self.dead, "", "");
  }
};

/// How far a study is. Every cell is done, failed, running or missing.
struct StudyStatus {
  std::string title;
  std::size_t cells = 0;
  std::size_t done = 0;  ///< scored, with those that diverged
  std::size_t diverged = 0;
  std::size_t failed = 0;
  std::size_t running = 0;             ///< without a state, in a unit that a live worker has
  std::size_t missing = 0;             ///< without a state, and nobody is at work on them
  std::optional<double> seconds_left;  ///< with as many workers as at present; empty if unknown
  std::vector<FailedCell> failures;
  std::vector<Worker> workers;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("title", self.title, "", "");
    v("cells", self.cells, "", "");
    v("done", self.done, "", "");
    v("diverged", self.diverged, "", "");
    v("failed", self.failed, "", "");
    v("running", self.running, "", "");
    v("missing", self.missing, "", "");
    v("seconds_left", self.seconds_left, "s", "");
    v("failures", self.failures, "", "");
    v("workers", self.workers, "", "");
  }
};

/// Reads the plan, the results and the leases in a study's folder. Throws InputError if it holds no
/// plan.
StudyStatus read_status(const std::filesystem::path& study);

}  // namespace lidarena::study
