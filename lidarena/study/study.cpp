// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/study.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <deque>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <thread>

#include "lidarena/base/config_json.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/study/process.hpp"
#include "lidarena/study/run_algorithm.hpp"
#include "lidarena/study/run_external.hpp"
#include "lidarena/study/score_run.hpp"
#include "lidarena/study/scratch.hpp"
#include "lidarena/study/stages.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLog = "lidarena.log";  ///< in the folder of each stage
constexpr auto kPollPeriod = std::chrono::milliseconds(20);
constexpr int kWorkFailed =
    1;  ///< exit code of a program whose results may be written, e.g. diverged

/// Holds an exclusive lock on the folder during its lifetime.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder) {
    const fs::path file = folder / "study.lock";
    fd_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (fd_ < 0)
      throw InputError(file.string(), std::string("cannot be created: ") + strerror(errno));
    if (!lock_within_seconds()) {
      close(fd_);
      throw InputError(folder.string(), "another study is running in this folder",
                       "wait until it ends, or give another folder with --out");
    }
  }
  ~FolderLock() { close(fd_); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// Open in each program of the study, so that the lock lasts until the last of them has ended.
  int fd() const { return fd_; }

 private:
  /// Retries for 2 s: the programs of a study that was just killed take a moment to end.
  bool lock_within_seconds() const {
    for (int attempt = 0; attempt < 100; ++attempt) {
      if (flock(fd_, LOCK_EX | LOCK_NB) == 0) return true;
      std::this_thread::sleep_for(kPollPeriod);
    }
    return false;
  }

  int fd_ = -1;
};

void record_failure(const fs::path& run, const PlannedRun& cell, const std::string& reason) {
  fs::create_directories(run);
  for (const auto& entry : fs::directory_iterator(run)) {
    const fs::path name = entry.path().filename();
    if (name != kLog && name != kProgramLog) fs::remove_all(entry.path());
  }
  dataset::write_json(run / "manifest.json", {{"kind", "run"},
                                              {"algorithm", cell.algorithm},
                                              {"preset", cell.preset},
                                              {"failed", reason}});
}

/// Processor cores for one job of several, or none for all.
std::vector<int> cores_of_job(int job, int jobs, int threads) {
  if (jobs == 1) return {};
  const std::vector<int> usable = usable_cores();
  std::vector<int> cores;
  for (int i = 0; i < threads; ++i)
    cores.push_back(usable[static_cast<std::size_t>(job * threads + i) % usable.size()]);
  return cores;
}

/// Runs one study: starts the stages in order, each once its flight is done and, for a flight,
/// once there is room for its data.
class Runner {
 public:
  Runner(const StudySpec& spec, const Stages& stages, Scratch& scratch, const FolderLock& lock,
         const StudyOptions& options, LogSink& log)
      : spec_(spec), stages_(stages), scratch_(scratch), log_(log) {
    const int jobs = std::max(1, options.jobs);
    const int all = options.threads > 0 ? options.threads : static_cast<int>(usable_cores().size());
    slots_.resize(static_cast<std::size_t>(jobs));
    for (int job = 0; job < jobs; ++job) {
      Slot& slot = slots_[static_cast<std::size_t>(job)];
      slot.threads = std::max(1, all / jobs);
      slot.command.cores = cores_of_job(job, jobs, slot.threads);
      slot.command.inherited_fd = lock.fd();
    }
    program_ = options.program.string();
  }

  StudyOutcome run(const std::vector<PlannedRun>& cells) {
    add_stages(cells);
    while (!waiting_.empty() || is_busy()) {
      for (Slot& slot : slots_) {
        if (!slot.process) start_next(slot);
        if (slot.process) poll(slot);
      }
      log_.progress("study", weight_of_all_ - weight_left_, weight_of_all_);
      if (is_busy()) std::this_thread::sleep_for(kPollPeriod);
    }
    return outcome_;
  }

 private:
  struct Slot {
    int threads = 1;
    Command command;
    Stage stage;
    std::size_t step = 0;  ///< of the stage, the one that runs
    std::unique_ptr<Process> process;
  };

