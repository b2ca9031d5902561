// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/simulate_dataset.hpp"

#include <fmt/format.h>

#include "apps/lidarena/console.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/study/example_scan.hpp"

namespace lidarena {
namespace {

struct SimulateOptions {
  std::string world, flight, out;
  std::vector<std::string> sensors;
  study::SimulateRequest request;
  std::string noise = "on";
  std::string mode;
  std::string format = "mcap";
  std::string dialect = "si";
  bool compress = false;
  bool no_data = false;
  bool example_scans = false;
};

int simulate_verb(const Common& common, const SimulateOptions& options) {
  const study::ConfigFolder configs = common.config_folder();
  study::SimulateRequest request = options.request;
  request.world = configs.resolve("worlds", options.world);
  request.flight = configs.resolve("flights", options.flight);
  for (const std::string& sensor : options.sensors) {
    request.sensors.push_back(configs.resolve("sensors", sensor));
  }
  request.noise = options.noise == "on";
  request.data = !options.no_data;
  if (!options.mode.empty()) {
    request.mode.emplace();
    read_value(ConfigNode::parse(options.mode, "--mode"), *request.mode, {});
  }
  read_value(ConfigNode::parse(options.format, "--format"), request.write.format, {});
  read_value(ConfigNode::parse(options.dialect, "--dialect"), request.write.dialect, {});
  request.write.compress = options.compress;
  Console console(common.quiet);
  const study::SimulateSummary s =
      study::simulate_dataset(request, options.out, Parallel(common.threads), console);
  if (options.example_scans) study::write_example_scans(options.out, Parallel(common.threads));
  if (common.json) {
    print_json({{"dataset", options.out},
                {"triangles", s.triangles},
                {"seconds", s.seconds},
                {"path_m", s.path_m},
                {"scans", s.scans},
                {"points", s.points},
                {"imu_samples", s.imu_samples}});
  } else {
    fmt::print("world {} triangles; flew {:.1f} s, {:.1f} m; {} scans, {} points, {} IMU samples\n",
               s.triangles, s.seconds, s.path_m, s.scans, s.points, s.imu_samples);
    fmt::print("dataset: {}\n", options.out);
  }
  return kDone;
}

}  // namespace

void add_simulate(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand("simulate",
                                  "Simulate sensors on a flight through a world; writes a dataset");
  auto o = std::make_shared<SimulateOptions>();
  verb->add_option("--world", o->world, "Name (see: list worlds), mesh, or SDF file")->required();
  verb->add_option("--flight", o->flight, "Name (see: list flights), YAML, or TUM file to replay")
      ->required();
  verb->add_option("--sensor", o->sensors, "Name (see: list sensors) or YAML; may be repeated")
      ->required()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_option("--out", o->out, "Folder to write")->required();
  verb->add_option("--seed", o->request.seed,
                   "Seed of all noise (a procedural world has its own seed in its file)")
      ->capture_default_str();
  verb->add_option("--seconds", o->request.seconds, "Length of the flight; 0 = all of it")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--noise", o->noise, "Sensor noise: on or off")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  verb->add_option(
      "--mode", o->mode,
      "rolling (every shot at its own time), or for comparison a fault of earlier simulators: "
      "frozen, frozen_unstamped, official; default: as in the sensor's file");
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
  verb->add_flag("--scored-truth", o->request.scored_truth,
                 "The same, of the points that scoring uses alone: at most 20,000 of a scan");
  verb->add_flag("--example-scans", o->example_scans,
                 "Also write one scan of each LiDAR, placed by the true motion, for pictures");
  verb->add_flag(
      "--no-data", o->no_data,
      "Write a manifest only: the same points are simulated whenever the dataset is read");
  add_allow_missing(*verb, o->request.allow_missing);
  set_verb(
      *verb, common, [&common, o] { return simulate_verb(common, *o); }, exit_code);
}

}  // namespace lidarena
