// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/live/run_live.hpp"

#include <fmt/format.h>

#include <array>

#include "adapters/dds/live_writer.hpp"
#include "adapters/live/interrupt.hpp"
#include "adapters/live/live_events.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/run_files.hpp"
#include "lidarena/estimation/imu_at_rest.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "lidarena/stages/recorder.hpp"

namespace lidarena::live {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMapFrame = "map";    // level, corrected by loops: jumps
constexpr const char* kOdomFrame = "odom";  // continuous (REP 105)
/// Before the name of the body's frame, which has another parent if the true poses are published.
constexpr const char* kFramePrefix = "lidarena/";
constexpr const char* kOdometryTopic = "/lidarena/odometry";
constexpr const char* kCloudTopic = "/lidarena/points";

/// Covariance as nav_msgs/msg/Odometry has it: both blocks along the axes of the world. Ours has
/// the rotation about the body's axes.
Eigen::Matrix<double, 6, 6> along_world(const Eigen::Matrix<double, 6, 6>& covariance,
                                        const Eigen::Matrix3d& world_from_body) {
  auto turned = Eigen::Matrix<double, 6, 6>::Identity().eval();
  turned.bottomRightCorner<3, 3>() = world_from_body;
  return turned * covariance * turned.transpose();
}

/// Publishes the result of each scan: Odometry and the transforms map <- odom <- body, and the
/// registered cloud. Passes everything on to the recorder of the run.
class Publisher final : public odometry::RunObserver {
 public:
  Publisher(const odometry::Odometry& odometry, const std::string& body_frame, dds::LiveWriter& out,
            odometry::RunObserver& recorder)
      : odometry_(odometry),
        body_frame_(kFramePrefix + body_frame),
        out_(out),
        recorder_(recorder),
        poses_(out.add_topic(kOdometryTopic, dataset::ros::kOdometry, false)),
        transforms_(out.add_topic("/tf", dataset::ros::kTfMessage, false)),
        clouds_(out.add_topic(kCloudTopic, dataset::ros::kPointCloud2, false)) {}

  void take(const ImuSample& sample) override { recorder_.take(sample); }
  void take(const Scan& scan, const odometry::ScanResult& result,
            const odometry::ScanCost& cost) override {
    publish(result);
    recorder_.take(scan, result, cost);
  }

 private:
  void publish(const odometry::ScanResult& result) {
    const Time stamp = result.estimate.stamp;
    const Pose odom_from_world = result.world_from_odom.inverse();
    const StampedPose pose{stamp, odom_from_world * result.estimate.world_from_body};
    dataset::ros::OdometryFrames frames{kOdomFrame, body_frame_, {}};
    if (result.covariance) {
      auto in_odom = Eigen::Matrix<double, 6, 6>::Identity().eval();
      in_odom.topLeftCorner<3, 3>() = odom_from_world.linear();
      frames.covariance = along_world(in_odom * *result.covariance * in_odom.transpose(),
                                      pose.world_from_body.linear());
    }
    dataset::ros::encode_odometry(pose, frames, message_);
    out_.write(poses_, stamp, stamp, message_.bytes());

    if (result.up) leveled_.linear() = estimation::level_rotation(result.up->direction);
    const std::array transforms{
        dataset::ros::StampedTransform{stamp, kOdomFrame, body_frame_, pose.world_from_body},
        dataset::ros::StampedTransform{stamp, kMapFrame, kOdomFrame,
                                       leveled_ * result.world_from_odom}};
    dataset::ros::encode_transforms(transforms, message_);
    out_.write(transforms_, stamp, stamp, message_.bytes());

    Scan cloud{stamp, {}, false};
    for (const Eigen::Vector3f& position : odometry_.registered_scan())
      cloud.points.emplace_back().position = position;
    dataset::ros::encode_scan(cloud, kOdomFrame, message_);
    out_.write(clouds_, stamp, stamp, message_.bytes());
  }

