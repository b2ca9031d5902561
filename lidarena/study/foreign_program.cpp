// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/foreign_program.hpp"

#include "lidarena/base/shell_word.hpp"
#include "lidarena/dataset/single_lidar.hpp"
#include "lidarena/evaluation/map/reproject.hpp"
#include "lidarena/study/simulate_dataset.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

std::string substitute(std::string command, const std::string& key, const std::string& value) {
  for (std::size_t at = command.find(key); at != std::string::npos;
       at = command.find(key, at + value.size())) {
    command.replace(at, key.size(), value);
  }
  return command;
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

}  // namespace

Rig rig_of_one(const Rig& rig, const std::string& id, const std::string& place) {
  const LidarInfo* lidar = rig.find_lidar(id);
  if (lidar == nullptr) {
    std::string ids;
    for (const LidarInfo& known : rig.lidars) ids += (ids.empty() ? "" : ", ") + known.id;
    throw InputError(place, id.empty() ? "has several LiDARs" : "has no LiDAR named '" + id + "'",
                     "choose one with --sensor: " + ids);
  }
  Rig one;
  one.body_frame = rig.body_frame;
  one.lidars.push_back(*lidar);
  if (const ImuInfo* imu = rig.imu_beside(*lidar)) one.imus.push_back(*imu);
  return one;
}

Recording record_for(const ExternalProgram& program, const RunRequest& request,
                     const fs::path& folder, const Parallel& parallel) {
  dataset::Dataset dataset = open_any_dataset(request.dataset, request.read, parallel);
  Recording recording;
  recording.rig =
      rig_of_one(dataset.rig, dataset::id_of_topic(request.read.sensor), request.dataset.string());
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

std::string command_line(const ExternalProgram& program, const Recording& recording,
                         const fs::path& output, const Parallel& parallel) {
  std::string command = program.command;
  command = substitute(command, "{input}", shell_word(fs::absolute(recording.path).string()));
  command = substitute(command, "{output}", shell_word(fs::absolute(output).string()));
  command = substitute(command, "{sensor}", shell_word(recording.rig.lidars[0].id));
  return substitute(command, "{threads}", std::to_string(parallel.threads()));
}

Command shell_command(const std::string& command, const fs::path& log) {
  Command shell;
  shell.arguments = {"/bin/sh", "-c", command};
  shell.output = shell.log = log;
  shell.own_group = false;
  fs::remove(log);
  return shell;
}

void write_foreign_run(const ForeignRun& run, const Rig& rig, const RunRequest& request,
                       const fs::path& out, const Parallel& parallel) {
  const Pose from_body = sensor_from_body(run.pose_of, rig);
  dataset::RunFiles files;
  files.trajectory = body_trajectory(run.trajectory, from_body);
  files.live = run.live.empty() ? files.trajectory : body_trajectory(run.live, from_body);
  files.motion = body_trajectory(run.motion, from_body);
  files.map = run.map;
  files.events = run.events;
  const LidarInfo& lidar = rig.lidars[0];
  dataset::ReadOptions read = request.read;
  read.sensor = lidar.id;
  dataset::Dataset again = open_scored_returns(request.dataset, read, parallel);
  files.reprojected = evaluation::reproject(*again.events, lidar.id, lidar.body_from_lidar,
                                            evaluation::BodyMotion(files));
  files.manifest = {
      {"kind", "run"},
      {"algorithm", run.name},
      {"dataset", fs::proximate(fs::absolute(request.dataset), fs::absolute(out)).generic_string()},
      {"sensor", lidar.id},
      {"threads", parallel.threads()},
      {"paced", false},
      {"status", "ok"},
      {"reason", ""},
      {"made_on", made_on()},
      {"summary", summary_json(run.summary)}};
  files.manifest.update(run.manifest);
  dataset::write_run(out, files);
}

}  // namespace lidarena::study
