// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/md5.hpp"

#include <gtest/gtest.h>

#include <string>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"

namespace lidarena::dataset {
namespace {

// RFC 1321, A.5
TEST(Md5, GivesTheTestSuiteOfItsRfc) {
  EXPECT_EQ(md5_of(""), "d41d8cd98f00b204e9800998ecf8427e");
  EXPECT_EQ(md5_of("abc"), "900150983cd24fb0d6963f7d28e17f72");
  EXPECT_EQ(md5_of("abcdefghijklmnopqrstuvwxyz"), "c3fcd3d76192e4007dfb496cca67e13b");
  std::string digits;
  for (int i = 0; i < 8; ++i) digits += "1234567890";
  EXPECT_EQ(md5_of(digits), "57edf4a22be3c955ac49da2e2107b67a");
}

// As `_md5sum` of Debian's python3-sensor-msgs, python3-nav-msgs, python3-tf2-msgs and
// python3-std-msgs has them; that of CustomMsg as recorded bags have it.
TEST(Ros1Types, HaveTheCheckSumsThatRosKnowsThemBy) {
  EXPECT_EQ(ros::ros1_md5_of(ros::kPointCloud2), "1158d486dd51d683ce2f1be655c3c181");
  EXPECT_EQ(ros::ros1_md5_of(ros::kImu), "6a62c6daae103f4ff57a132d6f95cec2");
  EXPECT_EQ(ros::ros1_md5_of(ros::kOdometry), "cd5e73d190d741a2f92e81eda573aca7");
  EXPECT_EQ(ros::ros1_md5_of(ros::kTfMessage), "94810edda583a504dfda3829e70d7eec");
  EXPECT_EQ(ros::ros1_md5_of(ros::kString), "992ce8a1687cec8c8bd883ec73ca41d1");
  EXPECT_EQ(ros::ros1_md5_of("std_msgs/Header"), "2176decaecbce78abc3b96ef049fabed");
  for (const char* driver : {"livox_ros_driver/CustomMsg", "livox_ros_driver2/CustomMsg"}) {
    EXPECT_EQ(ros::ros1_md5_of(driver), "e4d6829bdfe657cb6c21a746c86b21a6");
  }
  EXPECT_THROW(ros::ros1_md5_of("sensor_msgs/Image"), InputError);
}

TEST(Ros1Types, AreNamedWithoutTheMiddlePart) {
  EXPECT_EQ(ros::ros1_name("sensor_msgs/msg/Imu"), "sensor_msgs/Imu");
  EXPECT_EQ(ros::ros2_name("sensor_msgs/Imu"), "sensor_msgs/msg/Imu");
  EXPECT_EQ(ros::ros2_name("sensor_msgs/msg/Imu"), "sensor_msgs/msg/Imu");
}

}  // namespace
}  // namespace lidarena::dataset
