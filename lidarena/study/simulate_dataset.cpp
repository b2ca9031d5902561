// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/simulate_dataset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>

#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/trajectories/tum.hpp"
#include "lidarena/evaluation/map/scored_returns.hpp"
#include "lidarena/flight/flight_config.hpp"
#include "lidarena/flight/make_flight.hpp"
#include "lidarena/scenes/load_world.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "lidarena/world/mesh_io.hpp"
#include "lidarena/world/ply.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

constexpr Time kTruthStep = std::chrono::milliseconds(1);

/// All objects that a simulation refers to, owned together.
struct Scene {
  world::WorldModel model;  ///< its mesh is moved into `world`
  std::unique_ptr<world::World> world;
  std::unique_ptr<flight::Flight> flight;
  std::vector<sensor::SensorConfig> sensors;
  sensor::SimulationOptions options;

  Time duration() const {
    return options.duration > Time{0} ? std::min(options.duration, flight->duration())
                                      : flight->duration();
  }
  std::size_t scan_count(const LidarInfo& lidar) const {
    return static_cast<std::size_t>(to_seconds(duration()) * lidar.rate_hz + 1e-6);
  }
};

std::unique_ptr<Scene> make_scene(world::WorldModel model, const fs::path& flight_file,
                                  std::vector<sensor::SensorConfig> sensors,
                                  const sensor::SimulationOptions& options, LogSink& log) {
  auto scene = std::make_unique<Scene>();
  scene->world = std::make_unique<world::World>(std::move(model.mesh), model.name);
  scene->model = std::move(model);
  scene->flight = flight::make_flight(flight_file, scene->model, *scene->world, log);
  scene->sensors = std::move(sensors);
  scene->options = options;
  return scene;
}

/// An event source that owns the scene it simulates.
class SimulatedSource : public dataset::EventSource {
 public:
  SimulatedSource(std::unique_ptr<Scene> scene, const Parallel& parallel)
      : scene_(std::move(scene)),
        events_(sensor::simulate(*scene_->world, *scene_->flight, scene_->sensors, scene_->options,
                                 parallel)) {}
  std::optional<dataset::Event> next() override { return events_->next(); }

 private:
  std::unique_ptr<Scene> scene_;
  std::unique_ptr<dataset::EventSource> events_;
};

/// Name, in a dataset, of the ray table of its n-th sensor.
std::string pattern_name(std::size_t sensor) { return fmt::format("pattern_{}.csv", sensor); }

Json manifest_of(const SimulateRequest& request, const Scene& scene) {
  Json routes = Json::array();
  for (const auto& route : scene.model.routes) routes.push_back(value_to_json(route));
  Json sensors = Json::array();
  for (sensor::SensorConfig sensor : scene.sensors) {
    if (!sensor.pattern_file.empty()) sensor.pattern_file = pattern_name(sensors.size());
    sensors.push_back(to_json(sensor));
  }
  return {{"kind", "dataset"},
          {"rig", to_json(sensor::make_rig(scene.sensors))},
          {"simulation",
           {{"world", request.world.filename().string()},
            {"flight", "flight" + request.flight.extension().string()},
            {"flight_source", request.flight.filename().string()},
            {"seed", request.seed},
            {"seconds", to_seconds(scene.duration())},
            {"noise", request.noise},
            {"sensors", sensors},
            {"routes", routes}}}};
}

/// Writes only the truth of the scored returns.
class ScoredTruthWriter : public dataset::ScanTruthSink {
 public:
  ScoredTruthWriter(dataset::ScanTruthSink& writer, std::size_t max_returns)
      : writer_(writer), max_returns_(max_returns) {}
  void write(const dataset::ScanTruth& truth) override {
    dataset::ScanTruth scored = truth;
    evaluation::keep_scored(scored.points, max_returns_);
    writer_.write(scored);
  }

 private:
  dataset::ScanTruthSink& writer_;
  std::size_t max_returns_;
};

void write_events(const SimulateRequest& request, const Scene& scene, const fs::path& out,
                  const Parallel& parallel, LogSink& log, SimulateSummary& summary) {
  dataset::DatasetWriter writer(out, sensor::make_rig(scene.sensors), request.write);
  Time truth_time{0};
  const auto write_truth_until = [&](Time end) {
    for (; truth_time <= end; truth_time += kTruthStep) {
      writer.write_truth({truth_time, scene.flight->pose_at(truth_time)});
    }
  };
  sensor::SimulationOptions options = scene.options;
  std::size_t scans = 0;
  for (const LidarInfo& lidar : sensor::make_rig(scene.sensors).lidars)
    scans = std::max(scans, scene.scan_count(lidar));
  const std::size_t max_returns = evaluation::scored_returns(scans);
  ScoredTruthWriter scored_writer(writer, max_returns);
  dataset::ScanTruthSink* sink = &writer;
  if (request.scored_only) sink = &scored_writer;
  options.truth = request.truth ? sink : nullptr;
  auto events = sensor::simulate(*scene.world, *scene.flight, scene.sensors, options, parallel);
  if (request.scored_only)
    events = std::make_unique<evaluation::ScoredEvents>(std::move(events), max_returns);
  while (const auto event = events->next()) {
    if (const auto* scan = std::get_if<Scan>(&event->data)) {
      ++summary.scans;
      summary.points += scan->points.size();
      write_truth_until(scan->stamp);
      log.progress("flying", to_seconds(scan->stamp), summary.seconds);
    } else {
      ++summary.imu_samples;
    }
    writer.write(*event);
  }
  write_truth_until(scene.duration());
  log.progress("flying", summary.seconds, summary.seconds);
  writer.finish(manifest_of(request, scene));
}

