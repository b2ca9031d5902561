// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <fstream>
#include <memory>
#include <thread>

#include "lidarena/dataset/json_file.hpp"
#include "lidarena/study/process.hpp"
#include "lidarena/study/run_algorithm.hpp"
#include "lidarena/study/run_external.hpp"
#include "lidarena/study/score_run.hpp"
#include "lidarena/study/stages.hpp"
#include "lidarena/study/unit_queue.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr const char* kLog = "lidarena.log";  ///< in the folder of each stage
constexpr int kWorkFailed =
    1;  ///< exit code of a program whose results may be written, e.g. diverged

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// One of the jobs that run at the same time.
struct Slot {
  int threads = 1;
  Command command;
  std::shared_ptr<OpenUnit> unit;
  Stage stage;
  std::size_t step = 0;  ///< of the stage, the one that runs
  Clock::time_point begin;
  std::unique_ptr<Process> process;
};

/// Processor cores for one job of several, or none for all.
std::vector<int> cores_of_job(int job, int jobs, int threads) {
  if (jobs == 1) return {};
  const std::vector<int> usable = usable_cores();
  std::vector<int> cores;
  for (int i = 0; i < threads; ++i)
    cores.push_back(usable[static_cast<std::size_t>(job * threads + i) % usable.size()]);
  return cores;
}

