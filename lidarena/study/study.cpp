// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "lidarena/study/isolate.hpp"
#include "lidarena/study/run_algorithm.hpp"
#include "lidarena/study/simulate_dataset.hpp"

namespace lidarena {
namespace {

namespace fs = std::filesystem;

/// NAME:PRESET into its parts; the preset defaults to the algorithm's default.
OdometryRequest parse_algorithm(const std::string& text) {
  OdometryRequest request;
  const std::size_t colon = text.find(':');
  request.algorithm = text.substr(0, colon);
  if (colon != std::string::npos) request.preset = text.substr(colon + 1);
  return request;
}

std::string stem(const std::string& name_or_path) { return fs::path(name_or_path).stem().string(); }

/// True when `file` exists and its member `key` equals `value`: the stage was done with the very
/// same request before.
bool done_before(const fs::path& file, const std::string& key, const Json& value) {
  if (!fs::exists(file)) return false;
  try {
    const Json json = read_json(file);
    return json.contains(key) && json.at(key) == value;
  } catch (const Error&) {
    return false;
  }
}

struct DatasetPlan {
  SimulateRequest request;
  Json key;  ///< what the dataset depends on, kept beside it as request.json
};

DatasetPlan dataset_plan(const PlannedRun& cell, const StudySpec& spec,
                         const ConfigFolder& configs) {
  DatasetPlan plan;
  plan.request.world = configs.resolve("worlds", cell.world);
  plan.request.flight = configs.resolve("flights", cell.flight);
  for (const std::string& sensor : spec.sensors) {
    plan.request.sensors.push_back(configs.resolve("sensors", sensor));
  }
  plan.request.seed = cell.seed;
  plan.request.data = false;  // flown anew for each run: no gigabytes on the disk
  for (const StudyScene& scene : spec.scenes) {
    if (scene.world == cell.world && scene.flight == cell.flight) {
      plan.request.seconds = scene.seconds;
    }
  }
  plan.key = {{"world", read_bytes(plan.request.world)},
              {"flight", read_bytes(plan.request.flight)},
              {"seed", cell.seed},
              {"seconds", plan.request.seconds},
              {"sensors", Json::array()}};
  for (const fs::path& file : plan.request.sensors) plan.key["sensors"].push_back(read_bytes(file));
  return plan;
}

/// The sensor's id in the dataset: ids follow the order of the sensors.
std::string lidar_id_of(const fs::path& dataset, const StudySpec& spec, const std::string& sensor) {
  const Json manifest = read_json(dataset / "manifest.json");
  for (std::size_t i = 0; i < spec.sensors.size(); ++i) {
    if (spec.sensors[i] == sensor) return manifest.at("rig").at("lidars").at(i).at("id");
  }
  return sensor;
}

void record_failure(const fs::path& run, const PlannedRun& cell, const std::string& reason) {
  fs::remove(run / "metrics.json");
  fs::create_directories(run);
  write_json(run / "manifest.json", {{"kind", "run"},
                                     {"algorithm", cell.algorithm},
                                     {"preset", cell.preset},
                                     {"failed", reason}});
}

enum class CellEnd { kDone, kReused, kFailed, kDiverged };

/// One study in progress: does its stages, each in a process of its own.
class Runner {
 public:
  Runner(const StudySpec& spec, const ConfigFolder& configs, fs::path out, int threads,
         LogSink& log)
      : spec_(spec), configs_(configs), out_(std::move(out)), threads_(threads), log_(log) {}

  CellEnd do_cell(const PlannedRun& cell) {
    const fs::path run = out_ / "runs" / cell.name;
    const DatasetPlan planned = dataset_plan(cell, spec_, configs_);
    std::string reason = fly(cell.dataset, planned);
    if (reason.empty()) {
      const Json key = {{"dataset", planned.key}, {"cell", to_json(cell)}};
      if (done_before(run / "request.json", "request", key)) return CellEnd::kReused;
      log_.info("run " + cell.name);
      reason = run_and_score(cell, run, key);
    }
    if (!reason.empty()) {
      record_failure(run, cell, reason);
      log_.warn(fmt::format("run {} failed: {}", cell.name, reason));
      return CellEnd::kFailed;
    }
    const Json manifest = read_json(run / "manifest.json");
    return manifest.at("summary").at("diverged").get<bool>() ? CellEnd::kDiverged : CellEnd::kDone;
  }

