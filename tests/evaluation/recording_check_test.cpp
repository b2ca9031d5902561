// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/diagnosis/recording_check.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"

namespace lidarena::evaluation {
namespace {

using std::chrono::milliseconds;
using testing::Contains;
using testing::IsEmpty;

/// Angular rate of a body that turns about all axes after a second of rest, rad/s.
Eigen::Vector3d rate_at(double t) {
  if (t < 1.0) return Eigen::Vector3d::Zero();
  const double s = t - 1.0;
  return {0.4 * std::sin(2.0 * s), 0.3 * std::sin(3.1 * s), 0.8 * std::sin(1.3 * s)};
}

std::vector<ImuSample> samples_of(
    double seconds, double late_s = 0.0,
    const Eigen::Matrix3d& imu_from_body = Eigen::Matrix3d::Identity()) {
  SequentialRandom random(7);
  std::vector<ImuSample> samples;
  for (int i = 0; 0.005 * i < seconds; ++i) {
    const double t = 0.005 * i;
    const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
    samples.push_back({from_seconds(t + late_s), imu_from_body * (rate_at(t) + 0.002 * noise),
                       Eigen::Vector3d(0.0, 0.0, 9.80665) + 0.02 * noise});
  }
  return samples;
}

/// Poses ten times a second, by integrating the rate in steps of 1 ms.
Trajectory trajectory_of(double seconds) {
  std::vector<StampedPose> poses;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  for (int i = 0; 0.001 * i < seconds; ++i) {
    if (i % 100 == 0)
      poses.push_back({milliseconds(i), make_pose(Eigen::Quaterniond(rotation), {0.0, 0.0, 0.0})});
    rotation = rotation * so3::exp(0.001 * rate_at(0.001 * i + 0.0005));
  }
  return Trajectory(std::move(poses));
}

Scan sweep_at(Time stamp, std::size_t points = 1000) {
  return {stamp, std::vector<Point>(points), true};
}

RecordingCheck check_of(const std::vector<ImuSample>& samples, int sweeps = 200) {
  RecordingCheck check;
  for (const ImuSample& sample : samples) check.add(sample);
  for (int i = 0; i < sweeps; ++i) check.add(sweep_at(i * milliseconds(100)));
  return check;
}

std::vector<std::string> keys_of(const std::vector<Finding>& found) {
  std::vector<std::string> keys;
  for (const Finding& finding : found) keys.push_back(finding.key);
  return keys;
}

/// Without notes, which state what is right, too.
std::vector<Finding> problems_of(std::vector<Finding> found) {
  std::erase_if(found, [](const Finding& finding) { return finding.severity == Severity::kNote; });
  return found;
}

TEST(RecordingCheck, ACleanRecordingHasNoFinding) {
  EXPECT_THAT(keys_of(check_of(samples_of(20.0)).findings()), IsEmpty());
}

TEST(RecordingCheck, GapsAreFoundWithTheirTime) {
  RecordingCheck check;
  for (int i = 0; i < 200; ++i)
    if (i < 50 || i >= 70) check.add(sweep_at(i * milliseconds(100)));
  for (const ImuSample& sample : samples_of(20.0)) {
    const double t = to_seconds(sample.stamp);
    if (t < 3.0 || t > 3.5) check.add(sample);
  }
  const std::vector<Finding> found = check.findings();
  const auto lidar = std::ranges::find(found, "lidar_gap", &Finding::key);
  const auto imu = std::ranges::find(found, "imu_gap", &Finding::key);
  ASSERT_TRUE(lidar != found.end() && imu != found.end());
  EXPECT_NEAR(lidar->value, 2.1, 1e-9);
  EXPECT_NEAR(lidar->from_s, 4.9, 1e-9);
  EXPECT_EQ(lidar->severity, Severity::kFault);
  EXPECT_NEAR(imu->value, 0.51, 0.011);
  EXPECT_NEAR(imu->from_s, 3.0, 0.01);
}

TEST(RecordingCheck, TheEndOfTheRangeOfAnImuIsFoundAndAPeakIsNone) {
  std::vector<ImuSample> samples = samples_of(20.0);
  samples[1000].accel.x() = 40.0;  // one peak
  EXPECT_THAT(keys_of(check_of(samples).findings()), IsEmpty());
  for (std::size_t i = 2000; i < 2010; ++i) samples[i].accel.y() = -156.9;
  const std::vector<Finding> found = check_of(samples).findings();
  const auto saturated = std::ranges::find(found, "imu_saturated", &Finding::key);
  ASSERT_NE(saturated, found.end());
  EXPECT_NEAR(saturated->value, 156.9, 1e-9);
  EXPECT_NEAR(saturated->from_s, 10.0, 0.01);
}

TEST(RecordingCheck, AnImuThatDoesNotCoverTheSweepsOrLacksGravityIsAFault) {
  std::vector<ImuSample> part = samples_of(20.0);
  std::erase_if(part, [](const ImuSample& s) {
    return s.stamp < std::chrono::seconds(3) || s.stamp > std::chrono::seconds(15);
  });
  const std::vector<Finding> found = check_of(part).findings();
  EXPECT_THAT(keys_of(found),
              testing::AllOf(Contains("imu_begins_late"), Contains("imu_ends_early")));
  EXPECT_NEAR(found[0].value, 3.0, 0.01);
  std::vector<ImuSample> free = samples_of(20.0);
  for (ImuSample& sample : free) sample.accel.z() -= 9.80665;
  EXPECT_THAT(keys_of(check_of(free).findings()), Contains("no_gravity"));
}

TEST(RecordingCheck, VibrationIsMeasured) {
  std::vector<ImuSample> samples = samples_of(20.0);
  SequentialRandom random(3);
  for (ImuSample& sample : samples)
    sample.accel += 5.0 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
  const std::vector<Finding> found = check_of(samples).findings();
  const auto vibration = std::ranges::find(found, "vibration", &Finding::key);
  ASSERT_NE(vibration, found.end());
  EXPECT_NEAR(vibration->value, 5.0 * std::sqrt(3.0), 0.3);  // of three axes
}

TEST(RecordingCheck, AStartInMotionABiasAndFastTurnsAreFound) {
  std::vector<ImuSample> moving = samples_of(20.0);
  std::erase_if(moving, [](const ImuSample& s) { return s.stamp < milliseconds(1500); });
  EXPECT_THAT(keys_of(check_of(moving).findings()), Contains("start_in_motion"));
  std::vector<ImuSample> biased = samples_of(20.0);
  for (ImuSample& sample : biased) sample.gyro.y() += 0.05;
  EXPECT_THAT(keys_of(check_of(biased).findings()), Contains("gyro_bias"));
  std::vector<ImuSample> turning = samples_of(20.0);
  for (std::size_t i = 2000; i < 2050; ++i)
    turning[i].gyro.z() = 5.0 + 0.01 * static_cast<double>(i % 7);
  EXPECT_THAT(keys_of(check_of(turning).findings()), Contains("fast_turn"));
}

TEST(RecordingCheck, SweepsOfFewPointsOrWithoutTimesAreFound) {
  RecordingCheck check;
  for (int i = 0; i < 100; ++i) {
    Scan scan = sweep_at(i * milliseconds(100), 100);
    scan.timed = false;
    check.add(scan);
  }
  EXPECT_THAT(keys_of(check.findings()), testing::ElementsAre("few_points", "no_point_times"));
}

TEST(AlignImu, ClocksAndAxesThatAgreeGiveNoFinding) {
  const auto alignment = align_imu(trajectory_of(20.0), samples_of(20.0));
  ASSERT_TRUE(alignment.has_value());
  EXPECT_NEAR(alignment->late_s, 0.0, 1e-3);
  EXPECT_NEAR(so3::angle(alignment->body_from_imu), 0.0, 0.005);
  EXPECT_TRUE(alignment->axes_known);
  EXPECT_THAT(problems_of(check_alignment(*alignment, {}, {})), IsEmpty());
}

TEST(AlignImu, WhatTheMotionShowsIsNotedWhereItIsRight) {
  const auto alignment = align_imu(trajectory_of(20.0), samples_of(20.0));
  ASSERT_TRUE(alignment.has_value());
  const std::vector<Finding> found = check_alignment(*alignment, {}, {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].severity, Severity::kNote);
  EXPECT_NEAR(found[0].value, 0.0, 1.0) << "ms";
}

TEST(AlignImu, ALateClockIsMeasuredWithItsSign) {
  for (const double late_s : {0.05, -0.12, 0.3}) {
    const auto alignment = align_imu(trajectory_of(20.0), samples_of(20.0, late_s));
    ASSERT_TRUE(alignment.has_value());
    EXPECT_NEAR(alignment->late_s, late_s, 2e-3);
    EXPECT_THAT(keys_of(problems_of(check_alignment(*alignment, {}, {}))),
                testing::ElementsAre("imu_delay"));
  }
}

TEST(AlignImu, ATurnedImuIsFoundBesideWhatIsStated) {
  const Eigen::Matrix3d body_from_imu = so3::exp(Eigen::Vector3d(0.0, 0.0, std::numbers::pi / 2.0));
  const auto alignment =
      align_imu(trajectory_of(20.0), samples_of(20.0, 0.0, body_from_imu.transpose()));
  ASSERT_TRUE(alignment.has_value());
  EXPECT_NEAR(so3::angle(alignment->body_from_imu.transpose() * body_from_imu), 0.0, 0.01);
  const std::vector<Finding> found = problems_of(check_alignment(*alignment, {}, {}));
  ASSERT_THAT(keys_of(found), testing::ElementsAre("imu_mounting"));
  EXPECT_NEAR(found[0].value, 90.0, 0.6);
  ImuInfo stated;
  stated.body_from_imu.linear() = body_from_imu;
  EXPECT_THAT(problems_of(check_alignment(*alignment, {}, stated)), IsEmpty());
}

TEST(AlignImu, ADriftingClockIsMeasured) {
  std::vector<ImuSample> samples = samples_of(40.0);
  for (ImuSample& sample : samples) sample.stamp += sample.stamp / 200;  // 0.5 %
  const auto alignment = align_imu(trajectory_of(40.0), samples);
  ASSERT_TRUE(alignment.has_value());
  EXPECT_NEAR(alignment->drift_s, 0.1, 0.02);  // 20 s between the middles of the halves
}

TEST(AlignImu, WithoutTurnsThereIsNothingToCompare) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < 100; ++i) poses.push_back({i * milliseconds(100), Pose::Identity()});
  EXPECT_FALSE(align_imu(Trajectory(poses), samples_of(10.0)).has_value());
}

TEST(AlignImu, AnImuOfAnotherBodyDisagrees) {
  std::vector<ImuSample> samples = samples_of(20.0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = 0.005 * static_cast<double>(i);
    samples[i].gyro = {std::sin(5.7 * t), std::cos(4.3 * t), std::sin(7.9 * t)};
  }
  const auto alignment = align_imu(trajectory_of(20.0), samples);
  ASSERT_TRUE(alignment.has_value());
  EXPECT_THAT(keys_of(problems_of(check_alignment(*alignment, {}, {}))),
              testing::ElementsAre("imu_disagrees"));
}

}  // namespace
}  // namespace lidarena::evaluation