Trajectory truth_of(const Scene& scene) {
  std::vector<StampedPose> poses;
  for (Time t{0}; t <= scene.duration(); t += kTruthStep) {
    poses.push_back({t, scene.flight->pose_at(t)});
  }
  return Trajectory(std::move(poses));
}

void copy_over(const fs::path& from, const fs::path& to) {
  if (fs::exists(to) && fs::equivalent(from, to)) return;
  fs::create_directories(to.parent_path());
  fs::copy_file(from, to, fs::copy_options::overwrite_existing);
}

/// Copies the flight's file into the dataset, and the recording that it replays to the same
/// relative path, so that the dataset can be simulated again after it was moved.
void copy_flight(const fs::path& flight, const fs::path& out) {
  if (flight.extension() == ".yaml") {
    const fs::path replay = load_config<flight::FlightConfig>(flight).replay;
    if (replay.is_relative() && !replay.empty()) {
      if (*replay.lexically_normal().begin() == "..") {
        throw InputError(flight.string(), "replays a file above its own folder",
                         "put the recording beside the flight's file, or give its full path");
      }
      copy_over(flight.parent_path() / replay, out / replay);
    }
  }
  copy_over(flight, out / ("flight" + flight.extension().string()));
}

/// Copies the sensors' ray tables into the dataset, for the same reason.
void copy_patterns(const std::vector<sensor::SensorConfig>& sensors, const fs::path& out) {
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (!sensors[i].pattern_file.empty()) {
      copy_over(sensors[i].pattern_file, out / pattern_name(i));
    }
  }
}

double path_length(const Scene& scene) {
  double length = 0.0;
  Eigen::Vector3d last = scene.flight->pose_at(Time{0}).translation();
  for (Time t{0}; t <= scene.duration(); t += std::chrono::milliseconds(10)) {
    const Eigen::Vector3d here = scene.flight->pose_at(t).translation();
    length += (here - last).norm();
    last = here;
  }
  return length;
}

/// What the LiDAR `sensor` hits, found by simulating the flight again.
class SimulatedTruth : public dataset::ScanTruthSource, private dataset::ScanTruthSink {
 public:
  SimulatedTruth(std::string sensor, std::unique_ptr<Scene> scene, const Parallel& parallel)
      : sensor_(std::move(sensor)) {
    scene->options.truth = this;
    events_ = std::make_unique<SimulatedSource>(std::move(scene), parallel);
  }
  std::optional<dataset::ScanTruth> next() override {
    while (waiting_.empty() && events_->next()) {
    }
    if (waiting_.empty()) return std::nullopt;
    dataset::ScanTruth first = std::move(waiting_.front());
    waiting_.pop_front();
    return first;
  }

 private:
  void write(const dataset::ScanTruth& truth) override {
    if (truth.sensor_id == sensor_) waiting_.push_back(truth);
  }

  std::string sensor_;
  std::unique_ptr<dataset::EventSource> events_;
  std::deque<dataset::ScanTruth> waiting_;
};

std::unique_ptr<Scene> scene_of_manifest(const fs::path& folder, const Json& manifest) {
  LogSink silent;  // its messages were logged when the dataset was made
  const Json& simulation = manifest.at("simulation");
  world::WorldModel model;
  model.name = (folder / "world.ply").string();
  model.mesh = world::load_mesh(folder / "world.ply");
  const std::string place = (folder / "manifest.json").string();
  read_value(ConfigNode::parse(simulation.at("routes").dump(), place), model.routes, {});
  std::vector<sensor::SensorConfig> sensors;
  read_value(ConfigNode::parse(simulation.at("sensors").dump(), place), sensors, {});
  for (sensor::SensorConfig& s : sensors) {
    if (!s.pattern_file.empty()) s.pattern_file = (folder / s.pattern_file).string();
  }
  sensor::SimulationOptions options;
  options.seed = simulation.at("seed").get<std::uint64_t>();
  options.duration = from_seconds(simulation.at("seconds").get<double>());
  options.noise = simulation.at("noise").get<bool>();
  return make_scene(std::move(model), folder / simulation.at("flight").get<std::string>(),
                    std::move(sensors), options, silent);
}

/// The manifest of a dataset without measurements, which has to be simulated; null for any other.
Json manifest_to_simulate(const fs::path& folder) {
  const fs::path file = folder / "manifest.json";
  if (!fs::exists(file) || dataset::has_measurements(folder)) return nullptr;
  Json manifest = dataset::read_json(file);
  return manifest.contains("simulation") ? manifest : nullptr;
}

