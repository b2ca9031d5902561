// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/foreign_program.hpp"

#include <algorithm>

#include "lidarena/base/shell_word.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/single_lidar.hpp"
#include "lidarena/dataset/whole_part.hpp"
#include "lidarena/evaluation/map/reproject.hpp"
#include "lidarena/evaluation/map/scored_returns.hpp"
#include "lidarena/stages/simulate_dataset.hpp"

namespace lidarena::stages {
namespace {

namespace fs = std::filesystem;

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

/// The event, `by` later.
Event shifted(Event event, Time by) {
  std::visit([&](auto& data) { data.stamp += by; }, event.data);
  return event;
}

constexpr const char* kRigFile = "rig.json";

}  // namespace

std::string substitute(std::string command, const std::string& key, const std::string& value) {
  for (std::size_t at = command.find(key); at != std::string::npos;
       at = command.find(key, at + value.size())) {
    command.replace(at, key.size(), value);
  }
  return command;
}

Trajectory at_flight_times(const ExternalProgram& program, const Trajectory& poses,
                           const std::vector<ScanSpan>& spans) {
  constexpr Time kTolerance{1'000'000};  // programs write stamps with four decimals
  std::vector<StampedPose> moved(poses.poses().begin(), poses.poses().end());
  for (StampedPose& pose : moved) {
    pose.stamp -= from_seconds(program.start_s);
    if (program.pose_at == PoseAt::kStamp) continue;
    const auto span =
        std::ranges::lower_bound(spans, pose.stamp - kTolerance, {}, &ScanSpan::stamp);
    if (span == spans.end() || span->stamp > pose.stamp + kTolerance) continue;
    const Time length = span->end - span->stamp;
    pose.stamp = span->stamp + (program.pose_at == PoseAt::kEnd ? length : length / 2);
  }
  return Trajectory(std::move(moved));
}

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

ProgramInput record_for(const ExternalProgram& program, const RunRequest& request,
                        const fs::path& folder, const Parallel& parallel) {
  dataset::Dataset dataset = open_any_dataset(request.dataset, request.read, parallel);
  ProgramInput recording;
  recording.rig =
      rig_of_one(dataset.rig, dataset::id_of_topic(request.read.sensor), request.dataset.string());
  recording.returns = std::make_unique<evaluation::ReturnStore>(
      folder, recording.rig.lidars[0].id,
      evaluation::scored_returns(dataset.scan_count.value_or(0)));
  const auto events = recording.returns->keep_from(std::move(dataset.events));
  dataset::DatasetWriter writer(folder, recording.rig, {program.input, program.dialect});
  const Time start = from_seconds(program.start_s);
  while (const auto event = events->next()) {
    if (const auto* scan = std::get_if<Scan>(&event->data)) {
      if (event->sensor_id != recording.rig.lidars[0].id) continue;
      ++recording.scans;
      if (!recording.first_scan) recording.first_scan = scan->stamp;
      recording.seconds = to_seconds(scan->stamp);
      recording.spans.push_back({scan->stamp, end_of(*scan)});
    } else if (recording.rig.imus.empty() || event->sensor_id != recording.rig.imus[0].id) {
      continue;
    } else {
      recording.events.add(std::get<ImuSample>(event->data));
    }
    writer.write(shifted(*event, start));
  }
  writer.close();
  recording.path = folder;
  if (program.input == dataset::DatasetFormat::kMcap) recording.path = folder / "data.mcap";
  if (program.input == dataset::DatasetFormat::kBag) recording.path = folder / "data.bag";
  recording.rig_file = folder / kRigFile;
  dataset::write_json(recording.rig_file, to_json(recording.rig));
  return recording;
}

std::string command_line(const ExternalProgram& program, const ProgramInput& recording,
                         const fs::path& output, const Parallel& parallel) {
  std::string command = program.command;
  command = substitute(command, "{input}", shell_word(fs::absolute(recording.path).string()));
  command = substitute(command, "{output}", shell_word(fs::absolute(output).string()));
  command = substitute(command, "{rig}", shell_word(fs::absolute(recording.rig_file).string()));
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

std::unique_ptr<evaluation::ReturnStore> returns_of(const RunRequest& request, const Rig& rig,
                                                    const fs::path& folder,
                                                    const Parallel& parallel) {
  dataset::ReadOptions read = request.read;
  read.sensor = rig.lidars[0].id;
  dataset::Dataset dataset = open_any_dataset(request.dataset, read, parallel);
  dataset::read_whole_part(dataset);
  auto returns = std::make_unique<evaluation::ReturnStore>(
      folder, read.sensor, evaluation::scored_returns(dataset.scan_count.value_or(0)));
  const auto events = returns->keep_from(std::move(dataset.events));
  while (events->next()) {
  }
  return returns;
}

void write_foreign_run(const ForeignRun& run, const Rig& rig,
                       const evaluation::ReturnStore& returns, const RunRequest& request,
                       const fs::path& out, const Parallel& parallel) {
  const Pose from_body = sensor_from_body(run.pose_of, rig);
  dataset::RunFiles files;
  files.trajectory = body_trajectory(run.trajectory, from_body);
  files.live = run.live.empty() ? files.trajectory : body_trajectory(run.live, from_body);
  files.motion = body_trajectory(run.motion, from_body);
  files.map = run.map;
  files.events = run.events;
  const LidarInfo& lidar = rig.lidars[0];
  files.reprojected = evaluation::reprojected(*returns.read(), lidar.id, lidar.body_from_lidar,
                                              evaluation::BodyMotion(files));
  files.manifest = manifest_of(run.summary, lidar, request.dataset, out, parallel);
  files.manifest.algorithm = run.name;
  files.manifest.preset = run.preset;
  files.manifest.config = run.config;
  files.manifest.live = run.on_live_topics;
  files.manifest.process = run.process;
  files.manifest.messages = run.messages;
  dataset::write_run(out, files);
}

}  // namespace lidarena::stages
