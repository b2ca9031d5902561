// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "apps/lidarena/console.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/dataset/trajectories/kitti.hpp"
#include "lidarena/dataset/trajectories/trajectory_io.hpp"
#include "lidarena/dataset/trajectories/tum.hpp"
#include "lidarena/dataset/whole_part.hpp"
#include "lidarena/scenes/load_world.hpp"
#include "lidarena/stages/simulate_dataset.hpp"
#include "lidarena/world/export_world.hpp"
#include "lidarena/world/ply.hpp"

namespace lidarena {
namespace {

namespace fs = std::filesystem;

struct ConvertOptions {
  std::string in, out;
  std::string format;  ///< of datasets; empty: chosen by the extension of `out`
  std::string dialect = "si";
  bool compress = false;
  scenes::WorldOptions world{};
  dataset::ReadOptions read;
};

/// What is converted, as detected from the input and output paths.
enum class Kind { kWorld, kCloud, kTrajectory, kDataset };

template <std::size_t N>
bool has_extension(const fs::path& file, const std::array<const char*, N>& extensions) {
  return std::find(extensions.begin(), extensions.end(), file.extension().string()) !=
         extensions.end();
}

/// False for a .ply without faces, which is a point cloud.
bool is_mesh(const fs::path& file) {
  if (file.extension() != ".ply") return true;
  try {
    return !world::read_ply(file).empty();
  } catch (const InputError&) {
    return false;  // not a readable mesh: handled as a cloud, whose reader reports errors
  }
}

Kind kind_of(const fs::path& in, const fs::path& out) {
  constexpr std::array kWorlds{".sdf",  ".world", ".obj",  ".stl", ".dae",
                               ".gltf", ".glb",   ".yaml", ".yml"};
  constexpr std::array kTrajectories{".tum", ".txt", ".csv"};
  constexpr std::array kPoses{".tum", ".txt"};
  if (fs::is_directory(in)) return Kind::kDataset;
  if (has_extension(in, kWorlds)) return Kind::kWorld;
  if (has_extension(in, kTrajectories) || has_extension(out, kPoses)) return Kind::kTrajectory;
  if (in.extension() == ".pcd") return Kind::kCloud;
  if (in.extension() == ".ply") return is_mesh(in) ? Kind::kWorld : Kind::kCloud;
  return Kind::kDataset;
}

[[noreturn]] void reject_extension(const fs::path& out, const std::string& what,
                                   const std::string& extensions) {
  throw InputError(out.string(), "has an extension that " + what + " cannot be written to",
                   "use " + extensions);
}

Json convert_world(const fs::path& in, const fs::path& out, const scenes::WorldOptions& options,
                   LogSink& log) {
  world::WorldModel model = scenes::load_world(in, options, log);
  const std::size_t dropped = world::clean_mesh(model.mesh, in.string());
  if (dropped > 0) log.info(fmt::format("left out {} degenerate triangles", dropped));
  world::save_world(out, model.mesh);
  return {{"kind", "world"}, {"triangles", model.mesh.triangles.size()}};
}

Json convert_cloud(const fs::path& in, const fs::path& out) {
  const dataset::Cloud cloud = dataset::read_cloud(in, true);
  if (out.extension() == ".ply") {
    dataset::write_ply(out, cloud);
  } else if (out.extension() == ".pcd") {
    dataset::write_pcd(out, cloud);
  } else {
    reject_extension(out, "clouds", ".ply or .pcd");
  }
  return {{"kind", "cloud"}, {"points", cloud.points.size()}};
}

/// Writes TUM (.tum), or KITTI (.txt: rows of twelve numbers; the times go to FILE.times.txt).
Json convert_trajectory(const fs::path& in, const fs::path& out, double rate_hz) {
  const dataset::FramedTrajectory read = dataset::read_framed_trajectory(in, {}, rate_hz);
  const Trajectory& trajectory = read.trajectory;
  if (out.extension() == ".tum") {
    const std::string frames = (read.world.empty() ? "world" : read.world) + "_from_" +
                               (read.body.empty() ? "body" : read.body);
    dataset::write_tum(out, trajectory, frames + "\ntime[s] x y z[m] qx qy qz qw");
  } else if (out.extension() == ".txt") {
    dataset::write_kitti_poses(out, trajectory);
    std::vector<Time> times;
    for (const StampedPose& pose : trajectory.poses()) times.push_back(pose.stamp);
    dataset::write_times(fs::path(out).replace_extension(".times.txt"), times);
  } else {
    reject_extension(out, "trajectories", ".tum (TUM) or .txt (KITTI)");
  }
  return {{"kind", "trajectory"},
          {"poses", trajectory.size()},
          {"repeated_times_left_out", read.repeated.size()}};
}

dataset::WriteOptions write_options(const ConvertOptions& o) {
  dataset::WriteOptions options;
  const std::string ending = fs::path(o.out).extension().string();
  const std::string format = !o.format.empty() ? o.format : ending == ".bag" ? "bag" : "mcap";
  read_value(ConfigNode::parse(format, "--format"), options.format, {});
  read_value(ConfigNode::parse(o.dialect, "--dialect"), options.dialect, {});
  options.compress = o.compress;
  return options;
}

/// Says which topics of a recording of others are not converted.
void tell_left_out(const dataset::Dataset& in, LogSink& log) {
  std::vector<std::string> left_out;
  for (const dataset::TopicSummary& topic : in.topics) {
    const bool is_ours = topic.topic.starts_with("/truth/") || topic.topic == "/tf" ||
                         topic.topic == "/tf_static" || topic.topic.starts_with("/lidarena/");
    if (topic.is_read || is_ours) continue;
    left_out.push_back(
        fmt::format("{} ({}, {} messages)", topic.topic, topic.type, topic.messages));
  }
  if (!left_out.empty()) log.warn(fmt::format("left out: {}", fmt::join(left_out, ", ")));
}

Json convert_dataset(const ConvertOptions& o, const Parallel& parallel, LogSink& log) {
  dataset::ReadOptions read = o.read;
  read.all_sensors = read.imu_topic.empty();
  dataset::Dataset in = stages::open_any_dataset(o.in, read, parallel);
  dataset::tell_opening(in, log);
  tell_left_out(in, log);
  dataset::read_whole_part(in);
  dataset::WriteOptions write = write_options(o);
  dataset::OpenTruth open_truth;
  if (write.format == dataset::DatasetFormat::kKitti) {
    write.labels = stages::labels_of_dataset(o.in);
    open_truth = [&](const std::string& lidar) {
      return stages::open_simulated_truth(o.in, lidar, parallel);
    };
  }
  const dataset::CopySummary copied = dataset::copy_dataset(in, o.out, write, open_truth);
  if (!write.labels.empty() && copied.truth_scans == 0)
    log.info("no labels are written: the dataset has no truth of its points (simulate --truth)");
  Json done{{"kind", "dataset"},           {"scans", copied.scans},
            {"points", copied.points},     {"imu_samples", copied.imu_samples},
            {"truth_poses", copied.poses}, {"truth_scans", copied.truth_scans}};
  if (!dataset::tell_reading(in, log)) done["ended"] = in.report->ended();
  return done;
}

int convert_verb(const Common& common, const ConvertOptions& o) {
  Console console(common.quiet);
  fs::path in = o.in;
  if (!fs::exists(in)) in = common.config_folder().resolve("worlds", o.in);
  Json done;
  switch (kind_of(in, o.out)) {
    case Kind::kWorld:
      done = convert_world(in, o.out, o.world, console);
      break;
    case Kind::kCloud:
      done = convert_cloud(in, o.out);
      break;
    case Kind::kTrajectory:
      done = convert_trajectory(in, o.out, o.read.rate_hz);
      break;
    case Kind::kDataset:
      done = convert_dataset(o, Parallel(common.threads), console);
      break;
  }
  done["out"] = o.out;
  const int exit_code = done.contains("ended") ? kWorkFailed : kDone;
  if (common.json) {
    print_json(done);
    return exit_code;
  }
  std::string text;
  for (const auto& [key, value] : done.items()) {
    if (key == "kind" || key == "out" || key == "ended" || value == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", value.dump(), key);
  }
  fmt::print("{}: {}\n{}\n", done["kind"].get<std::string>(), text, o.out);
  return exit_code;
}

}  // namespace

void add_convert(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand(
      "convert", "Convert a dataset, world, point cloud or trajectory to another file format");
  auto o = std::make_shared<ConvertOptions>();
  verb->add_option("in", o->in,
                   "Dataset folder, .mcap, .bag, folder of sweeps, world, cloud or trajectory")
      ->required();
  verb->add_option("out", o->out,
                   "Output: for a dataset a folder, .mcap or .bag; for a world .ply, .obj, .sdf or "
                   ".world; for a cloud .ply or .pcd; for a trajectory .tum or .txt (KITTI)")
      ->required();
  verb->add_option("--format", o->format,
                   "Format of an output dataset: mcap, bag, pcd, ply or kitti")
      ->check(CLI::IsMember({"mcap", "bag", "pcd", "ply", "kitti"}));
  verb->add_flag("--compress", o->compress,
                 "Compress MCAP chunks with zstd: smaller files, slower");
  verb->add_option("--dialect", o->dialect,
                   "Layouts and units of messages: si, or driver as in the sensors' own drivers")
      ->check(CLI::IsMember({"si", "driver"}))
      ->capture_default_str();
  verb->add_option("--sensor", o->read.sensor,
                   "Id or topic of the only LiDAR to convert; default: all");
  verb->add_option("--imu-topic", o->read.imu_topic, "Topic of the only IMU to convert");
  verb->add_option("--layout", o->read.layout, "Fields of a point in raw binary sweeps")
      ->check(CLI::IsMember({"xyz", "xyzi", "xyzt", "xyztr"}));
  verb->add_option("--rate", o->read.rate_hz, "Sweeps or poses per second, for input without times")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  add_allow_missing(*verb, o->world.allow_missing);
  set_verb(
      *verb, common, [&common, o] { return convert_verb(common, *o); }, exit_code);
}

}  // namespace lidarena