/// Opens a dataset without measurements; its events are simulated.
dataset::Dataset open_simulated(const fs::path& folder, const Json& manifest,
                                const std::string& sensor, const Parallel& parallel) {
  std::unique_ptr<Scene> scene = scene_of_manifest(folder, manifest);
  dataset::Dataset dataset;
  dataset.path = folder;
  dataset.rig = sensor::make_rig(scene->sensors);
  dataset.manifest = manifest;
  if (const LidarInfo* lidar = dataset.rig.find_lidar(sensor))
    dataset.scan_count = scene->scan_count(*lidar);
  dataset.events = std::make_unique<SimulatedSource>(std::move(scene), parallel);
  return dataset;
}

/// Where the scored returns of a dataset are: in its folder `scored`, else in the dataset itself.
fs::path scored_folder(const fs::path& dataset) {
  const fs::path folder = dataset / kScoredFolder;
  return fs::exists(folder / "manifest.json") ? folder : dataset;
}

}  // namespace

SimulateSummary simulate_dataset(const SimulateRequest& request, const fs::path& out,
                                 const Parallel& parallel, LogSink& log) {
  std::vector<sensor::SensorConfig> sensors;
  for (const fs::path& file : request.sensors) {
    sensors.push_back(sensor::load_sensor(file));
    if (request.mode) sensors.back().mode = *request.mode;
  }
  world::WorldModel model = scenes::load_world(request.world, {}, log);
  sensor::SimulationOptions options;
  options.seed = request.seed;
  options.duration = from_seconds(request.seconds);
  options.noise = request.noise;

  // The flight is checked before anything is written.
  const auto scene = make_scene(std::move(model), request.flight, std::move(sensors), options, log);
  if (request.seconds > 0 && options.duration > scene->flight->duration()) {
    log.warn(fmt::format("the flight ends after {:.1f} s; {:.1f} s were requested",
                         to_seconds(scene->flight->duration()), request.seconds));
  }
  SimulateSummary summary;
  summary.triangles = scene->world->mesh().triangles.size();
  summary.seconds = to_seconds(scene->duration());
  summary.path_m = path_length(*scene);

  fs::create_directories(out);
  // Files of an older dataset in this folder must not be taken for part of this one.
  for (const char* stale : {"manifest.json", "data.mcap", "metadata.yaml"}) fs::remove(out / stale);
  world::save_ply(out / "world.ply", scene->world->mesh());
  copy_flight(request.flight, out);
  copy_patterns(scene->sensors, out);
  if (request.data) {
    write_events(request, *scene, out, parallel, log, summary);
  } else {
    dataset::write_tum(out / "truth.tum", truth_of(*scene), dataset::kTruthHeader);
    dataset::write_json(out / "manifest.json", manifest_of(request, *scene));
  }
  return summary;
}

dataset::Dataset open_any_dataset(const fs::path& path, const dataset::ReadOptions& options,
                                  const Parallel& parallel) {
  const Json manifest = manifest_to_simulate(path);
  return manifest.is_null() ? dataset::open_dataset(path, options)
                            : open_simulated(path, manifest, options.sensor, parallel);
}

void write_scored_returns(const SimulateRequest& request, const fs::path& dataset,
                          const Parallel& parallel, LogSink& log) {
  SimulateRequest scored = request;
  scored.data = scored.truth = scored.scored_only = true;
  scored.write = {};
  simulate_dataset(scored, dataset / kScoredFolder, parallel, log);
}

dataset::Dataset open_scored_returns(const fs::path& dataset, const dataset::ReadOptions& options,
                                     const Parallel& parallel) {
  const fs::path place = scored_folder(dataset);
  dataset::Dataset scored = open_any_dataset(place, options, parallel);
  if (place != dataset) return scored;  // that folder holds scored returns only
  const std::size_t max_returns = evaluation::scored_returns(scored.scan_count.value_or(0));
  scored.events = std::make_unique<evaluation::ScoredEvents>(std::move(scored.events), max_returns);
  return scored;
}

std::unique_ptr<dataset::ScanTruthSource> open_scored_truth(const fs::path& dataset,
                                                            const std::string& sensor,
                                                            const Parallel& parallel) {
  const fs::path place = scored_folder(dataset);
  const Json manifest = manifest_to_simulate(place);
  std::unique_ptr<dataset::ScanTruthSource> truth =
      manifest.is_null()
          ? dataset::open_scan_truth(place, sensor)
          : std::make_unique<SimulatedTruth>(sensor, scene_of_manifest(place, manifest), parallel);
  if (!truth || place != dataset) return truth;
  dataset::ReadOptions options;
  options.sensor = sensor;
  const dataset::Dataset same = open_any_dataset(dataset, options, parallel);
  return std::make_unique<evaluation::ScoredTruth>(
      std::move(truth), evaluation::scored_returns(same.scan_count.value_or(0)));
}

}  // namespace lidarena::study
