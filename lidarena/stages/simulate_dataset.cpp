// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/simulate_dataset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "lidarena/dataset/dataset_manifest.hpp"
#include "lidarena/dataset/dataset_store.hpp"
#include "lidarena/dataset/hits_file.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/recording.hpp"
#include "lidarena/dataset/trajectories/tum.hpp"
#include "lidarena/evaluation/map/scored_returns.hpp"
#include "lidarena/flight/make_flight.hpp"
#include "lidarena/flight/people.hpp"
#include "lidarena/scenes/drawn_scene.hpp"
#include "lidarena/scenes/load_world.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "lidarena/stages/read_ahead.hpp"
#include "lidarena/stages/scene_settings.hpp"
#include "lidarena/stages/semantic_labels.hpp"
#include "lidarena/world/living_world.hpp"
#include "lidarena/world/mesh_io.hpp"
#include "lidarena/world/ply.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::stages {
namespace {

namespace fs = std::filesystem;

constexpr Time kTruthStep = std::chrono::milliseconds(1);

/// All objects that a simulation refers to, owned together.
struct Scene {
  world::WorldModel model;  ///< its mesh is moved into `world`
  std::unique_ptr<world::World> world;
  std::unique_ptr<flight::Flight> flight;
  std::unique_ptr<world::LivingWorld> living;  ///< null if nothing moves
  std::vector<sensor::SensorConfig> sensors;
  sensor::SimulationOptions options;

  const world::Surfaces& surfaces() const {
    return living ? static_cast<const world::Surfaces&>(*living) : *world;
  }
  Time duration() const {
    return options.duration > Time{0} ? std::min(options.duration, flight->duration())
                                      : flight->duration();
  }
  std::size_t scan_count(const LidarInfo& lidar) const {
    return static_cast<std::size_t>(to_seconds(duration()) * lidar.rate_hz + 1e-6);
  }
};

/// Draws the world's people and adds all movers to the scene. The seed of the noise draws the
/// people: the same building has others in each flight.
void add_movers(Scene& scene, LogSink& log) {
  std::vector<world::MoverConfig>& movers = scene.model.movers;
  if (scene.model.people > 0) {
    const auto people =
        flight::draw_people(*scene.world, *scene.flight, scene.model.people, scene.options.seed);
    if (static_cast<int>(people.size()) < scene.model.people) {
      log.warn(fmt::format("free floor was found for {} of {} people", people.size(),
                           scene.model.people));
    }
    movers.insert(movers.end(), people.begin(), people.end());
  }
  if (!movers.empty()) scene.living = std::make_unique<world::LivingWorld>(*scene.world, movers);
}

std::unique_ptr<Scene> make_scene(world::WorldModel model, const fs::path& flight_file,
                                  std::vector<sensor::SensorConfig> sensors,
                                  const sensor::SimulationOptions& options,
                                  std::optional<std::uint64_t> gust_seed,
                                  const std::vector<std::string>& flight_settings, LogSink& log) {
  auto scene = std::make_unique<Scene>();
  scene->world = std::make_unique<world::World>(std::move(model.mesh), model.name);
  scene->model = std::move(model);
  scene->flight = flight::make_flight(flight_file, scene->model, *scene->world, log, gust_seed,
                                      flight_settings);
  scene->sensors = std::move(sensors);
  scene->options = options;
  add_movers(*scene, log);
  return scene;
}

/// An event source that owns the scene it simulates.
class SimulatedSource : public EventSource {
 public:
  SimulatedSource(std::unique_ptr<Scene> scene, const Parallel& parallel)
      : scene_(std::move(scene)),
        events_(sensor::simulate(scene_->surfaces(), *scene_->flight, scene_->sensors,
                                 scene_->options, parallel)) {}
  std::optional<Event> next() override { return events_->next(); }

 private:
  std::unique_ptr<Scene> scene_;
  std::unique_ptr<EventSource> events_;
};

/// The truth of the points of one LiDAR of a scene, which it owns.
class SimulatedTruth : public ScanTruthSource {
 public:
  SimulatedTruth(std::unique_ptr<Scene> scene, const Parallel& parallel)
      : scene_(std::move(scene)) {
    scene_->options.truth = &latest_;
    events_ = sensor::simulate(scene_->surfaces(), *scene_->flight, scene_->sensors,
                               scene_->options, parallel);
  }
  std::optional<ScanTruth> next() override {
    latest_.scan.reset();
    while (!latest_.scan && events_->next()) {
    }
    return latest_.scan;
  }

