// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/imu_units.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace lidarena::dataset {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// Five seconds of a handheld's motion, in SI: accelerations around gravity, turns of up to 2
/// rad/s.
std::vector<ImuSample> motion() {
  std::vector<ImuSample> samples;
  for (int i = 0; i < 1000; ++i) {
    const double t = 0.005 * i;
    samples.push_back(
        {from_seconds(t),
         {0.3 * std::sin(3.0 * t), 0.2, 1.2 + 0.8 * std::sin(t)},
         {2.0 * std::sin(5.0 * t), 2.0 * std::cos(4.0 * t), 9.80665 + std::sin(7.0 * t)}});
  }
  return samples;
}

std::vector<ImuSample> scaled(double accel, double gyro) {
  std::vector<ImuSample> samples = motion();
  for (ImuSample& sample : samples) {
    sample.accel *= accel;
    sample.gyro *= gyro;
  }
  return samples;
}

TEST(ImuUnits, SiIsNotTouched) {
  const ImuVerdict verdict = judge_imu("/imu", motion());
  EXPECT_EQ(verdict.units, ImuUnits{});
  EXPECT_THAT(verdict.notes, IsEmpty());
  EXPECT_THAT(verdict.warnings, IsEmpty());
}

TEST(ImuUnits, GravityShowsTheUnitOfAccelerations) {
  for (const double unit : {1.0, 1e-3}) {  // g, mg
    const ImuVerdict verdict = judge_imu("/imu", scaled(1.0 / (unit * kStandardGravity), 1.0));
    EXPECT_DOUBLE_EQ(verdict.units.accel, unit * kStandardGravity);
    EXPECT_THAT(verdict.notes, testing::SizeIs(1));
  }
}

TEST(ImuUnits, SamplesOfZeroBeforeTheStartDoNotCount) {
  std::vector<ImuSample> samples(900);
  const std::vector<ImuSample> in_g = scaled(1.0 / kStandardGravity, 1.0);
  samples.insert(samples.end(), in_g.begin(), in_g.end());
  EXPECT_DOUBLE_EQ(judge_imu("/imu", samples).units.accel, kStandardGravity);
}

TEST(ImuUnits, RatesThatNoBodyTurnsAtForLongAreDegrees) {
  const ImuVerdict verdict = judge_imu("/imu", scaled(1.0, 180.0 / std::numbers::pi));
  EXPECT_DOUBLE_EQ(verdict.units.gyro, std::numbers::pi / 180.0);
  EXPECT_THAT(verdict.notes, testing::ElementsAre(HasSubstr("deg/s")));
}

TEST(ImuUnits, AccelerationsWithoutGravityAreWarnedOfAndNotTakenForG) {
  for (const double scale : {0.1, 0.5, 1.0}) {
    std::vector<ImuSample> samples = motion();
    for (ImuSample& sample : samples) {
      sample.accel.z() -= kStandardGravity;
      sample.accel *= scale;
    }
    const ImuVerdict verdict = judge_imu("/imu", samples);
    EXPECT_EQ(verdict.units, ImuUnits{}) << scale;
    EXPECT_THAT(verdict.warnings, testing::ElementsAre(HasSubstr("lack gravity"))) << scale;
  }
}

TEST(ImuUnits, AMagnitudeThatIsNoGravityIsWarnedOf) {
  EXPECT_THAT(judge_imu("/imu", scaled(5.0, 1.0)).warnings,
              testing::ElementsAre(HasSubstr("scale them to m/s^2")));
}

TEST(ImuUnits, SaysWhatCannotBeAMeasurement) {
  const Eigen::Vector3d up{0.0, 0.0, 9.8};
  EXPECT_EQ(fault_of({Time{0}, {0.1, 0.0, 0.0}, up}), "");
  EXPECT_EQ(fault_of({Time{0}, {NAN, 0.0, 0.0}, up}), "not finite");
  EXPECT_EQ(fault_of({}), "all zero");
  EXPECT_EQ(fault_of({Time{0}, {0.0, 0.0, 0.0}, 100.0 * up}), "beyond 40 g or 80 rad/s");
}

}  // namespace
}  // namespace lidarena::dataset
