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
#include <map>
#include <memory>
#include <set>
#include <thread>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/md5.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "lidarena/study/example_scan.hpp"
#include "lidarena/study/isolate.hpp"
#include "lidarena/study/run_algorithm.hpp"
#include "lidarena/study/run_external.hpp"
#include "lidarena/study/simulate_dataset.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRequest = "request.json";  ///< the request of a finished stage
constexpr auto kPollPeriod = std::chrono::milliseconds(50);

std::string digest_of(const fs::path& file) { return dataset::md5_of(dataset::read_bytes(file)); }

/// True if the stage in `folder` is complete and answers exactly this request.
bool is_complete(const fs::path& folder, const Json& request) {
  if (!fs::exists(folder / kRequest)) return false;
  try {
    return dataset::read_json(folder / kRequest) == request;
  } catch (const Error&) {
    return false;
  }
}

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

 private:
  /// Retries for 2 s: the processes of a study that was just killed take a moment to end.
  bool lock_within_seconds() const {
    for (int attempt = 0; attempt < 40; ++attempt) {
      if (flock(fd_, LOCK_EX | LOCK_NB) == 0) return true;
      std::this_thread::sleep_for(kPollPeriod);
    }
    return false;
  }

  int fd_ = -1;
};

/// Passes on messages but no progress: the progress lines of several jobs would be mixed up.
class MessagesOnly : public LogSink {
 public:
  explicit MessagesOnly(LogSink& log) : log_(log) {}
  void message(LogLevel level, std::string_view text) override { log_.message(level, text); }

 private:
  LogSink& log_;
};

struct DatasetPlan {
  SimulateRequest request;
  Json key;  ///< all that the dataset depends on
};

DatasetPlan dataset_plan(const PlannedRun& cell, const StudySpec& spec, const ConfigFolder& configs,
                         const std::string& program) {
  DatasetPlan plan;
  plan.request.world = configs.resolve("worlds", cell.world);
  plan.request.flight = configs.resolve("flights", cell.flight);
  for (const std::string& sensor : spec.sensors) {
    plan.request.sensors.push_back(configs.resolve("sensors", sensor));
  }
  plan.request.seed = cell.seed;
  plan.request.seconds = cell.seconds;
  plan.request.mode = cell.mode;
  plan.request.data = false;  // simulated again for each run, to save gigabytes of disk space
  plan.key = {{"program", program},
              {"world", digest_of(plan.request.world)},
              {"flight", digest_of(plan.request.flight)},
              {"sensors", Json::array()},
              {"seed", cell.seed},
              {"seconds", cell.seconds},
              {"mode", value_to_json(cell.mode)}};
  for (const fs::path& file : plan.request.sensors) plan.key["sensors"].push_back(digest_of(file));
  return plan;
}

/// The sensor's id in the dataset, whose LiDARs are in the order of the study's sensors.
std::string lidar_id_of(const fs::path& dataset, const StudySpec& spec, const std::string& sensor) {
  const Json manifest = dataset::read_json(dataset / "manifest.json");
  for (std::size_t i = 0; i < spec.sensors.size(); ++i) {
    if (spec.sensors[i] == sensor) return manifest.at("rig").at("lidars").at(i).at("id");
  }
  return sensor;
}

void record_failure(const fs::path& run, const PlannedRun& cell, const std::string& reason) {
  fs::create_directories(run);
  for (const auto& entry : fs::directory_iterator(run)) {
    if (entry.path().filename() != kProgramLog) fs::remove_all(entry.path());
  }
  dataset::write_json(run / "manifest.json", {{"kind", "run"},
                                              {"algorithm", cell.algorithm},
                                              {"preset", cell.preset},
                                              {"failed", reason}});
}

/// One stage of the study: planning a flight, writing its returns for scoring, or running and
/// scoring a cell.
struct Stage {
  std::string name;
  const PlannedRun* cell = nullptr;   ///< null for a flight or its returns
  bool needed_by_cells_only = false;  ///< skipped once all cells of the dataset are done
  std::string dataset;
  fs::path folder;
  Json key;
  std::function<void(const Parallel&, LogSink&)> work;
  double weight = 1.0;  ///< expected seconds
};

/// Runs one study: starts the stages in order, each in its own process, once its flight is planned.
class Runner {
 public:
  Runner(const StudySpec& spec, const ConfigFolder& configs, fs::path out,
         const StudyOptions& options, LogSink& log)
      : spec_(spec), configs_(configs), out_(std::move(out)), log_(log) {
    const std::vector<int> cores = usable_cores();
    const int jobs = std::max(1, options.jobs);
    const int threads = options.threads > 0 ? options.threads : static_cast<int>(cores.size());
    for (int job = 0; job < jobs; ++job) {
      Slot& slot = slots_.emplace_back();
      slot.threads = std::max(1, threads / jobs);
      if (jobs == 1) continue;
      for (int i = 0; i < slot.threads; ++i) {
        slot.cores.push_back(
            cores[static_cast<std::size_t>(job * slot.threads + i) % cores.size()]);
      }
    }
  }