  void add_stages(const std::vector<PlannedRun>& cells) {
    std::set<std::string> flights;
    for (const PlannedRun& cell : cells) {
      if (flights.insert(cell.dataset).second) waiting_.push_back(stages_.flight(cell));
      waiting_.push_back(stages_.run(cell));
      weight_of_all_ += waiting_.back().weight;
    }
    weight_left_ = weight_of_all_;
    outcome_.cells = cells.size();
  }

  bool is_busy() const {
    return std::ranges::any_of(slots_, [](const Slot& slot) { return slot.process != nullptr; });
  }

  /// Whether a cell of the dataset is running, or waiting and not complete.
  bool is_needed(const std::string& dataset) const {
    return std::ranges::any_of(
               slots_,
               [&](const Slot& slot) { return slot.process && slot.stage.dataset == dataset; }) ||
           std::ranges::any_of(waiting_, [&](const Stage& stage) {
             return stage.cell != nullptr && stage.dataset == dataset && !stage.is_complete();
           });
  }

  /// Whether the stage has nothing left to do.
  bool is_done(const Stage& stage) const {
    if (!stage.is_complete()) return false;
    const std::string& dataset = stage.dataset;
    return stage.cell != nullptr || scratch_.has_data(dataset) || !scratch_.is_kept(dataset) ||
           !is_needed(dataset);
  }

  /// The first stage that may start: not before its flight, nor before there is room for its data.
  std::deque<Stage>::iterator next_stage() {
    std::set<std::string> blocked;  // datasets whose flight is running or waits
    for (const Slot& slot : slots_) {
      if (slot.process && slot.stage.cell == nullptr) blocked.insert(slot.stage.dataset);
    }
    return std::ranges::find_if(waiting_, [&](const Stage& stage) {
      if (blocked.contains(stage.dataset)) return false;
      const bool has_room = stage.cell != nullptr || !scratch_.is_kept(stage.dataset) ||
                            scratch_.fits_now(stage.dataset) || is_done(stage);
      if (!has_room) blocked.insert(stage.dataset);
      return has_room;
    });
  }

  /// Takes stages from the queue until one has work to do, and starts that one.
  void start_next(Slot& slot) {
    while (!slot.process) {
      const auto next = next_stage();
      if (next == waiting_.end()) return;
      slot.stage = std::move(*next);
      waiting_.erase(next);
      const Stage& stage = slot.stage;
      if (failed_flights_.contains(stage.dataset)) {
        finish(stage, failed_flights_[stage.dataset]);
      } else if (is_done(stage)) {
        outcome_.reused += stage.cell != nullptr ? 1 : 0;
        weight_of_all_ -= stage.weight;  // its time says nothing about the others
        finish(stage, {});
      } else {
        start(slot);
      }
    }
  }

  void start(Slot& slot) {
    const Stage& stage = slot.stage;
    slot.step = stage.cell == nullptr ? 0 : stage.first_open_step();
    if (slot.step == 0) fs::remove_all(stage.folder);
    fs::create_directories(stage.folder);
    slot.command.log = stage.folder / kLog;
    if (stage.cell == nullptr && scratch_.is_kept(stage.dataset)) scratch_.reserve(stage.dataset);
    start_step(slot);
  }

  void start_step(Slot& slot) {
    const Step& step = slot.stage.steps[slot.step];
    log_.info(slot.step == 0 ? slot.stage.name : step.name + " " + slot.stage.cell->name);
    fs::remove(step.product);
    std::vector<std::string> call = step.arguments();
    if (slot.stage.cell == nullptr) {
      call.emplace_back(scratch_.is_kept(slot.stage.dataset) ? "--scored-truth" : "--no-data");
    }
    call.insert(call.begin(), program_);
    call.insert(call.end(), {"--threads", std::to_string(slot.threads)});
    slot.command.arguments = std::move(call);
    const RunLimits& limits = spec_.limits;
    slot.process = std::make_unique<Process>(
        slot.command, ProcessLimits{60.0 * limits.minutes, limits.memory_mb, limits.stall_seconds});
  }

  void poll(Slot& slot) {
    const auto end = slot.process->poll();
    if (!end) return;
    slot.process.reset();
    const bool done = end->exit_code == 0 || (end->exit_code == kWorkFailed &&
                                              fs::exists(slot.stage.steps[slot.step].product));
    if (done) slot.stage.record(slot.step);
    if (done && ++slot.step < slot.stage.steps.size()) return start_step(slot);
    pass_on_warnings(slot.stage);
    finish(slot.stage, done ? std::string() : end->reason);
    if (slot.stage.cell != nullptr) log_time_left();
  }