 private:
  struct Latest : ScanTruthSink {
    void write(const ScanTruth& truth) override { scan = truth; }
    std::optional<ScanTruth> scan;
  };

  std::unique_ptr<Scene> scene_;
  Latest latest_;
  std::unique_ptr<EventSource> events_;
};

/// Name, in a dataset, of the ray table of its n-th sensor.
std::string pattern_name(std::size_t sensor) { return fmt::format("pattern_{}.csv", sensor); }

dataset::DatasetManifest manifest_of(const SimulateRequest& request, const Scene& scene) {
  dataset::DatasetManifest manifest;
  manifest.rig = sensor::make_rig(scene.sensors);
  dataset::SimulationRecord& record = manifest.simulation.emplace();
  record.world = request.world.filename().string();
  record.flight = "flight" + request.flight.extension().string();
  record.flight_source = request.flight.filename().string();
  record.seed = request.seed;
  record.new_scene = request.new_scene;
  record.seconds = to_seconds(scene.duration());
  record.noise = request.noise;
  if (request.mode) record.mode = value_to_json(*request.mode).get<std::string>();
  record.allow_missing = request.allow_missing;
  record.set = request.set;
  for (const fs::path& file : request.sensors)
    record.sensor_sources.push_back(file.filename().string());
  for (sensor::SensorConfig sensor : scene.sensors) {
    if (!sensor.pattern_file.empty()) sensor.pattern_file = pattern_name(record.sensors.size());
    record.sensors.push_back(to_json(sensor));
  }
  record.routes = Json::array();
  for (const auto& route : scene.model.routes) record.routes.push_back(value_to_json(route));
  for (const auto& mover : scene.model.movers) record.movers.push_back(to_json(mover));
  return manifest;
}

/// Gives the truth of all returns to one sink and that of the scored ones to another; either may be
/// null.
class TruthSinks : public ScanTruthSink {
 public:
  TruthSinks(const Scene& scene, ScanTruthSink* all, ScanTruthSink* scored)
      : all_(all), scored_(scored) {
    for (const LidarInfo& lidar : sensor::make_rig(scene.sensors).lidars)
      max_returns_[lidar.id] = evaluation::scored_returns(scene.scan_count(lidar));
  }
  void write(const ScanTruth& truth) override {
    if (all_ != nullptr) all_->write(truth);
    if (scored_ == nullptr) return;
    ScanTruth scored = truth;
    evaluation::keep_scored(scored.points, max_returns_.at(truth.sensor_id));
    scored_->write(scored);
  }