  StudyOutcome run(const std::vector<PlannedRun>& cells) {
    add_stages(cells);
    begin_ = std::chrono::steady_clock::now();
    while (!waiting_.empty() || is_busy()) {
      for (Slot& slot : slots_) {
        if (!slot.work) start_next(slot);
        if (slot.work) poll_slot(slot);
      }
      show_progress();
      if (is_busy()) std::this_thread::sleep_for(kPollPeriod);
    }
    return outcome_;
  }

 private:
  struct Slot {
    int threads = 1;
    std::vector<int> cores;
    std::unique_ptr<IsolatedWork> work;
    Stage stage;
  };

  void add_stages(const std::vector<PlannedRun>& cells) {
    const std::string program = digest_of("/proc/self/exe");
    std::set<std::string> flights;
    for (const PlannedRun& cell : cells) {
      const DatasetPlan planned = dataset_plan(cell, spec_, configs_, program);
      if (flights.insert(cell.dataset).second) {
        waiting_.push_back(flight_stage(cell, planned));
        waiting_.push_back(returns_stage(cell, planned));
      }
      waiting_.push_back(cell_stage(cell, planned));
    }
    for (const Stage& stage : waiting_) weight_of_all_ += stage.weight;
    weight_left_ = weight_of_all_;
    cells_ = cells.size();
  }

  Stage flight_stage(const PlannedRun& cell, const DatasetPlan& planned) const {
    Stage stage;
    stage.name = "flight " + cell.dataset;
    stage.dataset = cell.dataset;
    stage.folder = out_ / "datasets" / cell.dataset;
    stage.key = planned.key;
    stage.work = [request = planned.request, folder = stage.folder](const Parallel& parallel,
                                                                    LogSink& log) {
      simulate_dataset(request, folder, parallel, log);
    };
    return stage;
  }

  Stage returns_stage(const PlannedRun& cell, const DatasetPlan& planned) const {
    Stage stage;
    stage.name = "returns " + cell.dataset;
    stage.dataset = cell.dataset;
    stage.needed_by_cells_only = true;
    stage.folder = out_ / "datasets" / cell.dataset / kScoredFolder;
    stage.key = planned.key;
    stage.work = [request = planned.request, dataset = stage.folder.parent_path()](
                     const Parallel& parallel, LogSink& log) {
      write_scored_returns(request, dataset, parallel, log);
      write_example_scans(dataset, parallel);
    };
    return stage;
  }

  Stage cell_stage(const PlannedRun& cell, const DatasetPlan& planned) const {
    Stage stage;
    stage.name = "run " + cell.name;
    stage.cell = &cell;
    stage.dataset = cell.dataset;
    stage.folder = out_ / "runs" / cell.name;
    stage.key = {{"dataset", planned.key}, {"cell", to_json(cell)}};
    stage.weight = estimate(cell, configs_).seconds;
    const ExternalProgram* external = find_external(spec_, cell.algorithm);
    if (external != nullptr) stage.key["external"] = to_json(*external);
    if (!spec_.keep_maps) stage.key["keep_maps"] = false;
    stage.work = [this, &cell, external, folder = stage.folder](const Parallel& parallel,
                                                                LogSink& log) {
      RunRequest request;
      request.odometry.algorithm = cell.algorithm;
      request.odometry.preset = cell.preset;
      request.dataset = out_ / "datasets" / cell.dataset;
      request.read.sensor = lidar_id_of(request.dataset, spec_, cell.sensor);
      if (external != nullptr) {
        run_external(*external, request, folder, parallel, log);
      } else {
        run_algorithm(request, folder, parallel, log);
      }
      score_run(folder, parallel, log);
      if (!spec_.keep_maps) remove_maps(folder);
    };
    return stage;
  }

  bool is_busy() const {
    return std::ranges::any_of(slots_, [](const Slot& slot) { return slot.work != nullptr; });
  }

  bool is_being_prepared(const std::string& dataset) const {
    return std::ranges::any_of(slots_, [&](const Slot& slot) {
      return slot.work && slot.stage.cell == nullptr && slot.stage.dataset == dataset;
    });
  }

  /// Whether a cell of the dataset is waiting that is not complete.
  bool has_pending_cells(const std::string& dataset) const {
    return std::ranges::any_of(waiting_, [&](const Stage& stage) {
      return stage.cell != nullptr && stage.dataset == dataset &&
             !is_complete(stage.folder, stage.key);
    });
  }

  bool is_in_progress(const std::string& dataset) const {
    return std::ranges::any_of(slots_, [&](const Slot& slot) {
      return slot.work != nullptr && slot.stage.dataset == dataset;
    });
  }

