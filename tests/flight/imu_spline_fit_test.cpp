// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/imu_spline_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "lidarena/base/error.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/flight/late_start.hpp"
#include "lidarena/flight/recorded_imu_flight.hpp"
#include "lidarena/flight/recording.hpp"
#include "tests/flight/flight_conformance.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr Time kEpoch = std::chrono::seconds(1'700'000'000);
const Vector3d kGyroBias(0.01, -0.02, 0.07), kAccelBias(0.1, -0.05, 0.2);

/// A swinging and turning motion as a spline with knots every 0.15 s, which the fit can match.
PoseSplineFlight motion() {
  const auto pose_at = [](double t) {
    const Vector3d turned(0.4 * std::sin(0.9 * t), 0.3 * std::cos(0.7 * t), 0.8 * t);
    return make_pose(so3::exp(turned),
                     {2.0 * std::sin(0.8 * t), 1.5 * std::cos(0.6 * t), 1.0 + 0.3 * std::sin(t)});
  };
  return {pose_at, 0.15, std::chrono::seconds(20)};
}

Trajectory poses_of(const Flight& flight, double sigma_m = 0.0) {
  SequentialRandom random(3);
  std::vector<StampedPose> poses;
  for (Time t{0}; t <= flight.duration(); t += std::chrono::milliseconds(50)) {
    Pose pose = flight.pose_at(t);
    for (int axis = 0; axis < 3; ++axis) pose.translation()[axis] += sigma_m * random.normal();
    poses.push_back({kEpoch + t, pose});
  }
  return Trajectory(std::move(poses));
}

/// Samples at 200 Hz of an IMU at the body, by the definition of the specific force.
std::vector<ImuSample> samples_of(const Flight& flight, double gyro_sigma = 0.0,
                                  double accel_sigma = 0.0) {
  SequentialRandom random(4);
  std::vector<ImuSample> samples;
  for (Time t{0}; t <= flight.duration(); t += std::chrono::milliseconds(5)) {
    const Motion at = flight.at(t);
    ImuSample sample{kEpoch + t, at.angular_rate_body + kGyroBias,
                     at.world_from_body.linear().transpose() *
                             (at.acceleration_world + Vector3d(0, 0, kGravity)) +
                         kAccelBias};
    for (int axis = 0; axis < 3; ++axis) {
      sample.gyro[axis] += gyro_sigma * random.normal();
      sample.accel[axis] += accel_sigma * random.normal();
    }
    samples.push_back(sample);
  }
  return samples;
}

struct MotionError {
  double position_m = 0.0, rotation_rad = 0.0, accel_m_s2 = 0.0;
};
MotionError worst(const ImuSplineFit& fit, const Flight& truth) {
  const PoseSplineFlight found(fit.controls, fit.knot_s, fit.duration);
  MotionError most;
  for (Time t = std::chrono::seconds(1); t < std::chrono::seconds(19); t += Time{3'700'000}) {
    const Motion a = found.at(t), b = truth.at(t);
    most.position_m =
        std::max(most.position_m,
                 (a.world_from_body.translation() - b.world_from_body.translation()).norm());
    most.rotation_rad =
        std::max(most.rotation_rad,
                 so3::angle(a.world_from_body.linear().transpose() * b.world_from_body.linear()));
    most.accel_m_s2 =
        std::max(most.accel_m_s2, (a.acceleration_world - b.acceleration_world).norm());
  }
  return most;
}

TEST(ImuSplineFit, FindsAMotionOfItsOwnKindExactly) {
  const PoseSplineFlight truth = motion();
  const ImuSplineFit fit = fit_imu_spline(poses_of(truth), samples_of(truth), {}, "made up");
  const MotionError most = worst(fit, truth);
  EXPECT_LT(most.position_m, 1e-6);
  EXPECT_LT(most.rotation_rad, 1e-6);
  EXPECT_LT(most.accel_m_s2, 1e-3);
  EXPECT_LT((fit.gyro_bias - kGyroBias).norm(), 1e-6);
  EXPECT_LT((fit.accel_bias - kAccelBias).norm(), 1e-4);
  EXPECT_LT(fit.left_out.gyro_rad_s, 1e-4);
  EXPECT_LT(fit.left_out.accel_m_s2, 1e-2);
}

