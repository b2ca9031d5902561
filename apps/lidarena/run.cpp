// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "adapters/live/run_live.hpp"
#include "adapters/live/run_node.hpp"
#include "apps/lidarena/console.hpp"
#include "apps/lidarena/live_options.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/dataset/run_manifest.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/stages/ready_program.hpp"
#include "lidarena/stages/run_algorithm.hpp"
#include "lidarena/stages/run_external.hpp"

namespace lidarena {
namespace {

namespace fs = std::filesystem;

/// "body_from_lidar=x,y,z,qx,qy,qz,qw" to a pose.
Pose parse_extrinsics(const std::string& text) {
  const std::string prefix = "body_from_lidar=";
  if (text.rfind(prefix, 0) != 0) {
    throw InputError("--extrinsics " + text, "does not begin with " + prefix);
  }
  Pose pose;
  read_value(ConfigNode::parse("[" + text.substr(prefix.size()) + "]", "--extrinsics"), pose, {});
  return pose;
}

/// Options of `run` as given.
struct RunOptions {
  stages::RunRequest request;
  std::string dataset, extrinsics, external, out;
  std::string maps = "on";
  live::LiveRun live;
};

/// Checks first what is given, then whether all is given.
void check_options(const RunOptions& o) {
  const std::string& algorithm = o.request.odometry.algorithm;
  if (algorithm.empty()) {
    throw InputError("run", "needs an algorithm and a dataset",
                     "see lidarena list algorithms; for example: lidarena run arena_lio my.bag");
  }
  if (o.external.empty()) odometry::check_algorithm(o.request.odometry);
  if (o.request.parts > 1 && (o.live.asked || !o.external.empty()))
    throw InputError("--parts", "is for Lidarena's own methods on a dataset", "leave it out");
  if (!o.request.also.empty() && (o.live.asked || !o.external.empty()))
    throw InputError("--also", "is for Lidarena's own methods on a dataset", "leave it out");
  if (o.live.asked && odometry::parts_of(o.request.odometry) > 1)
    throw InputError("--preset " + o.request.odometry.preset,
                     "takes each sweep in parts, which --live cannot give",
                     "run it on a recording, or choose another preset");
  if (o.dataset.empty() && !o.live.asked) {
    throw InputError("run " + algorithm, "needs a dataset",
                     "give a dataset folder, .mcap, .bag or folder of sweeps");
  }
}

/// DATASET-ALGORITHM[-PRESET], in the working folder.
std::string default_output(const stages::RunRequest& request) {
  const fs::path dataset =
      request.dataset.empty() ? fs::path("live") : fs::weakly_canonical(request.dataset);
  const fs::path name = fs::is_directory(dataset) ? dataset.filename() : dataset.stem();
  const odometry::OdometryRequest& odometry = request.odometry;
  return free_name(fmt::format("{}-{}{}{}", name.string(), odometry.algorithm,
                               odometry.preset.empty() ? "" : "-", odometry.preset));
}

void print_summary(const Common& common, const odometry::RunSummary& s, bool paced,
                   const std::string& out) {
  if (common.json) {
    Json json{{"run", out}};
    json.update(to_json(dataset::read_run_manifest(out).summary));
    json["reason"] = s.reason;
    return print_json(json);
  }
  std::string counts;
  for (const auto& [status, count] : s.statuses)
    counts +=
        fmt::format("{}{} {}", counts.empty() ? "" : ", ", count, odometry::to_string(status));
  fmt::print("{} scans ({}): the method took {:.1f} s, {:.1f} times real time\n", s.scans, counts,
             s.compute_seconds, s.compute_seconds > 0 ? s.sensor_seconds / s.compute_seconds : 0.0);
  if (s.refused > 0) {
    fmt::print("{} scans were refused: they are not later than the scan before\n", s.refused);
  }
  if (paced) {
    fmt::print("paced: {} scans dropped, the longest delay of an estimate was {:.3f} s\n",
               s.dropped, s.longest_delay_s);
  }
  fmt::print("run: {}\n", out);
}

int run_verb(const Common& common, const RunOptions& o) {
  check_options(o);
  stages::RunRequest request = o.request;
  request.dataset = o.dataset;
  request.maps = o.maps == "on";
  if (!o.extrinsics.empty()) request.read.body_from_lidar = parse_extrinsics(o.extrinsics);
  const std::string out = o.out.empty() ? default_output(request) : o.out;
  Console console(common.quiet);
  if (o.out.empty()) console.info("writes to " + out);
  const Parallel parallel(common.threads);
  const auto run = [&] {
    live::LiveRun on_topics = o.live;
    on_topics.imu_topic = request.read.imu_topic;
    if (on_topics.asked)
      return live::run_live(on_topics, request, common.config_folder(), out, parallel, console);
    if (o.external.empty()) return stages::run_algorithm(request, out, parallel, console);
    const auto program =
        stages::load_program(common.config_folder().resolve("programs", o.external));
    if (program.node.is_used()) return live::run_node(program, request, out, parallel, console);
    return stages::run_external(program, request, out, parallel, console);
  };
  const odometry::RunSummary s = run();
  print_summary(common, s, request.paced, out);
  if (s.diverged) {
    console.warn("the run diverged: " + s.reason);
    return kWorkFailed;
  }
  return s.recording_ended.empty() ? kDone : kWorkFailed;
}

}  // namespace

void add_run(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand("run", "Run an algorithm on a dataset, bag or folder of sweeps");
  auto o = std::make_shared<RunOptions>();
  stages::RunRequest& r = o->request;
  verb->add_option("algorithm", r.odometry.algorithm, "Name (see: list algorithms); required");
  verb->add_option("dataset", o->dataset,
                   "Dataset folder, .mcap, .bag or folder of sweeps; required");
  verb->add_option("--out", o->out,
                   "Folder to write; default: DATASET-ALGORITHM in the working folder");
  verb->add_option("--preset", r.odometry.preset,
                   "One of the algorithm's presets; default: its first");
  verb->add_option("--sensor", r.read.sensor,
                   "Id or topic of the LiDAR to use, if there are several");
  verb->add_option("--also", r.also,
                   "Id or topic of a further LiDAR, whose points are added to the scans; may be "
                   "repeated; for arena_lio")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_option("--imu-topic", r.read.imu_topic,
                   "Topic of the IMU to use; default: the one that belongs to the LiDAR (live: "
                   "/SENSOR/imu)");
  verb->add_option("--config", r.odometry.config_file,
                   "YAML file that overrides values of the preset");
  verb->add_option("--set", r.odometry.overrides,
                   "key=value, overrides preset and --config; may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_option(
      "--external", o->external,
      "Program of others to run as ALGORITHM: a name (see: list programs) or a YAML file");
  verb->add_option("--maps", o->maps, "Write the maps, which take most of the space: on or off")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  verb->add_option("--parts", r.parts,
                   "Hand each sweep over as N scans by the times of its points, as for 20 Hz; "
                   "default: as the preset has it, 1 unless it is tuned")
      ->check(CLI::Range(1, 100));
  verb->add_flag("--paced", r.paced, "Drop scans when the algorithm is late, as on a live robot");
  verb->add_option("--layout", r.read.layout, "Fields of a point in raw binary sweeps")
      ->check(CLI::IsMember({"xyz", "xyzi", "xyzt", "xyztr"}));
  verb->add_option("--extrinsics", o->extrinsics,
                   "Mounting of the LiDAR: body_from_lidar=x,y,z,qx,qy,qz,qw; "
                   "default: as the dataset states, or its /tf_static");
  verb->add_option("--rate", r.read.rate_hz, "Sweeps per second, for a folder without times")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  add_live_run(*verb, o->live);
  set_verb(
      *verb, common, [&common, o] { return run_verb(common, *o); }, exit_code);
}

}  // namespace lidarena
