// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/trajectories/recorded_trajectory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/recording.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

class RecordedTrajectory : public ::testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<RecordingWriter> create() const {
    RecordingOptions options;
    options.format = *recording_format_of(file_);
    return create_recording(file_, options);
  }
  static StampedPose pose(int i) {
    return {1'700'000'000s + i * 100ms,
            make_pose(Eigen::Quaterniond(0.8, 0.0, 0.6, 0.0), Eigen::Vector3d(i, 2.0, -1.0))};
  }
  /// Odometry of a rig named `child`.
  static void put_odometry(RecordingWriter& out, std::uint16_t topic, int i, Time late = 0ms) {
    MessageWriter message(out.encoding());
    StampedPose written = pose(i);
    written.stamp += late;
    ros::encode_odometry(written, {"map", "lidar"}, message);
    out.write(topic, written.stamp, written.stamp, message.bytes());
  }
  static void put_pose_stamped(RecordingWriter& out, std::uint16_t topic, int i, double x) {
    MessageWriter message(out.encoding());
    ros::put_header(pose(i).stamp, "odom", message);
    for (const double value : {x, 2.0, -1.0, 0.0, 0.6, 0.0, 0.8}) message.put(value);
    out.write(topic, pose(i).stamp, pose(i).stamp, message.bytes());
  }
  std::string error_message(const std::string& topic = {}) const {
    try {
      read_recorded_trajectory(file_, topic);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }

  TemporaryFolder folder_;
  fs::path file_ = folder_.path() / (std::string("poses") + GetParam());
};

TEST_P(RecordedTrajectory, OdometryIsReadWithItsFrames) {
  auto out = create();
  const auto topic = out->add_topic("/slam/odometry", ros::kOdometry);
  for (int i = 0; i < 20; ++i) put_odometry(*out, topic, i);
  out->close();
  const FramedTrajectory read = read_recorded_trajectory(file_);
  ASSERT_EQ(read.trajectory.size(), 20U);
  EXPECT_EQ(read.world, "map");
  EXPECT_EQ(read.body, "lidar");
  for (int i = 0; i < 20; ++i) {
    const StampedPose& found = read.trajectory.poses()[static_cast<std::size_t>(i)];
    EXPECT_EQ(found.stamp, pose(i).stamp);
    EXPECT_TRUE(found.world_from_body.isApprox(pose(i).world_from_body, 1e-15));
  }
  EXPECT_EQ(read_framed_trajectory(file_).trajectory.size(), 20U);
}

TEST_P(RecordedTrajectory, OfSeveralTopicsOneIsToBeChosen) {
  auto out = create();
  const auto odometry = out->add_topic("/slam/odometry", ros::kOdometry);
  const auto mocap = out->add_topic("/mocap/pose", "geometry_msgs/msg/PoseStamped");
  for (int i = 0; i < 5; ++i) put_odometry(*out, odometry, i);
  for (int i = 0; i < 7; ++i) put_pose_stamped(*out, mocap, i, i);
  out->close();
  EXPECT_THAT(error_message(),
              AllOf(HasSubstr("several topics with poses"), HasSubstr("/mocap/pose")));
  EXPECT_THAT(error_message("/slam/pose"), HasSubstr("no poses on topic '/slam/pose'"));
  const FramedTrajectory read = read_recorded_trajectory(file_, "/mocap/pose");
  ASSERT_EQ(read.trajectory.size(), 7U);
  EXPECT_EQ(read.world, "odom");
  EXPECT_EQ(read.body, "");
  EXPECT_TRUE(read.trajectory.poses()[6].world_from_body.isApprox(pose(6).world_from_body, 1e-15));
}

TEST_P(RecordedTrajectory, WhatIsNoTrajectoryIsRefusedInWords) {
  {
    auto out = create();
    const auto topic = out->add_topic("/pose", "geometry_msgs/msg/PoseStamped");
    put_pose_stamped(*out, topic, 0, 0.0);
    put_pose_stamped(*out, topic, 1, std::nan(""));
    out->close();
  }
  EXPECT_THAT(error_message(), AllOf(HasSubstr("/pose message 2"), HasSubstr("not finite")));
  {
    auto out = create();
    const auto topic = out->add_topic("/odometry", ros::kOdometry);
    put_odometry(*out, topic, 1);
    put_odometry(*out, topic, 1);
    out->close();
  }
  EXPECT_EQ(read_framed_trajectory(file_).trajectory.size(), 1U);
  EXPECT_EQ(read_framed_trajectory(file_).repeated.size(), 1U);
  {
    auto out = create();
    const auto topic = out->add_topic("/imu", ros::kImu);
    MessageWriter message(out->encoding());
    ros::put_header(1s, "imu", message);
    out->write(topic, 1s, 1s, message.bytes());
    out->close();
  }
  EXPECT_THAT(error_message(), HasSubstr("has no topic with poses"));
}

INSTANTIATE_TEST_SUITE_P(Formats, RecordedTrajectory, ::testing::Values(".mcap", ".bag"),
                         [](const auto& format) { return std::string(format.param).substr(1); });

class FramesOfText : public ::testing::Test {
 protected:
  FramedTrajectory read(const std::string& text) const {
    return read_framed_trajectory(folder_.write("poses.tum", text));
  }
  TemporaryFolder folder_;
};

TEST_F(FramesOfText, AreNamedByTheCommentsThatLidarenaWrites) {
  const FramedTrajectory ours = read(
      "# final estimate: pose of the body in the world (world_from_body) at the stamped instant\n"
      "# time[s] x y z[m] qx qy qz qw\n1.0 0 0 0 0 0 0 1\n");
  EXPECT_EQ(ours.world, "world");
  EXPECT_EQ(ours.body, "body");
}

TEST_F(FramesOfText, CommentsOfOthersAreNoFrames) {
  for (const char* text : {"# converted_from_rosbag with my script\n1.0 0 0 0 0 0 0 1\n",
                           "#poses_from_vicon\n1.0 0 0 0 0 0 0 1\n",
                           "# time x y z\n1.0 0 0 0 0 0 0 1\n# a_from_b\n"}) {
    const FramedTrajectory unnamed = read(text);
    EXPECT_EQ(unnamed.world + unnamed.body, "") << text;
  }
}

TEST_F(FramesOfText, StampsInOtherUnitsAreRecognized) {
  const auto error_message = [&](const char* stamp) {
    try {
      read(std::string(stamp) + " 0 0 0 0 0 0 1\n");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(error_message("1700000000000000000"),
              AllOf(HasSubstr(":1"), HasSubstr("nanoseconds")));
  EXPECT_THAT(error_message("1700000000000000"), HasSubstr("microseconds"));
  EXPECT_THAT(error_message("1700000000000"), HasSubstr("milliseconds"));
  EXPECT_THAT(error_message("1.7e18"), HasSubstr("nanoseconds"));
  EXPECT_EQ(error_message("1700000000.5"), "");
}

}  // namespace
}  // namespace lidarena::dataset
