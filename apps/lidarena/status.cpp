// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/status.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <deque>
#include <fstream>
#include <thread>

#include "apps/lidarena/console.hpp"
#include "apps/lidarena/verbs.hpp"

namespace lidarena {
namespace {

constexpr std::size_t kLogLines = 8;
constexpr std::size_t kFailuresShown = 20;
constexpr double kSilence_s = 15.0;  ///< of a worker, worth a remark
constexpr auto kWatchPeriod = std::chrono::seconds(5);

struct StatusRequest {
  std::string folder;
  bool watch = false;
};

std::string last_lines(const std::string& file) {
  std::deque<std::string> lines;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    lines.push_back("    " + line);
    if (lines.size() > kLogLines) lines.pop_front();
  }
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

std::string worker_text(const study::Worker& worker) {
  std::string remark;
  if (worker.dead) {
    remark = ", has ended: its work will be taken over";
  } else if (worker.silent_s > kSilence_s) {
    remark = fmt::format(", no sign of life for {:.0f} s", worker.silent_s);
  }
  const std::string job = worker.job.empty() ? "" : " (job " + worker.job + ")";
  return fmt::format("  {}{}: {}, for {}{}\n", worker.host, job,
                     worker.doing.empty() ? worker.dataset : worker.doing,
                     clock_text(worker.since_s), remark);
}

std::string status_text(const study::StudyStatus& status) {
  const double done = static_cast<double>(status.done + status.failed);
  std::string text = fmt::format(
      "{}: {} runs, {:.0f} %\n  done {} ({} diverged), failed {}, running {}, missing {}\n",
      status.title, status.cells, 100.0 * done / static_cast<double>(status.cells), status.done,
      status.diverged, status.failed, status.running, status.missing);
  if (status.seconds_left)
    text += fmt::format("  about {} left\n", clock_text(*status.seconds_left));
  if (!status.workers.empty()) text += fmt::format("at work: {}\n", status.workers.size());
  for (const study::Worker& worker : status.workers) text += worker_text(worker);
  if (!status.failures.empty()) text += "failed:\n";
  for (std::size_t i = 0; i < std::min(status.failures.size(), kFailuresShown); ++i) {
    const study::FailedCell& failed = status.failures[i];
    text += fmt::format("  {}: {}\n", failed.name, failed.reason);
    if (!failed.log.empty()) text += fmt::format("    log: {}\n", failed.log);
  }
  if (status.failures.size() > kFailuresShown)
    text += fmt::format("  and {} more (--json)\n", status.failures.size() - kFailuresShown);
  if (!status.failures.empty() && !status.failures.front().log.empty())
    text += "end of the first log:\n" + last_lines(status.failures.front().log);
  return text;
}

int status_verb(const Common& common, const StatusRequest& request) {
  for (;;) {
    const study::StudyStatus status = study::read_status(request.folder);
    const bool is_over = status.running + status.missing == 0;
    if (common.json) {
      print_json(to_json(status));
    } else {
      if (request.watch && isatty(STDOUT_FILENO) == 1) fmt::print("\x1b[H\x1b[2J");
      fmt::print("{}", status_text(status));
    }
    std::fflush(stdout);
    if (!request.watch || is_over) return kDone;
    std::this_thread::sleep_for(kWatchPeriod);
  }
}

}  // namespace

void add_status(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand(
      "status", "How far a study is: runs done, running, failed, missing; who is at work");
  auto request = std::make_shared<StatusRequest>();
  verb->add_option("study", request->folder, "Folder of the study")->required();
  verb->add_flag("--watch", request->watch, "Show it again every 5 s until no run is missing");
  set_verb(
      *verb, common, [&common, request] { return status_verb(common, *request); }, exit_code);
}

}  // namespace lidarena