  const odometry::Odometry& odometry_;
  std::string body_frame_;
  dds::LiveWriter& out_;
  odometry::RunObserver& recorder_;
  std::uint16_t poses_, transforms_, clouds_;
  Pose leveled_ = Pose::Identity();  ///< from the world
  dataset::MessageWriter message_;
};

Rig rig_of(const std::string& name, const stages::ConfigFolder& configs) {
  if (name.empty()) {
    throw InputError("run --live", "needs the sensor that publishes",
                     "name it with --sensor; see lidarena list sensors");
  }
  return sensor::make_rig({sensor::load_sensor(configs.resolve("sensors", name))});
}

/// Where the sensor's measurements come from.
dataset::RecordedSensors topics_of(const LiveRun& run, const LidarInfo& lidar, const ImuInfo* imu) {
  dataset::RecordedSensors topics;
  const auto or_usual = [](const std::string& topic, const std::string& usual) {
    return topic.empty() ? usual : topic;
  };
  topics.lidars[or_usual(run.points_topic, "/" + lidar.id + "/points")] = lidar.id;
  if (imu != nullptr) topics.imus[or_usual(run.imu_topic, "/" + imu->id + "/imu")] = imu->id;
  return topics;
}

dds::LiveReaderOptions reading_of(const LiveRun& run, const dataset::RecordedSensors& sensors) {
  dds::LiveReaderOptions reading;
  for (const auto& [topic, id] : sensors.lidars) {
    reading.topics.insert(topic);
    if (run.queue > 0) reading.waiting[topic] = run.queue;
  }
  for (const auto& [topic, id] : sensors.imus) reading.topics.insert(topic);
  reading.idle = std::chrono::milliseconds(static_cast<int>(1e3 * run.idle_s));
  reading.stopped = end_on_interrupt();
  return reading;
}

}  // namespace

odometry::RunSummary run_live(const LiveRun& run, const stages::RunRequest& request,
                              const stages::ConfigFolder& configs, const fs::path& out,
                              const Parallel& parallel, LogSink& log) {
  const odometry::OdometryRequest chosen = odometry::with_default_preset(request.odometry);
  Rig rig = rig_of(request.read.sensor, configs);
  if (request.read.body_from_lidar)
    rig.lidars.front().body_from_lidar = *request.read.body_from_lidar;
  const LidarInfo& lidar = rig.lidars.front();
  const odometry::MadeOdometry made = odometry::make_odometry(chosen, rig, lidar.id, parallel);
  const ImuInfo* imu = made.odometry->traits().needs_imu ? rig.imu_beside(lidar) : nullptr;
  const dds::LiveOptions live{run.domain, run.network};
  dds::LiveWriter writer(live);
  stages::Recorder recorder(*made.odometry, log);
  Publisher publisher(*made.odometry, rig.body_frame, writer, recorder);
  const dataset::RecordedSensors sensors = topics_of(run, lidar, imu);
  LiveEvents events(live, reading_of(run, sensors), sensors,
                    imu == nullptr ? std::vector<std::string>{} : std::vector{imu->id}, log);
  odometry::RunOptions options;
  options.lidar_id = lidar.id;
  if (imu != nullptr) options.imu_id = imu->id;
  for (const auto& [topic, id] : sensors.lidars) log.info("waits for " + topic);
  const odometry::RunSummary summary =
      odometry::run(*made.odometry, events, options, publisher, log);
  writer.close();
  dataset::RunFiles files = recorder.finish(summary.diverged);
  const Json messages = events.summary();
  if (events.lost() > 0)
    log.warn(fmt::format("messages were lost or dropped: {}", messages.at("lost").dump()));
  files.manifest =
      stages::manifest_of(chosen, made.config, made.odometry->traits(),
                          stages::manifest_of(summary, lidar, request.dataset, out, parallel));
  files.manifest.live = true;
  files.manifest.messages = messages;
  dataset::write_run(out, files);
  return summary;
}

}  // namespace lidarena::live
