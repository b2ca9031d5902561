// SPDX-License-Identifier: BSD-3-Clause
// A SLAM node's results become a RUN folder.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/run_files.hpp"
#include "tests/dds/live_helpers.hpp"
#include "tests/dds/same_poses.hpp"

namespace lidarena::dds {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A node that publishes poses, one each 0.1 s of sensor time.
class PoseNode {
 public:
  explicit PoseNode(const LiveOptions& options) : out_(options) {}

  std::uint16_t odometry(const std::string& topic) {
    return out_.add_topic(topic, dataset::ros::kOdometry, false);
  }
  std::uint16_t path(const std::string& topic) {
    return out_.add_topic(topic, dataset::ros::kPath, false);
  }
  void wait_for(std::uint16_t topic, std::size_t subscribers = 1) const {
    wait_for_subscribers(out_, topic, subscribers);
  }

  void send(std::uint16_t topic, double seconds, const Pose& pose) {
    dataset::ros::encode_odometry({from_seconds(seconds), pose}, {"odom", "base_link"}, message_);
    send(topic, text_of(message_.bytes()));
  }
  void send_path(std::uint16_t topic, const std::vector<StampedPose>& poses) {
    message_.clear();
    dataset::ros::put_header(poses.back().stamp, "odom", message_);
    message_.put(static_cast<std::uint32_t>(poses.size()));
    for (const StampedPose& pose : poses) {
      dataset::ros::put_header(pose.stamp, "odom", message_);
      const Eigen::Vector3d t = pose.world_from_body.translation();
      const Eigen::Quaterniond q(pose.world_from_body.linear());
      for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()})
        message_.put(value);
    }
    send(topic, text_of(message_.bytes()));
  }
  void send(std::uint16_t topic, const std::string& bytes) {
    out_.write(topic, Time{1}, Time{1}, std::as_bytes(std::span(bytes)));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  /// The bytes of a pose.
  std::string message(double seconds, const Pose& pose) {
    dataset::ros::encode_odometry({from_seconds(seconds), pose}, {"odom", "base_link"}, message_);
    return text_of(message_.bytes());
  }
  void close() { out_.close(); }

 private:
  LiveWriter out_;
  dataset::MessageWriter message_;
};

Pose at_x(double x) {
  Pose pose = Pose::Identity();
  pose.translation().x() = x;
  return pose;
}

TEST(RecordRun, ANodesPosesAndMapAreScoredLikeARunOnTheFile) {
  const LiveCalls live;
  live.simulate("data", 2.0);
  ASSERT_EQ(live.call("run kiss_icp " + live.path("data") + " --out " + live.path("file")), 0);
  Program record = live.start("record --truth " + live.path("data") +
                                  " --points-topic lidarena/points --idle 4 --name kiss --out " +
                                  live.path("recorded"),
                              "record.txt");
  Program node = live.start(
      "run kiss_icp --live --idle 4 --sensor livox_mid360 --out " + live.path("node"), "node.txt");
  Program play = live.start("play --wait 4 " + live.path("data"), "play.txt");
  EXPECT_EQ(play.wait(), 0) << live.text("play.txt");
  EXPECT_EQ(node.wait(), 0) << live.text("node.txt");
  ASSERT_EQ(record.wait(), 0) << live.text("record.txt");

  const auto file = dataset::read_run(live.path("file"));
  const auto recorded = dataset::read_run(live.path("recorded"));
  EXPECT_EQ(recorded.live.size(), 20U);
  expect_same_poses(recorded.live, file.live);
  EXPECT_EQ(dataset::read_bytes(live.path("recorded/map.ply")),
            dataset::read_bytes(live.path("node/map.ply")));
  EXPECT_EQ(recorded.manifest.algorithm, "kiss");
  EXPECT_EQ(recorded.manifest.sensor, "livox_mid360");
  EXPECT_EQ(recorded.manifest.messages.at("lost"), 0);

  for (const char* run : {"file", "recorded"})
    ASSERT_EQ(live.call("evaluate " + live.path(run)), 0) << live.text("log.txt");
  const Json of_file = dataset::read_json(live.path("file/metrics.json"));
  const Json of_node = dataset::read_json(live.path("recorded/metrics.json"));
  EXPECT_EQ(of_node.at("status"), "ok");
  for (const Json::json_pointer& figure : {"/live/ate/first_pose/translation/rmse_m"_json_pointer,
                                           "/maps/own/first_pose/distance/rmse_m"_json_pointer}) {
    EXPECT_NEAR(of_node.at(figure).get<double>(), of_file.at(figure).get<double>(), 1e-4)
        << figure.to_string();
  }
  // The node does not tell its motion within the scans, so that a part of the returns lies
  // elsewhere.
  EXPECT_GT(5 * recorded.reprojected.points.size(), 4 * file.reprojected.points.size());
}