TEST(ImuSplineFit, LeavesTheNoiseInTheResidualsInsideAndLeftOut) {
  const PoseSplineFlight truth = motion();
  const ImuSplineFit fit =
      fit_imu_spline(poses_of(truth, 0.001), samples_of(truth, 0.02, 0.5), {}, "made up");
  // 3,600 values each inside of the fit, 2,400 left out: 4 sigma are 5 and 6 %
  EXPECT_NEAR(fit.fitted.gyro_rad_s, 0.02, 0.05 * 0.02 + 0.001);
  EXPECT_NEAR(fit.left_out.gyro_rad_s, 0.02, 0.06 * 0.02 + 0.001);
  EXPECT_NEAR(fit.fitted.accel_m_s2, 0.5, 0.05 * 0.5 + 0.02);
  EXPECT_NEAR(fit.left_out.accel_m_s2, 0.5, 0.06 * 0.5 + 0.02);
  EXPECT_LT(worst(fit, truth).position_m, 0.004);
}

TEST(ImuSplineFit, FindsTheMotionAcrossMissingPosesFromTheSamples) {
  const PoseSplineFlight truth = motion();
  std::vector<StampedPose> kept;
  const Trajectory all = poses_of(truth);
  for (const StampedPose& pose : all.poses()) {
    const double t = to_seconds(pose.stamp - kEpoch);
    if (t < 9.2 || t > 10.4) kept.push_back(pose);  // second 9 would be left out
  }
  const ImuSplineFit fit =
      fit_imu_spline(Trajectory(std::move(kept)), samples_of(truth), {}, "made up");
  EXPECT_LT(worst(fit, truth).position_m, 1e-4);
}

TEST(ImuSplineFit, SamplesThatDoNotCoverThePosesAreRefused) {
  const PoseSplineFlight truth = motion();
  std::vector<ImuSample> samples = samples_of(truth);
  samples.resize(samples.size() / 2);
  try {
    fit_imu_spline(poses_of(truth), samples, {}, "half.tum");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("half.tum"));
    EXPECT_THAT(e.what(), HasSubstr("do not cover"));
  }
}

ImuSplineFit fit_of_motion() {
  const PoseSplineFlight truth = motion();
  return fit_imu_spline(poses_of(truth), samples_of(truth), {}, "made up");
}

TEST(RecordedImuFlight, GivesTheSamplesOfTheFlightFromItsStart) {
  const std::vector<ImuSample> samples = samples_of(motion());
  const Pose world_from_recording = make_pose(so3::exp({0, 0, 0.7}), {3, 4, 0});
  const Pose recorded_from_body = make_pose(so3::exp({0.3, 0.2, 0}), {0, 0, 0});
  const auto flight = std::make_unique<RecordedImuFlight>(
      fit_of_motion(), samples, kEpoch, world_from_recording, recorded_from_body, "made up");
  EXPECT_LT((flight->pose_at(std::chrono::seconds(7)).matrix() -
             (world_from_recording * motion().pose_at(std::chrono::seconds(7)) * recorded_from_body)
                 .matrix())
                .norm(),
            1e-5);
  ASSERT_NE(flight->recorded_imu(), nullptr);
  ASSERT_EQ(flight->recorded_imu()->samples.size(), samples.size());
  EXPECT_EQ(flight->recorded_imu()->samples[10].stamp, samples[10].stamp - kEpoch);
  EXPECT_EQ(flight->recorded_imu()->samples[10].accel, samples[10].accel);
  conformance::expect_pose_at_is_the_pose_of_at(*flight, std::chrono::milliseconds(37));
  conformance::expect_rest_outside(*flight);
}

