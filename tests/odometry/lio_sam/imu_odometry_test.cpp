// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/imu_odometry.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace lidarena::odometry::lio_sam {
namespace {

using Eigen::Vector3d;

constexpr double kPeriod = 0.1;  // s, of the scans

/// The port's noise, with the data's gravity.
Config config_of() {
  Config config = indoor(LidarInfo{});
  config.gravity = 9.81;
  return config;
}

Pose at(double x) { return make_pose(Eigen::Matrix3d::Identity(), {x, 0.0, 0.0}); }

/// An IMU and scan matching of a body that flies along x with constant velocity; every second scan
/// is registered.
class Flight {
 public:
  explicit Flight(double velocity) : velocity_(velocity) {
    for (int i = 0; i < 2000; ++i)
      odometry_.register_imu({from_seconds(0.005 * i), Vector3d::Zero(), {0.0, 0.0, 9.81}});
    EXPECT_TRUE(odometry_.is_ready(from_seconds(0.5)));
  }
  /// Registers the next scan, `off` m beside its place. Returns whether there was a pose before.
  bool step(double off = 0.0) {
    odometry_.advance(from_seconds(seconds_));
    const bool spoke = odometry_.odom_from_lidar().has_value();
    odometry_.send(at(velocity_ * seconds_ + off), false);
    seconds_ += 2.0 * kPeriod;
    return spoke;
  }
  double place() const { return velocity_ * (seconds_ - 2.0 * kPeriod); }
  ImuOdometry& odometry() { return odometry_; }

 private:
  double velocity_;
  double seconds_ = 1.0;
  ImuOdometry odometry_{config_of(), Pose::Identity(), kPeriod};
};

TEST(LioSamImuOdometry, SpeaksFromTheSecondPoseOnWhichArrivesThreeScansLate) {
  Flight flight(1.0);
  std::vector<bool> spoke;
  for (int i = 0; i < 5; ++i) spoke.push_back(flight.step());
  EXPECT_EQ(spoke, (std::vector<bool>{false, false, false, true, true}));
}

TEST(LioSamImuOdometry, LearnsTheVelocityFromThePoses) {
  Flight flight(2.0);
  for (int i = 0; i < 10; ++i) flight.step();
  const std::optional<Pose> pose = flight.odometry().odom_from_lidar();
  ASSERT_TRUE(pose.has_value());
  EXPECT_NEAR(pose->translation().x(), flight.place(), 1e-3);
}

TEST(LioSamImuOdometry, AfterAResetItIsSilentUntilTheSecondPose) {
  Flight flight(1.0);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(flight.step(), i >= 3);
  EXPECT_EQ(flight.odometry().resets(), 0U);
  flight.step(50.0);  // 50 m in 0.2 s: beyond 30 m/s
  EXPECT_TRUE(flight.step(50.0)) << "that pose has not arrived yet";
  EXPECT_FALSE(flight.step(50.0));
  EXPECT_EQ(flight.odometry().resets(), 1U);
  EXPECT_FALSE(flight.step(50.0)) << "one pose, no velocity yet";
  EXPECT_TRUE(flight.step(50.0));
  EXPECT_NEAR(flight.odometry().odom_from_lidar()->translation().x(), flight.place() + 50.0, 0.05);
}

TEST(LioSamImuOdometry, ANonsensicalPoseResetsItToo) {
  Flight flight(1.0);
  for (int i = 0; i < 6; ++i) flight.step();
  flight.step(std::numeric_limits<double>::quiet_NaN());
  flight.step();
  flight.step();
  EXPECT_EQ(flight.odometry().resets(), 1U);
  flight.step();
  EXPECT_TRUE(flight.step());
}

TEST(LioSamImuOdometry, TheTrackHasTheRatesAsMeasured) {
  Flight flight(1.0);
  for (int i = 0; i < 6; ++i) flight.step();
  const estimation::ImuTrack track = flight.odometry().track(from_seconds(2.0 + kPeriod));
  ASSERT_GE(track.size(), 20U);
  EXPECT_EQ(track.front().begin, from_seconds(2.0));
  for (const estimation::ImuStep& step : track) EXPECT_TRUE(step.rate.isZero());
}

TEST(LioSamImuOdometry, TooFewSamplesAreNoStart) {
  ImuOdometry odometry(config_of(), Pose::Identity(), kPeriod);
  EXPECT_FALSE(odometry.is_ready(from_seconds(1.0)));
  for (int i = 0; i < 9; ++i)
    odometry.register_imu({from_seconds(0.005 * i), Vector3d::Zero(), {0.0, 0.0, 1.0}});
  EXPECT_FALSE(odometry.is_ready(from_seconds(1.0)));
  odometry.register_imu({from_seconds(0.2), Vector3d::Zero(), {0.0, 0.0, 1.0}});
  EXPECT_TRUE(odometry.is_ready(from_seconds(1.0)));
  EXPECT_EQ(odometry.accel_scale(), 9.81) << "the samples are in g";
}

}  // namespace
}  // namespace lidarena::odometry::lio_sam
