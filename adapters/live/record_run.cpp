// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/live/record_run.hpp"

#include <fmt/format.h>

#include <chrono>

#include "adapters/dds/live_reader.hpp"
#include "adapters/live/interrupt.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/stages/foreign_program.hpp"
#include "lidarena/stages/simulate_dataset.hpp"

namespace lidarena::live {
namespace {

/// The rig of the dataset that is scored against. Throws InputError if it has no truth.
Rig scored_rig(const RunToRecord& run, const stages::RunRequest& request,
               const Parallel& parallel) {
  const dataset::Dataset dataset =
      stages::open_any_dataset(request.dataset, request.read, parallel);
  if (!dataset::load_truth(request.dataset)) {
    throw InputError(run.dataset, "contains no truth to score against",
                     "record an MCAP file (without --truth), and evaluate --trajectory");
  }
  return stages::rig_of_one(dataset.rig, run.sensor, run.dataset);
}

/// Ends at Ctrl-C, and when no pose came within the limit.
dds::LiveReaderOptions run_reading(const RunToRecord& run, double idle_s, const PoseRecord& poses) {
  dds::LiveReaderOptions reading;
  reading.idle = std::chrono::milliseconds(static_cast<int>(1e3 * idle_s));
  reading.wanted = [&run](const std::string& topic, const std::string& type) {
    return run.topics.wants(topic, type);
  };
  const auto begin = std::chrono::steady_clock::now();
  reading.stopped = [&run, &poses, begin, interrupted = end_on_interrupt()] {
    const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - begin;
    return interrupted() ||
           (run.first_limit_s > 0.0 && poses.empty() && waited.count() > run.first_limit_s);
  };
  return reading;
}

std::string nothing_came(const RunToRecord& run, const dds::LiveReader& live,
                         const PoseRecord& poses) {
  std::string topics;
  for (const auto& [topic, type] : live.seen())
    topics += fmt::format("{}{} [{}]", topics.empty() ? "" : ", ", topic, type);
  std::string bad;
  for (const auto& [topic, count] : poses.bad())
    bad += fmt::format("; {} messages on {} could not be read", count, topic);
  const std::string named =
      run.topics.odometry + (run.topics.path.empty() ? "" : " ") + run.topics.path;
  return fmt::format(
      "no pose came{}{}; topics that were seen: {}; is the node running, with this ROS_DOMAIN_ID? "
      "name its topic with --odometry-topic or --path-topic",
      named.empty() ? "" : " on " + named, bad, topics.empty() ? "none" : topics);
}

stages::PoseOf asked_pose_of(const std::string& text) {
  stages::PoseOf pose_of{};
  read_value(ConfigNode::parse(text, "--pose-of"), pose_of, {});
  return pose_of;
}

}  // namespace

stages::PoseOf pose_of_frame(const std::string& frame, const Rig& rig, LogSink& log) {
  const std::string name = frame.substr(frame.rfind('/') + 1);
  if (name == rig.body_frame) return stages::PoseOf::kBody;
  if (name == rig.lidars[0].id + "_lidar") return stages::PoseOf::kLidar;
  if (!rig.imus.empty() && name == rig.imus[0].id + "_imu") return stages::PoseOf::kImu;
  log.info(
      fmt::format("the poses are of '{}': taken for the LiDAR's; if they are not, say so with "
                  "--pose-of",
                  frame));
  return stages::PoseOf::kLidar;
}

std::size_t record_run(const RunToRecord& run, const dds::LiveOptions& options, double idle_s,
                       const std::string& out, const Parallel& parallel, LogSink& log) {
  stages::RunRequest request;
  request.dataset = run.dataset;
  request.read.sensor = run.sensor;
  const Rig rig = scored_rig(run, request, parallel);
  PoseRecord poses(run.topics);
  dds::LiveReader live(options, run_reading(run, idle_s, poses));
  log.info("waits for poses");
  while (const auto message = live.next()) poses.add(*message);
  if (poses.empty()) throw Error(nothing_came(run, live, poses));
  const PoseRecord::Result result = poses.take(log);
  stages::ForeignRun foreign;
  foreign.name = run.name;
  foreign.pose_of =
      run.pose_of.empty() ? pose_of_frame(result.body, rig, log) : asked_pose_of(run.pose_of);
  foreign.trajectory = result.trajectory;
  foreign.live = result.live;
  foreign.map.points = result.map;
  foreign.summary.scans = result.live.size();
  foreign.summary.sensor_seconds = to_seconds(result.live.end_time() - result.live.begin_time());
  foreign.preset = "live";
  foreign.config = {{"topics", result.topics}, {"pose_of", value_to_json(foreign.pose_of)}};
  foreign.on_live_topics = true;
  foreign.messages = {{"lost", live.lost()}, {"bad", poses.bad()}};
  if (live.lost() > 0) log.warn(fmt::format("{} messages were lost", live.lost()));
  stages::write_foreign_run(foreign, rig, *stages::returns_of(request, rig, out, parallel), request,
                            out, parallel);
  return result.live.size();
}

}  // namespace lidarena::live
