// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/run_live.hpp"

#include <fmt/format.h>

#include "adapters/dds/live_writer.hpp"
#include "apps/lidarena/live.hpp"
#include "apps/lidarena/live_events.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/run_files.hpp"
#include "lidarena/sensor/simulate.hpp"

namespace lidarena {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWorldFrame = "odom";
/// Before the name of the body's frame, which has another parent if the true poses are published.
constexpr const char* kFramePrefix = "lidarena/";
constexpr const char* kOdometryTopic = "/lidarena/odometry";
constexpr const char* kCloudTopic = "/lidarena/points";

/// Publishes the result of each scan of another odometry: Odometry, tf and the registered cloud.
class PublishingOdometry final : public odometry::Odometry {
 public:
  PublishingOdometry(odometry::Odometry& odometry, const std::string& body_frame,
                     dds::LiveWriter& out)
      : odometry_(odometry),
        body_frame_(kFramePrefix + body_frame),
        out_(out),
        poses_(out.add_topic(kOdometryTopic, dataset::ros::kOdometry, false)),
        transforms_(out.add_topic("/tf", dataset::ros::kTfMessage, false)),
        clouds_(out.add_topic(kCloudTopic, dataset::ros::kPointCloud2, false)) {}

  odometry::OdometryTraits traits() const override { return odometry_.traits(); }
  void register_imu(const ImuSample& sample) override { odometry_.register_imu(sample); }
  odometry::ScanResult register_scan(const Scan& scan) override {
    odometry::ScanResult result = odometry_.register_scan(scan);
    publish(result.estimate);
    return result;
  }
  void finish() override { odometry_.finish(); }
  Trajectory trajectory() const override { return odometry_.trajectory(); }
  std::vector<Eigen::Vector3f> map() const override { return odometry_.map(); }
  std::span<const Eigen::Vector3f> registered_scan() const override {
    return odometry_.registered_scan();
  }
  Pose world_from_start() const override { return odometry_.world_from_start(); }
  std::map<std::string, std::uint64_t> memory() const override { return odometry_.memory(); }

 private:
  void publish(const StampedPose& estimate) {
    dataset::ros::encode_odometry(estimate, kWorldFrame, body_frame_, message_);
    out_.write(poses_, estimate.stamp, estimate.stamp, message_.bytes());
    const dataset::ros::StampedTransform transform{estimate.stamp, kWorldFrame, body_frame_,
                                                   estimate.world_from_body};
    dataset::ros::encode_transforms(std::span(&transform, 1), message_);
    out_.write(transforms_, estimate.stamp, estimate.stamp, message_.bytes());
    Scan cloud{estimate.stamp, {}, false};
    for (const Eigen::Vector3f& position : odometry_.registered_scan())
      cloud.points.emplace_back().position = position;
    dataset::ros::encode_scan(cloud, kWorldFrame, message_);
    out_.write(clouds_, estimate.stamp, estimate.stamp, message_.bytes());
  }

  odometry::Odometry& odometry_;
  std::string body_frame_;
  dds::LiveWriter& out_;
  std::uint16_t poses_, transforms_, clouds_;
  dataset::MessageWriter message_;
};

Rig rig_of(const std::string& name, const study::ConfigFolder& configs) {
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

Json manifest_of(const odometry::OdometryRequest& chosen, const Json& config,
                 const std::string& lidar_id, const odometry::RunSummary& summary,
                 const Json& messages) {
  return {{"kind", "run"},
          {"algorithm", chosen.algorithm},
          {"preset", chosen.preset},
          {"config", config},
          {"live", true},
          {"messages", messages},
          {"sensor", lidar_id},
          {"status", summary.diverged ? "diverged" : "ok"},
          {"reason", summary.reason},
          {"made_on", study::made_on()},
          {"summary", study::summary_json(summary)}};
}

}  // namespace

void add_live_run(CLI::App& verb, LiveRun& run) {
  verb.add_flag("--live", run.asked,
                "Run on live topics of --sensor (a name of list sensors) and publish the poses");
  verb.add_option("--points-topic", run.points_topic, "With --live; default: /SENSOR/points");
  verb.add_option("--idle", run.idle_s,
                  "With --live: ends when nothing came for so many seconds after the first message")
      ->check(CLI::NonNegativeNumber);
  verb.add_option(
          "--queue", run.queue,
          "With --live: scans that may wait while the algorithm is busy; of more, the oldest "
          "are dropped; 0: all wait")
      ->check(CLI::NonNegativeNumber);
  verb.add_option("--domain", run.domain, "With --live: DDS domain; default: ROS_DOMAIN_ID, else 0")
      ->check(CLI::Range(0, 232));
  verb.add_flag("--network", run.network, "With --live: reach other machines, too");
}

odometry::RunSummary run_live(const LiveRun& run, const study::RunRequest& request,
                              const study::ConfigFolder& configs, const fs::path& out,
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
  PublishingOdometry published(*made.odometry, rig.body_frame, writer);
  const dataset::RecordedSensors sensors = topics_of(run, lidar, imu);
  LiveEvents events(live, reading_of(run, sensors), sensors,
                    imu == nullptr ? std::vector<std::string>{} : std::vector{imu->id}, log);
  odometry::RunOptions options;
  options.lidar_id = lidar.id;
  if (imu != nullptr) options.imu_id = imu->id;
  for (const auto& [topic, id] : sensors.lidars) log.info("waits for " + topic);
  odometry::RunResult result = odometry::run(published, events, options, log);
  writer.close();
  const Json messages = events.summary();
  if (events.lost() > 0)
    log.warn(fmt::format("messages were lost or dropped: {}", messages.at("lost").dump()));
  result.files.manifest = manifest_of(chosen, made.config, lidar.id, result.summary, messages);
  if (!request.dataset.empty()) {
    result.files.manifest["dataset"] =
        fs::proximate(fs::absolute(request.dataset), fs::absolute(out)).generic_string();
  }
  dataset::write_run(out, result.files);
  return result.summary;
}

}  // namespace lidarena
