// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/simulate_dataset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "lidarena/dataset/dataset_store.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/recording.hpp"
#include "lidarena/dataset/trajectories/tum.hpp"
#include "lidarena/dataset/whole_part.hpp"
#include "lidarena/evaluation/map/scored_returns.hpp"
#include "lidarena/flight/flight_config.hpp"
#include "lidarena/flight/make_flight.hpp"
#include "lidarena/scenes/drawn_scene.hpp"
#include "lidarena/scenes/load_world.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "lidarena/study/read_ahead.hpp"
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
                                  const sensor::SimulationOptions& options,
                                  std::optional<std::uint64_t> gust_seed, LogSink& log) {
  auto scene = std::make_unique<Scene>();
  scene->world = std::make_unique<world::World>(std::move(model.mesh), model.name);
  scene->model = std::move(model);
  scene->flight = flight::make_flight(flight_file, scene->model, *scene->world, log, gust_seed);
  scene->sensors = std::move(sensors);
  scene->options = options;
  return scene;
}

/// An event source that owns the scene it simulates, and what the simulation tells the truth to.
class SimulatedSource : public dataset::EventSource {
 public:
  SimulatedSource(std::unique_ptr<Scene> scene, std::unique_ptr<dataset::ScanTruthSink> truth,
                  const Parallel& parallel)
      : scene_(std::move(scene)),
        truth_(std::move(truth)),
        events_(sensor::simulate(*scene_->world, *scene_->flight, scene_->sensors, scene_->options,
                                 parallel)) {}
  std::optional<dataset::Event> next() override { return events_->next(); }

 private:
  std::unique_ptr<Scene> scene_;
  std::unique_ptr<dataset::ScanTruthSink> truth_;
  std::unique_ptr<dataset::EventSource> events_;
};

/// Name, in a dataset, of the ray table of its n-th sensor.
std::string pattern_name(std::size_t sensor) { return fmt::format("pattern_{}.csv", sensor); }

Json manifest_of(const SimulateRequest& request, const Scene& scene) {
  Json routes = Json::array();
  for (const auto& route : scene.model.routes) routes.push_back(value_to_json(route));
  Json sensors = Json::array(), sensor_sources = Json::array();
  for (const fs::path& file : request.sensors) sensor_sources.push_back(file.filename().string());
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
            {"new_scene", request.new_scene},
            {"seconds", to_seconds(scene.duration())},
            {"noise", request.noise},
            {"mode", value_to_json(request.mode)},
            {"allow_missing", request.allow_missing},
            {"sensor_sources", sensor_sources},
            {"sensors", sensors},
            {"routes", routes}}}};
}

/// Passes on the truth of the scored returns.
class ScoredTruth : public dataset::ScanTruthSink {
 public:
  ScoredTruth(const Scene& scene, std::function<void(const dataset::ScanTruth&)> pass_on)
      : pass_on_(std::move(pass_on)) {
    for (const LidarInfo& lidar : sensor::make_rig(scene.sensors).lidars)
      max_returns_[lidar.id] = evaluation::scored_returns(scene.scan_count(lidar));
  }
  void write(const dataset::ScanTruth& truth) override {
    dataset::ScanTruth scored = truth;
    evaluation::keep_scored(scored.points, max_returns_.at(truth.sensor_id));
    pass_on_(scored);
  }

 private:
  std::function<void(const dataset::ScanTruth&)> pass_on_;
  std::map<std::string, std::size_t> max_returns_;  ///< by LiDAR
};

/// Events with only the scored returns, up to `max_count` of each scan.
class ScoredReturns : public dataset::EventSource {
 public:
  ScoredReturns(std::unique_ptr<dataset::EventSource> source, std::size_t max_count)
      : source_(std::move(source)), max_count_(max_count) {}
  std::optional<dataset::Event> next() override {
    std::optional<dataset::Event> event = source_->next();
    auto* scan = event ? std::get_if<Scan>(&event->data) : nullptr;
    if (scan != nullptr) evaluation::keep_scored(scan->points, max_count_);
    return event;
  }

 private:
  std::unique_ptr<dataset::EventSource> source_;
  std::size_t max_count_;
};

