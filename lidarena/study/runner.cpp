// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <deque>
#include <fstream>
#include <map>
#include <memory>
#include <thread>

#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/run_manifest.hpp"
#include "lidarena/results/run_record.hpp"
#include "lidarena/stages/process.hpp"
#include "lidarena/stages/run_algorithm.hpp"
#include "lidarena/stages/run_external.hpp"
#include "lidarena/stages/score_run.hpp"
#include "lidarena/study/tasks.hpp"
#include "lidarena/study/unit_queue.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr const char* kLog = "lidarena.log";  ///< in the folder of each task
constexpr int kWorkFailed =
    1;  ///< exit code of a program whose results may be written, e.g. diverged

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// One of the jobs that run at the same time.
struct Slot {
  int threads = 1;
  stages::Command command;
  std::shared_ptr<OpenUnit> unit;
  Task task;
  std::size_t step = 0;  ///< of the task, the one that runs
  Clock::time_point begin;
  std::unique_ptr<stages::Process> process;
};

/// Processor cores for one job of several, or none for all.
std::vector<int> cores_of_job(int job, int jobs, int threads) {
  if (jobs == 1) return {};
  const std::vector<int> usable = stages::usable_cores();
  std::vector<int> cores;
  for (int i = 0; i < threads; ++i)
    cores.push_back(usable[static_cast<std::size_t>(job * threads + i) % usable.size()]);
  return cores;
}

class Runner {
 public:
  Runner(const StudyPlan& plan, const stages::ConfigFolder& configs, const fs::path& study,
         const StudyOptions& options, LogSink& log)
      : plan_(plan),
        configs_(configs),
        options_(options),
        log_(log),
        queue_(plan, configs, study, options, log),
        published_(plan, study) {
    const int jobs = std::max(1, options.jobs);
    const int cores = static_cast<int>(stages::usable_cores().size());
    const int all = options.threads > 0 ? options.threads : cores;
    const bool owns_cores = all >= cores;  // else others may use the same ones
    slots_.resize(static_cast<std::size_t>(jobs));
    for (int job = 0; job < jobs; ++job) {
      Slot& slot = slots_[static_cast<std::size_t>(job)];
      slot.threads = std::max(1, all / jobs);
      if (owns_cores) slot.command.cores = cores_of_job(job, jobs, slot.threads);
    }
  }

  WorkDone run() {
    for (;;) {
      const Stop stop = options_.stop ? options_.stop() : Stop::kNo;
      if (must_end(stop)) return interrupt();
      for (Slot& slot : slots_) {
        if (!slot.process && stop == Stop::kNo) start_next(slot);
        if (slot.process) poll(slot);
      }
      log_.progress("study", queue_.seconds_done(), queue_.seconds_of_all());
      if (!is_busy() && (stop != Stop::kNo || queue_.is_finished())) break;
      std::this_thread::sleep_for(stages::kPollPeriod);
    }
    count_repeated_warnings();
    done_.is_interrupted = queue_.has_work();
    if (!done_.is_interrupted) log_.progress("study", 1.0, 1.0);
    return done_;
  }

 private:
  struct Warning {
    std::string first;     ///< as it came
    std::size_t more = 0;  ///< that differ in figures alone
  };

  bool is_busy() const {
    return std::ranges::any_of(slots_, [](const Slot& slot) { return slot.process != nullptr; });
  }

  /// Whether what is running must be given up: at once, or after the time of grace.
  bool must_end(Stop stop) {
    if (stop == Stop::kNo) return false;
    if (!stop_seen_) stop_seen_ = Clock::now();
    return stop == Stop::kNow || seconds_since(*stop_seen_) > options_.grace_s;
  }

  WorkDone interrupt() {
    count_repeated_warnings();
    for (Slot& slot : slots_) slot.process.reset();
    slots_.clear();
    queue_.give_up();
    done_.is_interrupted = true;
    return done_;
  }

  /// Starts the first task that may start, of a unit that is open or of another one.
  void start_next(Slot& slot) {
    do {
      for (const auto& unit : queue_.open()) {
        if (start_stage_of(slot, unit)) return;
      }
    } while (queue_.open_next());
  }