 private:
  ScanTruthSink* all_;
  ScanTruthSink* scored_;
  std::map<std::string, std::size_t> max_returns_;  ///< by LiDAR
};

Time end_of_measurement(const Event& event) {
  const auto* scan = std::get_if<Scan>(&event.data);
  return scan != nullptr ? end_of(*scan) : std::get<ImuSample>(event.data).stamp;
}

/// Gives the truth and the measurements to `writer` in the order of their times.
template <class Writer>
void give_events(const SimulateRequest& request, const Scene& scene, EventSource& events,
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

/// The simulated measurements, with the truth of their returns for `sinks` if these are not null.
std::unique_ptr<EventSource> simulated(const Scene& scene, TruthSinks* sinks,
                                       const Parallel& parallel) {
  sensor::SimulationOptions options = scene.options;
  options.truth = sinks;
  return sensor::simulate(scene.surfaces(), *scene.flight, scene.sensors, options, parallel);
}

void write_events(const SimulateRequest& request, const Scene& scene, dataset::HitsWriter* hits,
                  const fs::path& out, const Parallel& parallel, LogSink& log,
                  SimulateSummary& summary) {
  dataset::WriteOptions options = request.write;
  if (options.format == dataset::DatasetFormat::kKitti && request.truth)
    options.labels = semantic_labels(scene.world->mesh(), scene.model.movers);
  dataset::DatasetWriter writer(out, sensor::make_rig(scene.sensors), options);
  TruthSinks sinks(scene, request.truth ? &writer : nullptr, hits);
  const bool any = request.truth || hits != nullptr;
  const auto events = simulated(scene, any ? &sinks : nullptr, parallel);
  give_events(request, scene, *events, writer, log, summary);
  writer.finish(to_json(manifest_of(request, scene)));
}

/// Simulates for the hits alone.
void write_hits(const SimulateRequest& request, const Scene& scene, dataset::HitsWriter& hits,
                const Parallel& parallel, LogSink& log, SimulateSummary& summary) {
  struct Nowhere {
    void write_truth(const StampedPose&) {}
    void write(const Event&) {}
  } nowhere;
  TruthSinks sinks(scene, nullptr, &hits);
  give_events(request, scene, *simulated(scene, &sinks, parallel), nowhere, log, summary);
}

/// A store, with the functions of a DatasetWriter.
class StoreWriter {
 public:
  explicit StoreWriter(std::unique_ptr<dataset::DatasetStore> store) : store_(std::move(store)) {}
  void write_truth(const StampedPose& pose) { store_->write_truth(pose); }
  void write(const Event& event) {
    std::visit([&](const auto& data) { store_->write(event.sensor_id, data); }, event.data);
  }

 private:
  std::unique_ptr<dataset::DatasetStore> store_;
};

/// Simulates ahead of what is published, so that a scan that takes long does not delay others.
void publish_events(const SimulateRequest& request, const Scene& scene, dataset::HitsWriter* hits,
                    const Parallel& parallel, LogSink& log, SimulateSummary& summary) {
  StoreWriter writer(
      dataset::make_message_store(request.live, sensor::make_rig(scene.sensors), request.write));
  TruthSinks sinks(scene, nullptr, hits);
  ReadAhead events(simulated(scene, hits != nullptr ? &sinks : nullptr, parallel));
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

/// Copies a recording that a flight names into the dataset, where it gets the name `stem`.
void copy_recording(const fs::path& flight, std::string& recording, const char* stem,
                    const fs::path& out) {
  if (recording.empty()) return;
  const std::string name = stem + fs::path(recording).extension().string();
  copy_over(flight.parent_path() / recording, out / name);
  recording = name;
}

/// Copies the flight's file (with `set` over it, all its keys) into the dataset, and the recordings
/// that it replays, so that the dataset can be simulated again after it was moved.
void copy_flight(const fs::path& flight, const std::vector<std::string>& set, const fs::path& out) {
  const fs::path copy = out / ("flight" + flight.extension().string());
  if (flight.extension() != ".yaml") return copy_over(flight, copy);
  flight::FlightConfig config = flight::load_flight(flight, set);
  if (set.empty() && config.replay.empty()) return copy_over(flight, copy);
  copy_recording(flight, config.replay, "replay", out);
  copy_recording(flight, config.replay_imu, "replay_imu", out);
  dataset::write_json(copy, to_json(config));  // JSON is YAML
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

std::unique_ptr<Scene> scene_of(const fs::path& folder, const dataset::SimulationRecord& record) {
  LogSink silent;  // its messages were logged when the dataset was made
  world::WorldModel model;
  model.name = (folder / "world.ply").string();
  model.mesh = world::load_mesh(folder / "world.ply");
  const std::string place = (folder / "manifest.json").string();
  read_value(ConfigNode::parse(record.routes.dump(), place), model.routes, {});
  read_value(ConfigNode::parse(Json(record.movers).dump(), place), model.movers, {});
  std::vector<sensor::SensorConfig> sensors;
  read_value(ConfigNode::parse(Json(record.sensors).dump(), place), sensors, {});
  for (sensor::SensorConfig& s : sensors) {
    if (!s.pattern_file.empty()) s.pattern_file = (folder / s.pattern_file).string();
  }
  sensor::SimulationOptions options;
  options.seed = record.seed;
  options.duration = from_seconds(record.seconds);
  options.noise = record.noise;
  std::optional<std::uint64_t> gust_seed;  // the routes in the manifest are those that were drawn
  if (record.new_scene) gust_seed = options.seed;
  return make_scene(std::move(model), folder / record.flight, std::move(sensors), options,
                    gust_seed, {}, silent);
}

/// The manifest of a dataset without measurements, which has to be simulated; empty for any other.
std::optional<dataset::DatasetManifest> manifest_to_simulate(const fs::path& folder) {
  if (!fs::is_directory(folder) || dataset::has_measurements(folder)) return std::nullopt;
  auto manifest = dataset::read_dataset_manifest(folder);
  return manifest && manifest->simulation ? manifest : std::nullopt;
}

/// Opens a dataset without measurements; its events are simulated (only `sensor` of its LiDARs, if
/// named).
dataset::Dataset open_simulated(const fs::path& folder, const dataset::DatasetManifest& manifest,
                                const std::string& sensor, const Parallel& parallel) {
  std::unique_ptr<Scene> scene = scene_of(folder, *manifest.simulation);
  dataset::Dataset dataset;
  dataset.path = folder;
  dataset.rig = sensor::make_rig(scene->sensors);
  dataset.manifest = to_json(manifest);
  if (const LidarInfo* lidar = dataset.rig.find_lidar(sensor)) {
    scene->options.lidar = lidar->id;
    dataset.scan_count = scene->scan_count(*lidar);
  }
  dataset.events = std::make_unique<SimulatedSource>(std::move(scene), parallel);
  return dataset;
}

}  // namespace

SimulateSummary simulate_dataset(const SimulateRequest& request, const fs::path& out,
                                 const Parallel& parallel, LogSink& log) {
  const SceneSettings set = scene_settings(request.set, request.sensors);
  std::vector<sensor::SensorConfig> sensors;
  for (std::size_t i = 0; i < request.sensors.size(); ++i) {
    sensors.push_back(
        sensor::load_sensor(request.sensors[i], request.shipped_sensors, set.sensors[i]));
    if (request.mode) sensors.back().mode = *request.mode;
  }
  std::optional<std::uint64_t> scene_seed;
  if (request.new_scene) scene_seed = request.seed;
  scenes::WorldOptions world;
  world.seed = scene_seed;
  world.set = set.world;
  world.allow_missing = request.allow_missing;
  world::WorldModel model = scenes::load_world(request.world, world, log);
  if (request.new_scene)
    for (auto& route : model.routes) route = scenes::drawn_route(route, request.seed);
  sensor::SimulationOptions options;
  options.seed = request.seed;
  options.duration = from_seconds(request.seconds);
  options.noise = request.noise;

  // The flight is checked before anything is written.
  const auto scene = make_scene(std::move(model), request.flight, std::move(sensors), options,
                                scene_seed, set.flight, log);
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
  dataset::remove_hits(out);
  world::save_ply(out / "world.ply", scene->world->mesh());
  copy_flight(request.flight, set.flight, out);
  copy_patterns(scene->sensors, out);
  const bool with_data = request.data && !request.live;
  std::optional<dataset::HitsWriter> writer;
  if (request.hits.value_or(with_data))
    writer.emplace(out, sensor::make_rig(scene->sensors), summary.triangles);
  dataset::HitsWriter* const hits = writer ? &*writer : nullptr;
  if (with_data) {
    write_events(request, *scene, hits, out, parallel, log, summary);
  } else {
    dataset::write_tum(out / "truth.tum", truth_of(*scene), dataset::kTruthHeader);
    if (hits != nullptr && !request.live)
      write_hits(request, *scene, *hits, parallel, log, summary);
    dataset::write_json(out / "manifest.json", to_json(manifest_of(request, *scene)));
  }
  if (request.live) publish_events(request, *scene, hits, parallel, log, summary);
  if (hits != nullptr) hits->commit();
  return summary;
}

std::unique_ptr<ScanTruthSource> open_simulated_truth(const fs::path& dataset,
                                                      const std::string& sensor,
                                                      const Parallel& parallel) {
  const auto manifest = manifest_to_simulate(dataset);
  if (!manifest) return nullptr;
  std::unique_ptr<Scene> scene = scene_of(dataset, *manifest->simulation);
  scene->options.lidar = sensor;
  return std::make_unique<SimulatedTruth>(std::move(scene), parallel);
}

std::vector<std::uint32_t> labels_of_dataset(const fs::path& dataset) {
  const auto manifest =
      fs::is_directory(dataset) ? dataset::read_dataset_manifest(dataset) : std::nullopt;
  const auto mesh = manifest ? dataset::find_world_mesh(dataset) : std::nullopt;
  if (!mesh || !manifest->simulation) return {};
  std::vector<world::MoverConfig> movers;
  read_value(ConfigNode::parse(Json(manifest->simulation->movers).dump(),
                               (dataset / "manifest.json").string()),
             movers, {});
  return semantic_labels(world::load_mesh(*mesh), movers);
}

dataset::Dataset open_any_dataset(const fs::path& path, const dataset::ReadOptions& options,
                                  const Parallel& parallel) {
  const auto manifest = manifest_to_simulate(path);
  return manifest ? open_simulated(path, *manifest, options.sensor, parallel)
                  : dataset::open_dataset(path, options);
}

}  // namespace lidarena::stages