Time end_of_measurement(const dataset::Event& event) {
  const auto* scan = std::get_if<Scan>(&event.data);
  return scan != nullptr ? end_of(*scan) : std::get<ImuSample>(event.data).stamp;
}

/// Gives the truth and the measurements to `writer` in the order of their times.
template <class Writer>
void give_events(const SimulateRequest& request, const Scene& scene, dataset::EventSource& events,
                 Writer& writer, LogSink& log, SimulateSummary& summary) {
  Time truth_time{0};
  const auto write_truth_until = [&](Time end) {
    for (; truth_time <= end; truth_time += kTruthStep) {
      writer.write_truth({truth_time, scene.flight->pose_at(truth_time)});
    }
  };
  const auto stopped = [&] { return request.stopped && request.stopped(); };
  while (const auto event = events.next()) {
    // Before the event, so that all messages stand in the order of their times.
    write_truth_until(end_of_measurement(*event));
    if (stopped()) return;
    if (const auto* scan = std::get_if<Scan>(&event->data)) {
      ++summary.scans;
      summary.points += scan->points.size();
      log.progress("flying", to_seconds(scan->stamp), summary.seconds);
    } else {
      ++summary.imu_samples;
    }
    writer.write(*event);
  }
  write_truth_until(scene.duration());
  log.progress("flying", summary.seconds, summary.seconds);
}

void write_events(const SimulateRequest& request, const Scene& scene, const fs::path& out,
                  const Parallel& parallel, LogSink& log, SimulateSummary& summary) {
  dataset::DatasetWriter writer(out, sensor::make_rig(scene.sensors), request.write);
  sensor::SimulationOptions options = scene.options;
  ScoredTruth scored(scene, [&](const dataset::ScanTruth& truth) { writer.write(truth); });
  if (request.truth) {
    options.truth = &writer;
  } else if (request.scored_truth) {
    options.truth = &scored;
  }
  const auto events =
      sensor::simulate(*scene.world, *scene.flight, scene.sensors, options, parallel);
  give_events(request, scene, *events, writer, log, summary);
  writer.finish(manifest_of(request, scene));
}

/// A store, with the functions of a DatasetWriter.
class StoreWriter {
 public:
  explicit StoreWriter(std::unique_ptr<dataset::DatasetStore> store) : store_(std::move(store)) {}
  void write_truth(const StampedPose& pose) { store_->write_truth(pose); }
  void write(const dataset::Event& event) {
    std::visit([&](const auto& data) { store_->write(event.sensor_id, data); }, event.data);
  }

 private:
  std::unique_ptr<dataset::DatasetStore> store_;
};

/// Simulates ahead of what is published, so that a scan that takes long does not delay others.
void publish_events(const SimulateRequest& request, const Scene& scene, const Parallel& parallel,
                    LogSink& log, SimulateSummary& summary) {
  StoreWriter writer(
      dataset::make_message_store(request.live, sensor::make_rig(scene.sensors), request.write));
  ReadAhead events(
      sensor::simulate(*scene.world, *scene.flight, scene.sensors, scene.options, parallel));
  give_events(request, scene, events, writer, log, summary);
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
  std::optional<std::uint64_t> gust_seed;  // the routes in the manifest are those that were drawn
  if (simulation.value("new_scene", false)) gust_seed = options.seed;
  return make_scene(std::move(model), folder / simulation.at("flight").get<std::string>(),
                    std::move(sensors), options, gust_seed, silent);
}

/// The manifest of a dataset without measurements, which has to be simulated; null for any other.
Json manifest_to_simulate(const fs::path& folder) {
  const fs::path file = folder / "manifest.json";
  if (!fs::exists(file) || dataset::has_measurements(folder)) return nullptr;
  Json manifest = dataset::read_json(file);
  return manifest.contains("simulation") ? manifest : nullptr;
}

