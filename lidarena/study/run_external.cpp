// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/run_external.hpp"

#include <fmt/format.h>

#include <chrono>

#include "lidarena/base/shell_word.hpp"
#include "lidarena/dataset/trajectories/trajectory_io.hpp"
#include "lidarena/evaluation/map/reproject.hpp"
#include "lidarena/odometry/event_record.hpp"
#include "lidarena/study/process.hpp"
#include "lidarena/study/simulate_dataset.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

/// A recording of one LiDAR of the dataset and its IMU.
struct Recording {
  Rig rig;
  std::size_t scans = 0;
  double seconds = 0.0;
  fs::path path;
  odometry::EventRecord events;  ///< of the IMU
  std::optional<Time> first_scan;
};

Rig rig_of_one(const Rig& rig, const std::string& lidar_id) {
  Rig one;
  one.body_frame = rig.body_frame;
  const LidarInfo* lidar = rig.find_lidar(lidar_id);
  if (lidar == nullptr) throw InputError(lidar_id, "is not a LiDAR of the dataset");
  one.lidars.push_back(*lidar);
  if (const ImuInfo* imu = rig.imu_beside(*lidar)) one.imus.push_back(*imu);
  return one;
}

Recording record(const ExternalProgram& program, const RunRequest& request, const fs::path& folder,
                 const Parallel& parallel) {
  dataset::Dataset dataset = open_any_dataset(request.dataset, request.read, parallel);
  Recording recording;
  recording.rig = rig_of_one(dataset.rig, request.read.sensor);
  dataset::DatasetWriter writer(folder, recording.rig, {program.input, program.dialect});
  while (const auto event = dataset.events->next()) {
    if (const auto* scan = std::get_if<Scan>(&event->data)) {
      if (event->sensor_id != recording.rig.lidars[0].id) continue;
      ++recording.scans;
      if (!recording.first_scan) recording.first_scan = scan->stamp;
      recording.seconds = to_seconds(scan->stamp);
    } else if (recording.rig.imus.empty() || event->sensor_id != recording.rig.imus[0].id) {
      continue;
    } else {
      recording.events.add(std::get<ImuSample>(event->data));
    }
    writer.write(*event);
  }
  writer.close();
  recording.path = folder;
  if (program.input == dataset::DatasetFormat::kMcap) recording.path = folder / "data.mcap";
  if (program.input == dataset::DatasetFormat::kBag) recording.path = folder / "data.bag";
  return recording;
}

std::string substitute(std::string command, const std::string& key, const std::string& value) {
  for (std::size_t at = command.find(key); at != std::string::npos;
       at = command.find(key, at + value.size())) {
    command.replace(at, key.size(), value);
  }
  return command;
}

/// Runs the command line until it ends; its output goes to `log`.
ProcessEnd run_command(const std::string& name, const std::string& command, const fs::path& log) {
  Command shell;
  shell.arguments = {"/bin/sh", "-c", command};
  shell.output = shell.log = log;
  shell.own_group = false;
  fs::remove(log);
  ProcessEnd end = Process(shell).wait();
  if (end.exit_code != 0) {
    throw Error(
        fmt::format("{} ended with {}; its output is in {}", name,
                    end.exit_code < 0 ? end.reason : fmt::format("exit code {}", end.exit_code),
                    log.filename().string()));
  }
  return end;
}

Pose sensor_from_body(PoseOf pose_of, const Rig& rig) {
  if (pose_of == PoseOf::kBody) return Pose::Identity();
  if (pose_of == PoseOf::kLidar) return rig.lidars[0].body_from_lidar.inverse();
  if (rig.imus.empty()) throw InputError("pose_of: imu", "the dataset has no IMU");
  return rig.imus[0].body_from_imu.inverse();
}

/// Poses of the body in the program's world frame, from its poses of the sensor.
Trajectory body_trajectory(const Trajectory& given, const Pose& sensor_from_body) {
  std::vector<StampedPose> poses;
  for (const StampedPose& pose : given.poses()) {
    poses.push_back({pose.stamp, pose.world_from_body * sensor_from_body});
  }
  return Trajectory(std::move(poses));
}

dataset::Cloud map_of(const fs::path& output) {
  for (const char* name : {"map.ply", "map.pcd"}) {
    if (fs::exists(output / name)) return dataset::read_cloud(output / name);
  }
  return {};
}

}  // namespace

odometry::RunSummary run_external(const ExternalProgram& program, const RunRequest& request,
                                  const fs::path& out, const Parallel& parallel, LogSink& log) {
  const fs::path input = out / "input", output = out / "output";
  for (const fs::path& stale : {input, output}) fs::remove_all(stale);
  fs::create_directories(output);
  log.info("recording for " + program.name);
  const Recording recording = record(program, request, input, parallel);
  std::string command = program.command;
  command = substitute(command, "{input}", shell_word(fs::absolute(recording.path).string()));
  command = substitute(command, "{output}", shell_word(fs::absolute(output).string()));
  command = substitute(command, "{sensor}", shell_word(recording.rig.lidars[0].id));
  command = substitute(command, "{threads}", std::to_string(parallel.threads()));
  log.info("running " + program.name);
  const auto begin = std::chrono::steady_clock::now();
  const ProcessEnd used = run_command(program.name, command, out / kProgramLog);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  fs::remove_all(input);

  const fs::path left = output / "trajectory.tum";
  if (!fs::exists(left)) {
    throw InputError(program.name, "left no trajectory.tum in {output}",
                     "see docs/external_slam.md; its output is in program.log");
  }
  dataset::RunFiles files;
  files.trajectory = body_trajectory(dataset::read_trajectory(left),
                                     sensor_from_body(program.pose_of, recording.rig));
  files.live = files.trajectory;
  if (const fs::path motion = output / "motion.tum"; fs::exists(motion)) {
    files.motion = body_trajectory(dataset::read_trajectory(motion),
                                   sensor_from_body(program.pose_of, recording.rig));
  }
  files.map = map_of(output);
  files.events = recording.events.events(recording.first_scan.value_or(Time{0}));
  const LidarInfo& lidar = recording.rig.lidars[0];
  dataset::Dataset again = open_scored_returns(request.dataset, request.read, parallel);
  files.reprojected = evaluation::reproject(*again.events, lidar.id, lidar.body_from_lidar,
                                            evaluation::BodyMotion(files));

  odometry::RunSummary summary;
  summary.scans = recording.scans;
  summary.sensor_seconds = recording.seconds;
  summary.compute_seconds = wall.count();
  files.manifest = {
      {"kind", "run"},
      {"algorithm", program.name},
      {"preset", "external"},
      {"config", to_json(program)},
      {"dataset", fs::proximate(fs::absolute(request.dataset), fs::absolute(out)).generic_string()},
      {"sensor", lidar.id},
      {"threads", parallel.threads()},
      {"paced", false},
      {"status", "ok"},
      {"reason", ""},
      {"processor_seconds", used.processor_s},
      {"peak_mb", used.peak_mb},
      {"made_on", made_on()},
      {"summary", summary_json(summary)}};
  dataset::write_run(out, files);
  fs::remove_all(output);
  return summary;
}

}  // namespace lidarena::study
