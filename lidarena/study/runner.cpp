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
#include "lidarena/study/claim.hpp"
#include "lidarena/study/process.hpp"
#include "lidarena/study/run_algorithm.hpp"
#include "lidarena/study/run_external.hpp"
#include "lidarena/study/score_run.hpp"
#include "lidarena/study/stages.hpp"
#include "lidarena/study/workplace.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr const char* kLog = "lidarena.log";  ///< in the folder of each stage
constexpr auto kPollPeriod = std::chrono::milliseconds(20);
constexpr auto kScanPeriod = std::chrono::seconds(1);  ///< between looks at the claims of others
/// A claim untouched for this long may be that of a dead process: worth waiting for.
constexpr double kSuspiciousSilence_s = 15.0;
constexpr int kWorkFailed =
    1;  ///< exit code of a program whose results may be written, e.g. diverged

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// A claimed unit.
struct OpenUnit {
  OpenUnit(const PlanUnit& planned, const StudyPlan& plan, const fs::path& study,
           const fs::path& scratch, const std::string& token)
      : unit(planned), place(study, scratch, token), stages(plan, place.root()) {}

  const PlanUnit& unit;
  Workplace place;
  Stages stages;
  std::deque<Stage> waiting;  ///< cells to run or to score
  bool keeps_data = true;     ///< false: its dataset is simulated anew for each run
  bool is_flying = false, has_flown = false;
  int running = 0;
};

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

