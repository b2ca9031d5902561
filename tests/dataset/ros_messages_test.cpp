// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/messages/ros_messages.hpp"

#include <gmock/gmock.h>

#include "lidarena/base/error.hpp"
#include "tests/dataset/event_matching.hpp"
#include "tests/dataset/sample_events.hpp"

namespace lidarena::dataset::ros {
namespace {

TEST(Ros2Messages, AScanComesBackBitByBit) {
  const Scan scan = sample::scan(3, 1000);
  MessageWriter out;
  encode_scan(scan, "mid360", out);
  expect_same(decode_scan(out.bytes(), "test"), scan);
}

TEST(Ros2Messages, AScanWithoutTimesStaysSo) {
  Scan scan = sample::scan(3, 10);
  scan.timed = false;
  for (Point& point : scan.points) point.dt_ns = 0;
  MessageWriter out;
  encode_scan(scan, "mid360", out);
  expect_same(decode_scan(out.bytes(), "test"), scan);
}

TEST(Ros2Messages, AnEmptyScanComesBackEmpty) {
  const Scan scan{Time{5}, {}, true};
  MessageWriter out;
  encode_scan(scan, "mid360", out);
  expect_same(decode_scan(out.bytes(), "test"), scan);
}

TEST(Ros2Messages, ThePaddingOfPointsIsWrittenAsZero) {
  Scan scan = sample::scan(0, 2);
  MessageWriter clean;
  encode_scan(scan, "mid360", clean);
  const std::vector<std::byte> expected(clean.bytes().begin(), clean.bytes().end());
  for (Point& point : scan.points) reinterpret_cast<unsigned char*>(&point)[23] = 0xAB;
  MessageWriter dirty;
  encode_scan(scan, "mid360", dirty);
  EXPECT_TRUE(std::ranges::equal(dirty.bytes(), expected));
}

TEST(Ros2Messages, APointBeforeItsScansStampIsRefused) {
  Scan scan = sample::scan(0, 2);
  scan.points[0].dt_ns = -1;
  MessageWriter out;
  EXPECT_THROW(encode_scan(scan, "mid360", out), InputError);
}

TEST(Ros2Messages, AnImuSampleComesBackBitByBit) {
  MessageWriter out;
  encode_imu(sample::imu(17), "imu", out);
  expect_same(decode_imu(out.bytes(), "test"), sample::imu(17));
}

TEST(Ros2Messages, APoseComesBackToTheLastDigitsOfItsQuaternion) {
  MessageWriter out;
  const StampedPose pose = sample::truth(77);
  encode_odometry(pose, {"world", "body"}, out);
  const StampedPose back = decode_odometry(out.bytes(), "test");
  EXPECT_EQ(back.stamp, pose.stamp);
  EXPECT_EQ(back.world_from_body.translation(), pose.world_from_body.translation());
  // matrix to quaternion and back: a few roundings
  EXPECT_TRUE(back.world_from_body.linear().isApprox(pose.world_from_body.linear(), 1e-15));
}

TEST(Ros2Messages, TransformsComeBack) {
  const std::vector<StampedTransform> transforms{
      {Time{1}, "world", "body", sample::truth(5).world_from_body},
      {Time{2}, "body", "a name of odd length", sample::rig().lidars[0].body_from_lidar}};
  MessageWriter out;
  encode_transforms(transforms, out);
  const std::vector<StampedTransform> back = decode_transforms(out.bytes(), "test");
  ASSERT_EQ(back.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back[i].stamp, transforms[i].stamp);
    EXPECT_EQ(back[i].parent, transforms[i].parent);
    EXPECT_EQ(back[i].child, transforms[i].child);
    EXPECT_TRUE(back[i].parent_from_child.isApprox(transforms[i].parent_from_child, 1e-15));
  }
}

TEST(Ros2Messages, EveryShorterMessageIsBadInputAndNoCrash) {
  MessageWriter out;
  encode_scan(sample::scan(0, 3), "mid360", out);
  // Only is_dense, the last byte, is not read.
  for (std::size_t size = 0; size + 1 < out.bytes().size(); ++size) {
    EXPECT_THROW(decode_scan(out.bytes().first(size), "test"), InputError) << size;
  }
}

TEST(Ros2Messages, AStampBeyond2038DoesNotFit) {
  MessageWriter out;
  EXPECT_THROW(encode_imu({.stamp = std::chrono::seconds(std::int64_t{1} << 31)}, "imu", out),
               InputError);
}

TEST(Ros2Messages, DefinitionsBringAlongWhatTheyUse) {
  const std::string separator(80, '=');
  EXPECT_EQ(
      definition_of(kTfMessage),
      "geometry_msgs/TransformStamped[] transforms\n" + separator +
          "\nMSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\n"
          "string child_frame_id\ngeometry_msgs/Transform transform\n" +
          separator + "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" +
          separator + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n" + separator +
          "\nMSG: geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\n"
          "geometry_msgs/Quaternion rotation\n" +
          separator + "\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n" +
          separator +
          "\nMSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\n"
          "float64 w 1\n");
  EXPECT_THAT(definition_of(kOdometry), testing::HasSubstr("MSG: geometry_msgs/Point\n"));
  EXPECT_THROW(definition_of("std_msgs/msg/Empty"), InputError);
}

}  // namespace
}  // namespace lidarena::dataset::ros