/// Opens a dataset without measurements; its events are simulated (only `sensor` of its LiDARs, if
/// named), and so is the truth of the scored returns if `hits` is given.
dataset::Dataset open_simulated(const fs::path& folder, const Json& manifest,
                                const std::string& sensor, const Parallel& parallel,
                                ScoredHits* hits = nullptr) {
  std::unique_ptr<Scene> scene = scene_of_manifest(folder, manifest);
  dataset::Dataset dataset;
  dataset.path = folder;
  dataset.rig = sensor::make_rig(scene->sensors);
  dataset.manifest = manifest;
  const LidarInfo* lidar = dataset.rig.find_lidar(sensor);
  if (lidar != nullptr) {
    scene->options.lidar = lidar->id;
    dataset.scan_count = scene->scan_count(*lidar);
  }
  std::unique_ptr<ScoredTruth> truth;
  if (hits != nullptr && lidar != nullptr) {
    hits->known = true;
    truth = std::make_unique<ScoredTruth>(
        *scene, [hits](const dataset::ScanTruth& scored) { hits->scans.push_back(scored); });
    scene->options.truth = truth.get();
  }
  dataset.events = std::make_unique<SimulatedSource>(std::move(scene), std::move(truth), parallel);
  return dataset;
}

/// Reads what the scored returns hit from a dataset that contains it.
ScoredHits recorded_hits(const fs::path& dataset, const std::string& sensor,
                         std::size_t max_returns) {
  ScoredHits hits;
  const auto source = dataset::open_scan_truth(dataset, sensor);
  if (!source) return hits;
  hits.known = true;
  while (auto truth = source->next()) {
    evaluation::keep_scored(truth->points, max_returns);
    hits.scans.push_back(*std::move(truth));
  }
  return hits;
}

}  // namespace

SimulateSummary simulate_dataset(const SimulateRequest& request, const fs::path& out,
                                 const Parallel& parallel, LogSink& log) {
  std::vector<sensor::SensorConfig> sensors;
  for (const fs::path& file : request.sensors) {
    sensors.push_back(sensor::load_sensor(file, request.shipped_sensors));
    if (request.mode) sensors.back().mode = *request.mode;
  }
  std::optional<std::uint64_t> scene_seed;
  if (request.new_scene) scene_seed = request.seed;
  scenes::WorldOptions world;
  world.seed = scene_seed;
  world.allow_missing = request.allow_missing;
  world::WorldModel model = scenes::load_world(request.world, world, log);
  if (request.new_scene)
    for (auto& route : model.routes) route = scenes::drawn_route(route, request.seed);
  sensor::SimulationOptions options;
  options.seed = request.seed;
  options.duration = from_seconds(request.seconds);
  options.noise = request.noise;

  // The flight is checked before anything is written.
  const auto scene =
      make_scene(std::move(model), request.flight, std::move(sensors), options, scene_seed, log);
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
  if (request.data && !request.live) {
    write_events(request, *scene, out, parallel, log, summary);
  } else {
    dataset::write_tum(out / "truth.tum", truth_of(*scene), dataset::kTruthHeader);
    dataset::write_json(out / "manifest.json", manifest_of(request, *scene));
  }
  if (request.live) publish_events(request, *scene, parallel, log, summary);
  return summary;
}

dataset::Dataset open_any_dataset(const fs::path& path, const dataset::ReadOptions& options,
                                  const Parallel& parallel) {
  const Json manifest = manifest_to_simulate(path);
  return manifest.is_null() ? dataset::open_dataset(path, options)
                            : open_simulated(path, manifest, options.sensor, parallel);
}

dataset::Dataset open_scored_returns(const fs::path& dataset, const dataset::ReadOptions& options,
                                     const Parallel& parallel, ScoredHits* hits) {
  const Json manifest = manifest_to_simulate(dataset);
  const bool recorded = manifest.is_null();
  dataset::Dataset scored = recorded
                                ? dataset::open_dataset(dataset, options)
                                : open_simulated(dataset, manifest, options.sensor, parallel, hits);
  dataset::read_whole_part(scored);
  const std::size_t max_returns = evaluation::scored_returns(scored.scan_count.value_or(0));
  scored.events = std::make_unique<ScoredReturns>(std::move(scored.events), max_returns);
  if (recorded && hits != nullptr) *hits = recorded_hits(dataset, options.sensor, max_returns);
  return scored;
}

}  // namespace lidarena::study