  bool start_stage_of(Slot& slot, const std::shared_ptr<OpenUnit>& unit) {
    if (unit->has_flown && unit->waiting.empty()) return false;
    if (!unit->has_flown && unit->is_flying) return false;
    slot.unit = unit;
    if (unit->has_flown) {
      slot.task = std::move(unit->waiting.front());
      unit->waiting.pop_front();
    } else {
      slot.task = unit->tasks.flight(unit->unit, configs_);
      unit->is_flying = true;
    }
    ++unit->running;
    slot.step = slot.task.cell == nullptr ? 0 : slot.task.first_open_step();
    if (slot.step == 0) fs::remove_all(slot.task.folder);
    fs::create_directories(slot.task.folder);
    slot.command.log = slot.task.folder / kLog;
    slot.begin = Clock::now();
    start_step(slot);
    return true;
  }

  void start_step(Slot& slot) {
    const Step& step = slot.task.steps[slot.step];
    log_.info(slot.step == 0 ? slot.task.name : step.name + " " + slot.task.cell->name);
    fs::remove(step.product);
    std::vector<std::string> call = step.arguments();
    if (slot.task.cell == nullptr && !slot.unit->keeps_data) call.emplace_back("--no-data");
    call.insert(call.begin(), options_.program.string());
    call.insert(call.end(), {"--threads", std::to_string(slot.threads)});
    slot.command.arguments = std::move(call);
    const RunLimits& limits = plan_.spec.limits;
    slot.process = std::make_unique<stages::Process>(
        slot.command,
        stages::ProcessLimits{60.0 * limits.minutes, limits.memory_mb, limits.stall_seconds});
    slot.unit->place.tell(slot.task.name);
  }

  void poll(Slot& slot) {
    const auto end = slot.process->poll();
    if (!end) return;
    slot.process.reset();
    // A run that diverged ends so, too, and is whole; a flight is not without its example scans.
    const bool whole_run = slot.task.cell != nullptr && end->exit_code == kWorkFailed &&
                           fs::exists(slot.task.steps[slot.step].product);
    const bool done = end->exit_code == 0 || whole_run;
    const bool is_last = slot.step + 1 == slot.task.steps.size();
    if (done && !is_last) {
      slot.task.record(slot.step, 0.0);
      ++slot.step;
      return start_step(slot);
    }
    pass_on_warnings(slot.task);
    const std::shared_ptr<OpenUnit> unit = std::move(slot.unit);
    --unit->running;
    if (!queue_.holds(*unit)) {
      log_.warn(unit->unit.dataset +
                " is worked on by another process, which took this one for dead");
      unit->waiting.clear();
      unit->has_flown = true;
    } else {
      finish(*unit, slot, done ? std::string() : end->reason);
    }
    queue_.close_finished();
  }

  void finish(OpenUnit& unit, const Slot& slot, const std::string& reason) {
    try {
      slot.task.cell == nullptr ? finish_flight(unit, slot, reason)
                                : finish_cell(unit, slot, reason);
    } catch (const fs::filesystem_error& error) {
      throw Error(
          fmt::format("{}: the results of {} cannot be stored ({}); call again when that is "
                      "mended",
                      error.path1().string(), slot.task.name, error.code().message()));
    }
  }

  /// Throws if a task failed because the disk is full: its cells have no result then.
  void check_disk(const OpenUnit& unit, const std::string& reason) const {
    if (!disk_is_full(unit.place.root())) return;
    throw Error(
        fmt::format("{}: the disk is full ({}); free space or give another folder with "
                    "--scratch, and call again",
                    unit.place.root().string(), reason));
  }

  void finish_flight(OpenUnit& unit, const Slot& slot, const std::string& reason) {
    unit.is_flying = false;
    if (reason.empty()) {
      slot.task.record(0, seconds_since(slot.begin));
      unit.has_flown = true;
      ++done_.flights;
      if (published_.flight(unit.unit, configs_).first_open_step() == 0)
        unit.place.publish_dataset(unit.unit.dataset);
      return;
    }
    unit.place.drop_data(unit.unit.dataset);
    if (unit.keeps_data) {
      // Perhaps its data were larger than expected and the disk is full.
      log_.warn(
          fmt::format("{} failed ({}): trying without keeping its data", slot.task.name, reason));
      unit.keeps_data = false;
      return;
    }
    check_disk(unit, reason);
    unit.has_flown = true;
    for (Task& run : std::exchange(unit.waiting, {})) {
      fs::create_directories(run.folder);
      fs::copy_file(slot.command.log, run.folder / kLog, fs::copy_options::overwrite_existing);
      publish_failure(unit, run, results::kFlightFailed + reason, seconds_since(slot.begin));
    }
  }