class Runner {
 public:
  Runner(const StudyPlan& plan, const ConfigFolder& configs, const fs::path& study,
         const StudyOptions& options, LogSink& log)
      : plan_(plan),
        configs_(configs),
        options_(options),
        log_(log),
        queue_(plan, configs, study, options, log),
        published_(plan, study) {
    const int jobs = std::max(1, options.jobs);
    const int cores = static_cast<int>(usable_cores().size());
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
      std::this_thread::sleep_for(kPollPeriod);
    }
    done_.is_interrupted = queue_.has_work();
    if (!done_.is_interrupted) log_.progress("study", 1.0, 1.0);
    return done_;
  }

 private:
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
    for (Slot& slot : slots_) slot.process.reset();
    slots_.clear();
    queue_.give_up();
    done_.is_interrupted = true;
    return done_;
  }

  /// Starts the first stage that may start, of a unit that is open or of another one.
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
      slot.stage = std::move(unit->waiting.front());
      unit->waiting.pop_front();
    } else {
      slot.stage = unit->stages.flight(unit->unit, configs_);
      unit->is_flying = true;
    }
    ++unit->running;
    slot.step = slot.stage.cell == nullptr ? 0 : slot.stage.first_open_step();
    if (slot.step == 0) fs::remove_all(slot.stage.folder);
    fs::create_directories(slot.stage.folder);
    slot.command.log = slot.stage.folder / kLog;
    slot.begin = Clock::now();
    start_step(slot);
    return true;
  }

  void start_step(Slot& slot) {
    const Step& step = slot.stage.steps[slot.step];
    log_.info(slot.step == 0 ? slot.stage.name : step.name + " " + slot.stage.cell->name);
    fs::remove(step.product);
    std::vector<std::string> call = step.arguments();
    if (slot.stage.cell == nullptr)
      call.emplace_back(slot.unit->keeps_data ? "--scored-truth" : "--no-data");
    call.insert(call.begin(), options_.program.string());
    call.insert(call.end(), {"--threads", std::to_string(slot.threads)});
    slot.command.arguments = std::move(call);
    const RunLimits& limits = plan_.spec.limits;
    slot.process = std::make_unique<Process>(
        slot.command, ProcessLimits{60.0 * limits.minutes, limits.memory_mb, limits.stall_seconds});
    slot.unit->place.tell(slot.stage.name);
  }

  void poll(Slot& slot) {
    const auto end = slot.process->poll();
    if (!end) return;
    slot.process.reset();
    // A run that diverged ends so, too, and is whole; a flight is not without its example scans.
    const bool whole_run = slot.stage.cell != nullptr && end->exit_code == kWorkFailed &&
                           fs::exists(slot.stage.steps[slot.step].product);
    const bool done = end->exit_code == 0 || whole_run;
    const bool is_last = slot.step + 1 == slot.stage.steps.size();
    if (done && !is_last) {
      slot.stage.record(slot.step, 0.0);
      ++slot.step;
      return start_step(slot);
    }
    pass_on_warnings(slot.stage);
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
      slot.stage.cell == nullptr ? finish_flight(unit, slot, reason)
                                 : finish_cell(unit, slot, reason);
    } catch (const fs::filesystem_error& error) {
      throw Error(
          fmt::format("{}: the results of {} cannot be stored ({}); call again when that is "
                      "mended",
                      error.path1().string(), slot.stage.name, error.code().message()));
    }
  }

  /// Throws if a stage failed because the disk is full: its cells have no result then.
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
      slot.stage.record(0, seconds_since(slot.begin));
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
          fmt::format("{} failed ({}): trying without keeping its data", slot.stage.name, reason));
      unit.keeps_data = false;
      return;
    }
    check_disk(unit, reason);
    unit.has_flown = true;
    for (Stage& run : std::exchange(unit.waiting, {})) {
      fs::create_directories(run.folder);
      fs::copy_file(slot.command.log, run.folder / kLog, fs::copy_options::overwrite_existing);
      publish_failure(unit, run, "flight: " + reason, seconds_since(slot.begin));
    }
  }

  void finish_cell(OpenUnit& unit, const Slot& slot, const std::string& reason) {
    const double seconds = seconds_since(slot.begin);
    if (!reason.empty()) {
      check_disk(unit, reason);
      publish_failure(unit, slot.stage, reason, seconds);
    } else {
      if (!plan_.spec.keep_maps) remove_maps(slot.stage.folder);
      const Json manifest = dataset::read_json(slot.stage.folder / "manifest.json");
      slot.stage.record(slot.step, seconds, manifest.at("summary").at("diverged").get<bool>());
      unit.place.publish_run(slot.stage.cell->name);
      count_run(slot.stage);
    }
    log_time_left();
  }

  /// The folder of a failed cell holds the reason and the logs alone.
  void publish_failure(OpenUnit& unit, const Stage& stage, const std::string& reason,
                       double seconds) {
    for (const auto& entry : fs::directory_iterator(stage.folder)) {
      const fs::path name = entry.path().filename();
      if (name != kLog && name != kProgramLog) fs::remove_all(entry.path());
    }
    dataset::write_json(stage.folder / "manifest.json", {{"kind", "run"},
                                                         {"algorithm", stage.cell->algorithm},
                                                         {"preset", stage.cell->preset},
                                                         {"failed", reason}});
    stage.record_failure(seconds, plan_.attempt);
    unit.place.publish_run(stage.cell->name);
    log_.warn(fmt::format("{} failed: {}", stage.name, reason));
    count_run(stage);
  }

  void count_run(const Stage& stage) {
    queue_.count_done(stage.weight);
    ++done_.runs;
  }

  void log_time_left() {
    const double done = queue_.seconds_done(), left = queue_.seconds_of_all() - done;
    if (done <= 0.0 || left < 0.5) return;
    log_.info(fmt::format("{} runs done, about {:.0f} min left", done_.runs,
                          std::ceil(seconds_since(begin_) * left / done / 60.0)));
  }

  /// Passes on the warnings of the stage's programs.
  void pass_on_warnings(const Stage& stage) {
    constexpr std::string_view kWarning = "warning: ";
    std::ifstream file(stage.folder / kLog);
    for (std::string line; std::getline(file, line);) {
      if (line.starts_with(kWarning)) log_.warn(stage.name + ": " + line.substr(kWarning.size()));
    }
  }

  const StudyPlan& plan_;
  const ConfigFolder& configs_;
  const StudyOptions& options_;
  LogSink& log_;
  UnitQueue queue_;
  Stages published_;         // in the study's folder
  std::vector<Slot> slots_;  // end before the folders that they work in
  Clock::time_point begin_ = Clock::now();
  std::optional<Clock::time_point> stop_seen_;
  WorkDone done_;
};

}  // namespace

WorkDone work_on(const StudyPlan& plan, const ConfigFolder& configs, const fs::path& study,
                 const StudyOptions& options, LogSink& log) {
  return Runner(plan, configs, study, options, log).run();
}

}  // namespace lidarena::study