  /// Takes stages from the queue until one has work to do, and starts that one.
  void start_next(Slot& slot) {
    while (true) {
      const auto next = std::ranges::find_if(
          waiting_, [&](const Stage& stage) { return !is_being_prepared(stage.dataset); });
      if (next == waiting_.end()) return;
      slot.stage = std::move(*next);
      waiting_.erase(next);
      const Stage& stage = slot.stage;
      if (failed_flights_.contains(stage.dataset)) {
        finish(stage, failed_flights_[stage.dataset]);
      } else if (stage.needed_by_cells_only && !has_pending_cells(stage.dataset)) {
        finish(stage, {});
      } else if (is_complete(stage.folder, stage.key)) {
        outcome_.reused += stage.cell != nullptr ? 1 : 0;
        weight_of_all_ -= stage.weight;  // its time says nothing about the others
        finish(stage, {});
      } else {
        start(slot);
        return;
      }
    }
  }

  void start(Slot& slot) {
    const Stage& stage = slot.stage;
    log_.info(stage.name);
    fs::remove_all(stage.folder);
    const int threads = slot.threads;
    const bool alone = slots_.size() == 1;
    const WorkLimits limits{60.0 * spec_.limits.minutes, spec_.limits.memory_mb,
                            spec_.limits.stall_seconds};
    slot.work = std::make_unique<IsolatedWork>(
        [&stage, &log = log_, threads, alone] {
          MessagesOnly messages(log);
          stage.work(Parallel(threads), alone ? log : static_cast<LogSink&>(messages));
          dataset::write_json(stage.folder / kRequest, stage.key);
        },
        limits, slot.cores);
  }

  void poll_slot(Slot& slot) {
    const auto outcome = slot.work->poll();
    if (!outcome) return;
    slot.work.reset();
    finish(slot.stage, outcome->reason);
    if (slot.stage.cell != nullptr) log_time_left();
  }

  void log_time_left() {
    const double done = weight_of_all_ - weight_left_;
    if (done <= 0.0 || outcome_.runs == cells_) return;
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
    log_.info(fmt::format("{} of {} runs done, about {:.0f} min left", outcome_.runs, cells_,
                          std::ceil(elapsed.count() * weight_left_ / done / 60.0)));
  }

  void finish(const Stage& stage, const std::string& reason) {
    weight_left_ -= stage.weight;
    if (stage.cell == nullptr) {
      if (!reason.empty() && stage.needed_by_cells_only) {
        log_.warn(
            fmt::format("{} failed ({}): simulating again for each scoring", stage.name, reason));
        fs::remove_all(stage.folder);
      } else if (!reason.empty()) {
        failed_flights_[stage.dataset] = "flight: " + reason;
      }
      return;
    }
    ++outcome_.runs;
    if (!is_in_progress(stage.dataset) && !has_pending_cells(stage.dataset)) {
      fs::remove_all(out_ / "datasets" / stage.dataset / kScoredFolder);
    }
    if (!reason.empty()) {
      record_failure(stage.folder, *stage.cell, reason);
      log_.warn(fmt::format("{} failed: {}", stage.name, reason));
      ++outcome_.failed;
      return;
    }
    const Json manifest = dataset::read_json(stage.folder / "manifest.json");
    outcome_.diverged += manifest.at("summary").at("diverged").get<bool>() ? 1 : 0;
  }

  /// Shows the study's progress; with one job only between stages, since a stage shows its own.
  void show_progress() {
    if (slots_.size() == 1 && is_busy()) return;
    const double done = weight_of_all_ - weight_left_;
    log_.progress("study", done, weight_of_all_);
  }

  const StudySpec& spec_;
  const ConfigFolder& configs_;
  fs::path out_;
  LogSink& log_;
  std::vector<Slot> slots_;
  std::vector<Stage> waiting_;
  std::map<std::string, std::string> failed_flights_;  ///< datasets whose flight failed, and why
  double weight_of_all_ = 0.0, weight_left_ = 0.0;
  std::size_t cells_ = 0;
  std::chrono::steady_clock::time_point begin_;
  StudyOutcome outcome_;
};

}  // namespace

StudyOutcome run_study(const StudySpec& spec, const ConfigFolder& configs, const fs::path& out,
                       const StudyOptions& options, LogSink& log) {
  const std::vector<PlannedRun> cells = cells_of_shard(plan(spec, configs), options.shard, configs);
  fs::create_directories(out);
  const FolderLock lock(out);
  dataset::write_json(out / "study.json",
                      {{"kind", "study"}, {"spec", to_json(spec)}, {"runs", value_to_json(cells)}});
  return Runner(spec, configs, out, options, log).run(cells);
}

}  // namespace lidarena::study