TEST(RecordRun, WhatIsNoPoseIsLeftOutCountedAndSaid) {
  const LiveCalls live;
  live.simulate("data", 2.0, " --no-data");
  PoseNode node(live.options());
  const auto odom = node.odometry("/odom");
  Program record = live.start(
      "record --truth " + live.path("data") + " --pose-of body --out " + live.path("run"),
      "record.txt");
  node.wait_for(odom);
  for (int i = 1; i <= 5; ++i) node.send(odom, 0.1 * i, at_x(0.01 * i));
  const std::string good = node.message(0.6, at_x(0.06));
  node.send(odom, good.substr(0, 40));                                    // cut off
  node.send(odom, 0.61, at_x(std::numeric_limits<double>::quiet_NaN()));  // no number
  Pose scaled = at_x(0.06);
  std::string squeezed = node.message(0.62, scaled);
  squeezed.replace(squeezed.size() - 8 * (36 + 6 + 36) - 8, 8, 8, '\0');  // w = 0
  node.send(odom, squeezed);
  node.send(odom, 0.3, at_x(0.03));  // back in time
  node.send(odom, 0.5, at_x(0.05));  // once more
  for (int i = 6; i <= 10; ++i) node.send(odom, 0.1 * i, at_x(0.01 * i));
  node.close();
  ASSERT_EQ(record.wait(), 0) << live.text("record.txt");
  const auto run = dataset::read_run(live.path("run"));
  ASSERT_EQ(run.live.size(), 10U);
  EXPECT_NEAR(run.live.poses()[5].world_from_body.translation().x(), 0.06, 1e-9);
  EXPECT_EQ(run.manifest.messages.at("bad").at("/odom"), 5);
  EXPECT_THAT(live.text("record.txt"),
              AllOf(HasSubstr("5 messages are left out"), HasSubstr("shorter than its type")));
}

TEST(RecordRun, FinalPosesAreThoseOfThePathThatWasNamed) {
  const LiveCalls live;
  live.simulate("data", 2.0, " --no-data");
  PoseNode node(live.options());
  const auto odom = node.odometry("/odom"), other = node.odometry("/other");
  const auto path = node.path("/path");
  Program unnamed = live.start(
      "record --truth " + live.path("data") + " --out " + live.path("none"), "unnamed.txt");
  Program record = live.start("record --truth " + live.path("data") +
                                  " --odometry-topic /odom --path-topic path --pose-of body "
                                  "--out " +
                                  live.path("run"),
                              "record.txt");
  node.wait_for(other);
  for (const auto topic : {odom, path}) node.wait_for(topic, 2);
  std::vector<StampedPose> poses;
  for (int i = 1; i <= 10; ++i) {
    node.send(odom, 0.1 * i, at_x(0.01 * i));
    node.send(other, 0.1 * i, at_x(1.0));
    poses.push_back({from_seconds(0.1 * i), at_x(0.01 * i)});
    for (StampedPose& pose : poses) pose.world_from_body.translation().y() = 0.1 * i;  // revised
    node.send_path(path, poses);
  }
  node.close();
  ASSERT_EQ(record.wait(), 0) << live.text("record.txt");
  const auto run = dataset::read_run(live.path("run"));
  ASSERT_EQ(run.trajectory.size(), 10U);
  ASSERT_EQ(run.live.size(), 10U);
  EXPECT_NEAR(run.trajectory.poses()[2].world_from_body.translation().y(), 1.0, 1e-9);
  EXPECT_NEAR(run.live.poses()[2].world_from_body.translation().y(), 0.0, 1e-9);
  EXPECT_EQ(unnamed.wait(), 2);
  EXPECT_THAT(live.text("unnamed.txt"),
              AllOf(HasSubstr("/odom, /other"), HasSubstr("--odometry-topic")));
  EXPECT_FALSE(fs::exists(live.path("none/manifest.json")));
}

TEST(RecordRun, WithoutAPoseItSaysWhatWasSeen) {
  const LiveCalls live;
  live.simulate("data", 1.0, " --no-data");
  LiveWriter writer(live.options());
  writer.add_topic("/camera", dataset::ros::kString, false);
  EXPECT_EQ(live.call("record --first-limit 4 --truth " + live.path("data") + live.domain() +
                      " --odometry-topic /odom --out " + live.path("run")),
            1);
  EXPECT_THAT(live.text("log.txt"),
              AllOf(HasSubstr("no pose came on /odom"), HasSubstr("/camera [std_msgs/msg/String]"),
                    HasSubstr("ROS_DOMAIN_ID")));
  EXPECT_FALSE(fs::exists(live.path("run")));
}

TEST(RecordRun, ADatasetWithoutTruthIsRefusedAtOnce) {
  const LiveCalls live;
  write_all(*dataset::create_recording(live.path("a.mcap"), {}), samples());
  EXPECT_EQ(live.call("record --truth " + live.path("a.mcap") + " --out " + live.path("run")), 2);
  EXPECT_THAT(live.text("log.txt"), HasSubstr("contains no truth"));
}

}  // namespace
}  // namespace lidarena::dds