  void log_time_left() {
    const double done = weight_of_all_ - weight_left_;
    if (done <= 0.0 || outcome_.runs == outcome_.cells) return;
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
    log_.info(fmt::format("{} of {} runs done, about {:.0f} min left", outcome_.runs,
                          outcome_.cells, std::ceil(elapsed.count() * weight_left_ / done / 60.0)));
  }

  void finish(const Stage& stage, const std::string& reason) {
    if (stage.cell == nullptr) {
      finish_flight(stage, reason);
    } else {
      finish_cell(stage, reason);
    }
    if (!is_needed(stage.dataset)) scratch_.drop(stage.dataset);
  }

  void finish_flight(const Stage& flight, const std::string& reason) {
    if (reason.empty()) return scratch_.settle(flight.dataset);
    if (!scratch_.is_kept(flight.dataset)) {
      failed_flights_[flight.dataset] = "flight: " + reason;
      return;
    }
    // Perhaps its data were larger than expected and the disk is full.
    log_.warn(fmt::format("{} failed ({}): trying without keeping its data", flight.name, reason));
    scratch_.give_up(flight.dataset);
    waiting_.push_front(flight);
  }

  void finish_cell(const Stage& stage, const std::string& reason) {
    weight_left_ -= stage.weight;
    ++outcome_.runs;
    if (!reason.empty()) {
      record_failure(stage.folder, *stage.cell, reason);
      log_.warn(fmt::format("{} failed: {}", stage.name, reason));
      ++outcome_.failed;
      return;
    }
    if (!spec_.keep_maps) remove_maps(stage.folder);
    const Json manifest = dataset::read_json(stage.folder / "manifest.json");
    outcome_.diverged += manifest.at("summary").at("diverged").get<bool>() ? 1 : 0;
  }

  /// Passes on the warnings of the stage's programs.
  void pass_on_warnings(const Stage& stage) {
    constexpr std::string_view kWarning = "warning: ";
    std::ifstream file(stage.folder / kLog);
    for (std::string line; std::getline(file, line);) {
      if (line.starts_with(kWarning)) log_.warn(stage.name + ": " + line.substr(kWarning.size()));
    }
  }

  const StudySpec& spec_;
  const Stages& stages_;
  Scratch& scratch_;
  LogSink& log_;
  std::string program_;
  std::vector<Slot> slots_;
  std::deque<Stage> waiting_;
  std::map<std::string, std::string> failed_flights_;  ///< datasets whose flight failed, and why
  double weight_of_all_ = 0.0, weight_left_ = 0.0;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  StudyOutcome outcome_;
};

/// Expected bytes of the data of each dataset that has a cell to run or to score.
std::map<std::string, std::uint64_t> needed_data(const StudySpec& spec, const Stages& stages,
                                                 const ConfigFolder& configs,
                                                 const std::vector<PlannedRun>& cells) {
  std::map<std::string, std::uint64_t> needed;
  for (const PlannedRun& cell : cells) {
    if (needed.contains(cell.dataset) || stages.run(cell).is_complete()) continue;
    needed[cell.dataset] = data_bytes(spec, cell, configs);
  }
  return needed;
}

}  // namespace

StudyOutcome run_study(const StudySpec& spec, const ConfigFolder& configs, const fs::path& out,
                       const StudyOptions& options, LogSink& log) {
  const std::vector<PlannedRun> cells = cells_of_shard(plan(spec, configs), options.shard, configs);
  StudyOptions found = options;
  found.program = find_program(options.program);
  fs::create_directories(out);
  const FolderLock lock(out);
  const Stages stages(spec, configs, out, ProgramCode(found.program, out / "program.json"));
  dataset::write_json(out / "study.json",
                      {{"kind", "study"},
                       {"spec", to_json(spec)},
                       {"runs", value_to_json(cells)},
                       {"reference", value_to_json(load_reference(spec, configs))}});
  Scratch scratch(out / "datasets", options.scratch_bytes.value_or(default_scratch_bytes(out)),
                  needed_data(spec, stages, configs, cells));
  return Runner(spec, stages, scratch, lock, found, log).run(cells);
}

}  // namespace lidarena::study