/// Processor cores for one job of several; none for all, if this process shares the machine with
/// others or has only one job.
std::vector<int> cores_of_job(int job, int jobs, int threads) {
  const std::vector<int> usable = usable_cores();
  if (jobs == 1 || static_cast<int>(usable.size()) > jobs * threads) return {};
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
        study_(study),
        options_(options),
        log_(log),
        claims_(study / "claims", options.scratch.string()),
        published_(plan, study) {
    const int jobs = std::max(1, options.jobs);
    const int all = options.threads > 0 ? options.threads : static_cast<int>(usable_cores().size());
    slots_.resize(static_cast<std::size_t>(jobs));
    for (int job = 0; job < jobs; ++job) {
      Slot& slot = slots_[static_cast<std::size_t>(job)];
      slot.threads = std::max(1, all / jobs);
      slot.command.cores = cores_of_job(job, jobs, slot.threads);
    }
    for (const std::size_t i : units_of(plan, options.shard)) {
      todo_.push_back(&plan.units[i]);
      weight_of_all_ += plan.units[i].seconds;
    }
    weight_left_ = weight_of_all_;
  }

  WorkDone run() {
    for (;;) {
      const Stop stop = options_.stop ? options_.stop() : Stop::kNo;
      if (must_end(stop)) return interrupt();
      for (Slot& slot : slots_) {
        if (!slot.process && stop == Stop::kNo) start_next(slot);
        if (slot.process) poll(slot);
      }
      log_.progress("study", weight_of_all_ - weight_left_, weight_of_all_);
      if (!is_busy() && (stop != Stop::kNo || is_finished())) break;
      std::this_thread::sleep_for(kPollPeriod);
    }
    done_.is_interrupted = !open_.empty() || !todo_.empty();
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
    open_.clear();
    done_.is_interrupted = true;
    return done_;
  }

  /// Whether this worker may leave: nothing is left, or others are at work on all of it. A worker
  /// for the whole study waits for them, any other only while one of them may be dead.
  bool is_finished() {
    if (!open_.empty()) return false;
    if (todo_.empty()) return true;
    if (!std::exchange(has_scanned_, false)) return false;
    if (options_.waits_for_others) return tell_waiting(), false;
    const bool leaves = std::ranges::none_of(todo_, [&](const PlanUnit* unit) {
      const std::optional<ClaimSeen> claim = claims_.look(unit->dataset);
      return !claim || claim->silent_s > kSuspiciousSilence_s;
    });
    if (leaves) todo_.clear();
    return leaves;
  }

  void tell_waiting() {
    if (std::exchange(has_told_waiting_, true)) return;
    log_.info(fmt::format("waiting for other processes that work on {} datasets", todo_.size()));
  }

  /// Starts the first stage that may start, of a unit that is open or of another one.
  void start_next(Slot& slot) {
    do {
      for (const auto& unit : open_) {
        if (start_stage_of(slot, unit)) return;
      }
    } while (open_next_unit());
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

  /// Cells of a unit that have no state yet, of those that the study's folder holds.
  std::vector<std::size_t> open_cells(const PlanUnit& unit) const {
    std::vector<std::size_t> open;
    for (const std::size_t cell : unit.cells) {
      const StageResult result = published_.run(unit, cell).result();
      const bool has_state = result.state == StageState::kFailed
                                 ? result.attempt == plan_.attempt
                                 : result.state != StageState::kMissing;
      if (!has_state) open.push_back(cell);
    }
    return open;
  }

  /// Claims the first unit with work that nobody has; false if there is none, or no room for it.
  bool open_next_unit() {
    if (next_scan_ > Clock::now()) return false;
    for (auto next = todo_.begin(); next != todo_.end();) {
      const PlanUnit& unit = **next;
      if (open_cells(unit).empty()) {
        count_out(unit.seconds);
        next = todo_.erase(next);
        continue;
      }
      const bool has_room = has_room_for(unit);
      if (!has_room && !open_.empty()) break;
      const std::optional<Claims::Taken> taken = claims_.take(unit.dataset);
      if (taken) {
        next = todo_.erase(next);
        open(unit, *taken, has_room);
        return true;
      }
      ++next;
    }
    next_scan_ = Clock::now() + kScanPeriod;
    has_scanned_ = true;
    return false;
  }

  void count_out(double seconds) {
    weight_of_all_ -= seconds;  // the time of what others did says nothing about this worker
    weight_left_ -= seconds;
  }

  void open(const PlanUnit& unit, const Claims::Taken& taken, bool has_room) {
    if (const auto& dead = taken.taken_from) {
      log_.info(fmt::format("{} is taken over from process {} on {}, which has ended", unit.dataset,
                            dead->process, dead->host));
      clear_workplace(study_, dead->scratch, dead->token);
    }
    if (flight_key(plan_, unit, configs_) != unit.flight) {
      claims_.release(unit.dataset);
      throw InputError(configs_.root().string(),
                       "differs, here, from the files with which " + unit.dataset + " was planned",
                       "plan the study again, or install the same files on all machines");
    }
    open_.push_back(std::make_shared<OpenUnit>(unit, plan_, study_, options_.scratch, taken.token));
    OpenUnit& opened = *open_.back();
    opened.keeps_data = has_room;
    for (const std::size_t cell : open_cells(unit)) {
      opened.waiting.push_back(opened.stages.run(unit, cell));
      if (published_.run(unit, cell).first_open_step() > 0)
        opened.place.fetch_run(plan_.cells[cell].name);
      count_out(-plan_.seconds[cell]);
    }
    count_out(unit.seconds);
    if (opened.waiting.empty()) close_finished();  // its last owner had just finished
  }

  /// Whether the measurements of one more dataset fit on the disk.
  bool has_room_for(const PlanUnit& unit) const {
    std::uint64_t held = 0, coming = 0;
    for (const auto& other : open_) {
      const std::uint64_t bytes = other->place.data_bytes(other->unit.dataset);
      if (other->keeps_data && bytes == 0) coming += other->unit.data_bytes;
      held += bytes;
    }
    if (options_.scratch_bytes) return held + coming + unit.data_bytes <= *options_.scratch_bytes;
    const fs::path& disk = options_.scratch.empty() ? study_ : options_.scratch;
    return coming + unit.data_bytes <= default_scratch_bytes(disk);
  }

  void poll(Slot& slot) {
    const auto end = slot.process->poll();
    if (!end) return;
    slot.process.reset();
    const bool done = end->exit_code == 0 || (end->exit_code == kWorkFailed &&
                                              fs::exists(slot.stage.steps[slot.step].product));
    const bool is_last = slot.step + 1 == slot.stage.steps.size();
    if (done && !is_last) {
      slot.stage.record(slot.step, 0.0);
      ++slot.step;
      return start_step(slot);
    }
    pass_on_warnings(slot.stage);
    const std::shared_ptr<OpenUnit> unit = std::move(slot.unit);
    --unit->running;
    if (!claims_.holds(unit->unit.dataset)) {
      log_.warn(unit->unit.dataset +
                " is worked on by another process, which took this one for dead");
      unit->waiting.clear();
      unit->has_flown = true;
    } else {
      finish(*unit, slot, done ? std::string() : end->reason);
    }
    close_finished();
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

  void close_finished() {
    std::erase_if(open_, [&](std::shared_ptr<OpenUnit>& unit) {
      if (!unit->waiting.empty() || unit->running > 0) return false;
      const std::string dataset = unit->unit.dataset;
      unit.reset();
      claims_.release(dataset);
      next_scan_ = Clock::now();
      return true;
    });
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
    weight_left_ -= stage.weight;
    ++done_.runs;
  }

  void log_time_left() {
    const double done = weight_of_all_ - weight_left_;
    if (done <= 0.0 || weight_left_ < 0.5) return;
    log_.info(fmt::format("{} runs done, about {:.0f} min left", done_.runs,
                          std::ceil(seconds_since(begin_) * weight_left_ / done / 60.0)));
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
  const fs::path study_;
  const StudyOptions& options_;
  LogSink& log_;
  Claims claims_;     // outlives the units, whose folders are deleted before their claims
  Stages published_;  // in the study's folder
  std::vector<std::shared_ptr<OpenUnit>> open_;
  std::vector<Slot> slots_;  // end before the folders that they work in
  std::deque<const PlanUnit*> todo_;
  Clock::time_point next_scan_ = Clock::now();
  bool has_scanned_ = false;  ///< since it was last asked whether the worker is finished
  double weight_of_all_ = 0.0, weight_left_ = 0.0;
  Clock::time_point begin_ = Clock::now();
  std::optional<Clock::time_point> stop_seen_;
  bool has_told_waiting_ = false;
  WorkDone done_;
};

}  // namespace

WorkDone work_on(const StudyPlan& plan, const ConfigFolder& configs, const fs::path& study,
                 const StudyOptions& options, LogSink& log) {
  return Runner(plan, configs, study, options, log).run();
}

}  // namespace lidarena::study