TEST(RecordedImuFlight, ALateStartShiftsTheSamples) {
  const std::vector<ImuSample> samples = samples_of(motion());
  const LateStart late(
      std::make_unique<RecordedImuFlight>(fit_of_motion(), samples, kEpoch, Pose::Identity(),
                                          Pose::Identity(), "made up"),
      std::chrono::seconds(2));
  ASSERT_NE(late.recorded_imu(), nullptr);
  EXPECT_EQ(late.recorded_imu()->samples.front().stamp, Time{0});
  EXPECT_EQ(late.recorded_imu()->samples.front().gyro, samples[400].gyro);
}

TEST(RecordedImuFlight, ATiltedWorldAndAMovedBodyAreRefused) {
  const auto error_of = [](const Pose& world, const Pose& body) -> std::string {
    try {
      RecordedImuFlight(fit_of_motion(), {}, kEpoch, world, body, "a.yaml");
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  const Pose none = Pose::Identity();
  EXPECT_THAT(error_of(make_pose(so3::exp({0.01, 0, 0}), {0, 0, 0}), none), HasSubstr("vertical"));
  EXPECT_THAT(error_of(none, make_pose(Eigen::Matrix3d::Identity(), {0.1, 0, 0})),
              HasSubstr("away from the recorded IMU"));
}

TEST(ReadImuRecording, ReadsSecondsAndNanosecondsAndNamesTheBadRow) {
  TemporaryFolder folder;
  const auto samples =
      read_imu_recording(folder.write("a.csv", "# t w f\n1403715273262142976,1,2,3,4,5,6\n"));
  ASSERT_EQ(samples.size(), 1);
  EXPECT_EQ(samples[0].stamp.count(), 1403715273262142976);
  EXPECT_EQ(samples[0].accel, Vector3d(4, 5, 6));
  EXPECT_EQ(read_imu_recording(folder.write("b.txt", "12.5 1 2 3 4 5 6\n"))[0].stamp,
            std::chrono::milliseconds(12500));
  const auto error_of = [&](const std::string& text) -> std::string {
    try {
      read_imu_recording(folder.write("c.csv", text));
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(error_of("1.0,1,2,3,4,5,6\n1.0,1,2,3,4,5,6\n"), HasSubstr("c.csv:2"));
  EXPECT_THAT(error_of("1.0,1,2,3,4,5\n"), HasSubstr("c.csv:1"));
  EXPECT_THAT(error_of("1.0,1,2,3,4,5,nan\n"), HasSubstr("c.csv:1"));
}

/// Residuals of the real drone's flights: those left out equal those inside.
TEST(ImuSplineFit, ExplainsARealDroneAsWellWhereItDidNotSeeTheSamples) {
  const std::filesystem::path folder = std::filesystem::path(LIDARENA_SHARED_DATA) / "imu/euroc";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no recordings in " << folder;
  double inside = 0.0, outside = 0.0, gyro_inside = 0.0, gyro_outside = 0.0;
  const Trajectory poses = read_recording(folder / "V103_truth.tum");
  const std::vector<ImuSample> samples = read_imu_recording(folder / "V103_imu.csv");
  for (int second = 0; second < 5; ++second) {
    ImuFitConfig config;
    config.left_out_second = second;
    const ImuSplineFit fit = fit_imu_spline(poses, samples, config, "V103");
    EXPECT_LT(fit.position_rms_m, 0.001);
    inside += std::pow(fit.fitted.accel_m_s2, 2);
    outside += std::pow(fit.left_out.accel_m_s2, 2);
    gyro_inside += std::pow(fit.fitted.gyro_rad_s, 2);
    gyro_outside += std::pow(fit.left_out.gyro_rad_s, 2);
  }
  EXPECT_NEAR(std::sqrt(outside / inside), 1.0, 0.02);
  EXPECT_NEAR(std::sqrt(gyro_outside / gyro_inside), 1.0, 0.08);
}

}  // namespace
}  // namespace lidarena::flight