 private:
  /// Flies the dataset unless it is there; returns why it could not be flown, or nothing.
  std::string fly(const std::string& name, const DatasetPlan& planned) {
    const fs::path folder = out_ / "datasets" / name;
    if (broken_.contains(name)) return broken_[name];
    if (done_before(folder / "request.json", "request", planned.key)) return {};
    log_.info("flight " + name);
    const IsolatedOutcome flown = run_isolated([&] {
      simulate_dataset(planned.request, folder, Parallel(threads_), log_);
      write_json(folder / "request.json", {{"request", planned.key}});
    });
    if (flown.ok) return {};
    return broken_[name] = "flight: " + flown.reason;
  }

  std::string run_and_score(const PlannedRun& cell, const fs::path& run, const Json& key) {
    fs::remove(run / "request.json");
    return run_isolated([&] {
             const Parallel parallel(threads_);
             RunRequest request;
             request.odometry.algorithm = cell.algorithm;
             request.odometry.preset = cell.preset;
             request.dataset = out_ / "datasets" / cell.dataset;
             request.read.sensor = lidar_id_of(request.dataset, spec_, cell.sensor);
             run_algorithm(request, run, parallel, log_);
             score_run(run, parallel, log_);
             write_json(run / "request.json", {{"request", key}});
           })
        .reason;
  }

  const StudySpec& spec_;
  const ConfigFolder& configs_;
  fs::path out_;
  int threads_;
  LogSink& log_;
  std::map<std::string, std::string> broken_;  ///< datasets that could not be flown, and why
};

/// Throws InputError for an algorithm or preset that the factory does not list.
void check_algorithm(const OdometryRequest& request) {
  std::vector<std::string> names;
  for (const AlgorithmInfo& info : list_algorithms()) {
    names.push_back(info.name);
    if (info.name != request.algorithm) continue;
    const auto& presets = info.presets;
    if (std::find(presets.begin(), presets.end(), request.preset) != presets.end()) return;
    throw InputError(request.algorithm, "has no preset '" + request.preset + "'");
  }
  const std::string nearest = nearest_word(request.algorithm, names);
  throw InputError(
      request.algorithm, "is no algorithm of ours",
      nearest.empty() ? "see: lidarena list algorithms" : "did you mean '" + nearest + "'?");
}

}  // namespace

std::vector<PlannedRun> plan(const StudySpec& spec, const ConfigFolder& configs) {
  const auto need = [](bool there, const char* what) {
    if (!there) throw InputError("study", std::string("names no ") + what);
  };
  need(!spec.scenes.empty(), "scenes");
  need(!spec.sensors.empty(), "sensors");
  need(!spec.algorithms.empty(), "algorithms");
  need(!spec.seeds.empty(), "seeds");
  for (const std::string& sensor : spec.sensors) load_sensor(configs.resolve("sensors", sensor));
  for (const std::string& algorithm : spec.algorithms) check_algorithm(parse_algorithm(algorithm));

  std::vector<PlannedRun> cells;
  for (const StudyScene& scene : spec.scenes) {
    configs.resolve("worlds", scene.world);
    configs.resolve("flights", scene.flight);
    for (const std::uint64_t seed : spec.seeds) {
      const std::string dataset =
          fmt::format("{}-{}-s{}", stem(scene.world), stem(scene.flight), seed);
      for (const std::string& sensor : spec.sensors) {
        for (const std::string& algorithm : spec.algorithms) {
          const OdometryRequest request = parse_algorithm(algorithm);
          const std::string name =
              fmt::format("{}-{}-{}-{}", dataset, stem(sensor), request.algorithm, request.preset);
          cells.push_back({name, dataset, scene.world, scene.flight, sensor, request.algorithm,
                           request.preset, seed});
        }
      }
    }
  }
  return cells;
}

StudyOutcome run_study(const StudySpec& spec, const ConfigFolder& configs, const fs::path& out,
                       int threads, LogSink& log) {
  const std::vector<PlannedRun> cells = plan(spec, configs);
  fs::create_directories(out);
  write_json(out / "study.json",
             {{"kind", "study"}, {"spec", to_json(spec)}, {"runs", value_to_json(cells)}});
  Runner runner(spec, configs, out, threads, log);
  StudyOutcome outcome;
  for (const PlannedRun& cell : cells) {
    log.progress("study", static_cast<double>(outcome.runs), static_cast<double>(cells.size()));
    const CellEnd end = runner.do_cell(cell);
    ++outcome.runs;
    outcome.reused += end == CellEnd::kReused ? 1 : 0;
    outcome.failed += end == CellEnd::kFailed ? 1 : 0;
    outcome.diverged += end == CellEnd::kDiverged ? 1 : 0;
  }
  log.progress("study", static_cast<double>(cells.size()), static_cast<double>(cells.size()));
  return outcome;
}

}  // namespace lidarena