  void finish_cell(OpenUnit& unit, const Slot& slot, const std::string& reason) {
    const double seconds = seconds_since(slot.begin);
    if (!reason.empty()) {
      check_disk(unit, reason);
      publish_failure(unit, slot.task, reason, seconds);
    } else {
      if (!plan_.spec.keep_maps) stages::remove_maps(slot.task.folder);
      dataset::RunManifest manifest = dataset::read_run_manifest(slot.task.folder);
      if (const StudyRecording* recording = recording_of(plan_.spec, *slot.task.cell)) {
        manifest.dataset = recording->file;  // the path from the folder is about to change
        dataset::write_run_manifest(slot.task.folder, manifest);
      }
      slot.task.record(slot.step, seconds, manifest.summary.diverged);
      unit.place.publish_run(slot.task.cell->name);
      count_run(slot.task);
    }
    log_time_left();
  }

  /// The folder of a failed cell holds the reason and the logs alone.
  void publish_failure(OpenUnit& unit, const Task& task, const std::string& reason,
                       double seconds) {
    for (const auto& entry : fs::directory_iterator(task.folder)) {
      const fs::path name = entry.path().filename();
      if (name != kLog && name != stages::kProgramLog) fs::remove_all(entry.path());
    }
    dataset::RunManifest manifest;
    manifest.algorithm = task.cell->algorithm;
    manifest.preset = task.cell->preset;
    manifest.status = dataset::RunStatus::kFailed;
    manifest.reason = reason;
    dataset::write_run_manifest(task.folder, manifest);
    task.record_failure(seconds, plan_.attempt);
    unit.place.publish_run(task.cell->name);
    log_.warn(fmt::format("{} failed: {}", task.name, reason));
    count_run(task);
  }

  void count_run(const Task& task) {
    queue_.count_done(task.weight);
    ++done_.runs;
  }

  void log_time_left() {
    const double done = queue_.seconds_done(), left = queue_.seconds_of_all() - done;
    if (done <= 0.0 || left < 0.5) return;
    log_.info(fmt::format("{} runs done, about {:.0f} min left", done_.runs,
                          std::ceil(seconds_since(begin_) * left / done / 60.0)));
  }

  /// Passes on the warnings of the task's programs. One that differs from an earlier one in figures
  /// alone is counted.
  void pass_on_warnings(const Task& task) {
    constexpr std::string_view kWarning = "warning: ";
    std::ifstream file(task.folder / kLog);
    for (std::string line; std::getline(file, line);) {
      if (!line.starts_with(kWarning)) continue;
      const std::string text = line.substr(kWarning.size());
      std::string kind = text;
      std::erase_if(kind, [](unsigned char c) { return std::isdigit(c) || c == '.'; });
      const auto [warning, is_new] = warnings_.try_emplace(kind, Warning{text});
      if (is_new)
        log_.warn(task.name + ": " + text);
      else
        ++warning->second.more;
    }
  }

  void count_repeated_warnings() {
    for (const auto& [kind, warning] : warnings_) {
      if (warning.more > 0)
        log_.warn(
            fmt::format("{} more runs, with their own figures: {}", warning.more, warning.first));
    }
  }

  const StudyPlan& plan_;
  const stages::ConfigFolder& configs_;
  const StudyOptions& options_;
  LogSink& log_;
  UnitQueue queue_;
  Tasks published_;          // in the study's folder
  std::vector<Slot> slots_;  // end before the folders that they work in
  Clock::time_point begin_ = Clock::now();
  std::optional<Clock::time_point> stop_seen_;
  std::map<std::string, Warning> warnings_;  // by the text without figures
  WorkDone done_;
};

}  // namespace

WorkDone work_on(const StudyPlan& plan, const stages::ConfigFolder& configs, const fs::path& study,
                 const StudyOptions& options, LogSink& log) {
  return Runner(plan, configs, study, options, log).run();
}

}  // namespace lidarena::study
