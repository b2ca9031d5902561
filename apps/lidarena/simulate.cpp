// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/simulate_dataset.hpp"

#include <fmt/format.h>

#include "adapters/live/simulate_live.hpp"
#include "apps/lidarena/console.hpp"
#include "apps/lidarena/live_options.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/stages/example_scan.hpp"

namespace lidarena {
namespace {

namespace fs = std::filesystem;

struct SimulateOptions {
  std::string world, flight, out;
  std::vector<std::string> sensors;
  stages::SimulateRequest request;
  std::string noise = "on";
  std::string hits;
  std::string mode;
  std::string format = "mcap";
  std::string dialect = "si";
  bool compress = false;
  bool no_data = false;
  bool example_scans = false;
  live::LiveSimulation live;
};

/// Finds the files of sensors, world and flight. What is given is judged first, then what is
/// missing is named.
void find_files(const stages::ConfigFolder& configs, const SimulateOptions& options,
                stages::SimulateRequest& request) {
  for (const std::string& sensor : options.sensors) {
    request.sensors.push_back(configs.resolve("sensors", sensor));
    configs.load_sensor(sensor);
  }
  request.shipped_sensors = configs.root() / "sensors";
  if (!options.world.empty()) request.world = configs.resolve("worlds", options.world);
  if (!options.flight.empty()) request.flight = configs.resolve("flights", options.flight);
  std::string missing, lists;
  for (const auto& [flag, is_given] : {std::pair{"world", !options.world.empty()},
                                       {"flight", !options.flight.empty()},
                                       {"sensor", !options.sensors.empty()}}) {
    if (is_given) continue;
    missing += fmt::format("{}--{}", missing.empty() ? "" : ", ", flag);
    lists += fmt::format("{}lidarena list {}s", lists.empty() ? "" : ", ", flag);
  }
  if (!missing.empty()) throw InputError("simulate", "needs " + missing, "see " + lists);
}

/// WORLD-FLIGHT-SENSOR, in the working folder.
std::string default_output(const stages::SimulateRequest& request) {
  std::string name = request.world.stem().string();
  if (request.flight.stem() != request.world.stem()) name += "-" + request.flight.stem().string();
  for (const fs::path& sensor : request.sensors) name += "-" + sensor.stem().string();
  return free_name(name);
}

int simulate_verb(const Common& common, const SimulateOptions& options) {
  stages::SimulateRequest request = options.request;
  find_files(common.config_folder(), options, request);
  request.noise = options.noise == "on";
  request.data = !options.no_data;
  if (!options.hits.empty()) request.hits = options.hits == "on";
  if (!options.mode.empty()) {
    request.mode.emplace();
    read_value(ConfigNode::parse(options.mode, "--mode"), *request.mode, {});
  }
  read_value(ConfigNode::parse(options.format, "--format"), request.write.format, {});
  read_value(ConfigNode::parse(options.dialect, "--dialect"), request.write.dialect, {});
  request.write.compress = options.compress;
  const std::string out = options.out.empty() ? default_output(request) : options.out;
  Console console(common.quiet);
  if (options.out.empty()) console.info("writes to " + out);
  const Parallel parallel(common.threads);
  const live::PublishedFlight flight =
      options.live.asked ? live::simulate_live(options.live, request, out, parallel, console)
                         : live::PublishedFlight{
                               stages::simulate_dataset(request, out, parallel, console), {}, {}};
  const stages::SimulateSummary& s = flight.summary;
  if (s.scans > 0 && s.points == 0) {
    console.warn(
        "no shot has a return: the world is out of range; is it in meters, and does the flight "
        "pass through it? `lidarena info WORLD` prints its bounds");
  }
  if (options.example_scans) stages::write_example_scans(out, parallel);
  if (common.json) {
    Json told{{"dataset", out},
              {"triangles", s.triangles},
              {"seconds", s.seconds},
              {"path_m", s.path_m},
              {"scans", s.scans},
              {"points", s.points},
              {"imu_samples", s.imu_samples}};
    if (options.live.asked) told["published"] = flight.messages;
    print_json(told);
  } else {
    fmt::print("world {} triangles; flew {:.1f} s, {:.1f} m; {} scans, {} points, {} IMU samples\n",
               s.triangles, s.seconds, s.path_m, s.scans, s.points, s.imu_samples);
    if (options.live.asked) fmt::print("published {}\n", flight.text);
    fmt::print("dataset: {}\n", out);
  }
  return kDone;
}

}  // namespace

void add_simulate(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand("simulate",
                                  "Simulate sensors on a flight through a world; writes a dataset");
  auto o = std::make_shared<SimulateOptions>();
  verb->add_option("--world", o->world, "Name (see: list worlds), mesh, or SDF file; required");
  verb->add_option("--flight", o->flight,
                   "Name (see: list flights), YAML, or TUM file to replay; required");
  verb->add_option("--sensor", o->sensors,
                   "Name (see: list sensors) or YAML; required, may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_option("--out", o->out,
                   "Folder to write; default: WORLD-FLIGHT-SENSOR in the working folder");
  verb->add_option("--set", o->request.set,
                   "sensor.KEY=VALUE (each sensor), SENSOR.KEY, imu.KEY, flight.KEY or world.KEY: "
                   "overrides the file; may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_option("--seed", o->request.seed,
                   "Seed of all noise (a procedural world has its own seed in its file)")
      ->capture_default_str();
  verb->add_flag("--new-scene", o->request.new_scene,
                 "The seed also draws the procedural world, where and in which direction its route "
                 "begins, and the gusts");
  verb->add_option("--seconds", o->request.seconds, "Length of the flight; 0 = all of it")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--noise", o->noise, "Sensor noise: on or off")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  verb->add_option(
      "--mode", o->mode,
      "rolling (every shot at its own time), or for comparison a fault of earlier simulators: "
      "frozen, frozen_unstamped, frozen_ramp, official; default: as in the sensor's file");
  verb->add_option("--format", o->format,
                   "mcap or bag (one recording), pcd, ply or kitti (one file per sweep)")
      ->check(CLI::IsMember({"mcap", "bag", "pcd", "ply", "kitti"}))
      ->capture_default_str();
  verb->add_flag("--compress", o->compress,
                 "Compress MCAP chunks with zstd: smaller files, slower");
  verb->add_option("--dialect", o->dialect,
                   "Layouts and units of messages: si, or driver as in the sensors' own drivers")
      ->check(CLI::IsMember({"si", "driver"}))
      ->capture_default_str();
  verb->add_flag("--truth", o->request.truth,
                 "Also write what each point hit: surface point, range, normal, triangle");
  verb->add_option(
          "--hits", o->hits,
          "Write what the scored points hit, at most 20,000 of a scan, for scores of maps; "
          "default: on, with --no-data off")
      ->check(CLI::IsMember({"on", "off"}));
  verb->add_flag("--example-scans", o->example_scans,
                 "Also write one scan of each LiDAR, placed by the true motion, for pictures");
  verb->add_flag(
      "--no-data", o->no_data,
      "Write a manifest only: the same points are simulated whenever the dataset is read");
  add_allow_missing(*verb, o->request.allow_missing);
  add_live_simulation(*verb, o->live);
  set_verb(
      *verb, common, [&common, o] { return simulate_verb(common, *o); }, exit_code);
}

}  // namespace lidarena
