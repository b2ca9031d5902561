// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/diagnosis/suspicion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flights.hpp"

namespace lidarena::evaluation {
namespace {

using namespace std::chrono_literals;
using flights::mapped;
using flights::sample;
using flights::tour;
using ::testing::HasSubstr;

/// All stamps multiplied by `times`.
Trajectory stretched(const Trajectory& trajectory, std::int64_t times) {
  std::vector<StampedPose> poses(trajectory.poses().begin(), trajectory.poses().end());
  for (StampedPose& pose : poses) pose.stamp *= times;
  return Trajectory(std::move(poses));
}

/// Quaternion columns w x y z read as x y z w.
Trajectory misread(const Trajectory& trajectory) {
  return mapped(trajectory, [](const StampedPose& pose) {
    const Eigen::Quaterniond q(pose.world_from_body.linear());
    Eigen::Quaterniond wrong;
    wrong.coeffs() = Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
    return make_pose(wrong, pose.world_from_body.translation());
  });
}

TEST(SuspectLengthUnit, NamesTheUnitThatThePositionsSeemToBeIn) {
  const Trajectory truth = sample(tour, 10ms, 20s);
  const auto scaled = [&](double scale) {
    return mapped(sample(tour, 100ms, 20s), [&](const StampedPose& pose) {
      return make_pose(Eigen::Quaterniond(pose.world_from_body.linear()),
                       scale * pose.world_from_body.translation());
    });
  };
  EXPECT_EQ(suspect_length_unit(scaled(1.0), truth), "");
  EXPECT_EQ(suspect_length_unit(scaled(1.3), truth), "");
  EXPECT_THAT(suspect_length_unit(scaled(1000.0), truth),
              HasSubstr("the estimate's positions look like millimeters"));
  EXPECT_THAT(suspect_length_unit(scaled(0.01), truth),
              HasSubstr("the truth's positions look like centimeters"));
}

TEST(SuspectConstantRotation, NamesTheFileThatHoldsPositionsOnly) {
  const Trajectory truth = sample(tour, 10ms, 20s);
  const Trajectory positions = mapped(sample(tour, 100ms, 20s), [](const StampedPose& pose) {
    return make_pose(Eigen::Quaterniond::Identity(), pose.world_from_body.translation());
  });
  EXPECT_THAT(suspect_constant_rotation(positions, truth), HasSubstr("the estimate's rotations"));
  EXPECT_THAT(suspect_constant_rotation(truth, positions), HasSubstr("the truth's rotations"));
  EXPECT_EQ(suspect_constant_rotation(sample(tour, 100ms, 20s), truth), "");
  EXPECT_EQ(suspect_constant_rotation(positions, positions), "");
}

TEST(SuspectTimes, NamesTheUnitThatTheTimesSeemToBeIn) {
  const Trajectory truth = sample(tour, 10ms, 20s);
  const Trajectory estimate = sample(tour, 100ms, 18s);
  EXPECT_THAT(
      suspect_times(stretched(estimate, 1000), truth),
      HasSubstr("lasts 1.8e+04 s, the truth 20 s: the estimate's times look like milliseconds"));
  EXPECT_THAT(suspect_times(stretched(estimate, 1'000'000), truth), HasSubstr("microseconds"));
  EXPECT_THAT(
      suspect_times(stretched(sample(tour, 100ms, 5s), 1'000'000'000), sample(tour, 10ms, 5s)),
      HasSubstr("nanoseconds"));
  EXPECT_THAT(suspect_times(estimate, stretched(truth, 1000)), HasSubstr("the truth lasts"));
}

TEST(SuspectTimes, TellsClocksThatCountFromDifferentInstants) {
  const Trajectory truth = flights::shifted(sample(tour, 10ms, 20s), 1'700'000'000s);
  EXPECT_THAT(suspect_times(sample(tour, 100ms, 20s), truth),
              HasSubstr("begins 1.7e+09 s before the truth: their clocks"));
}

TEST(SuspectTimes, HasNothingToSayOfGoodTimesNorOfFewPoses) {
  const Trajectory truth = sample(tour, 10ms, 20s);
  EXPECT_EQ(suspect_times(sample(tour, 100ms, 5s), truth), "");
  EXPECT_EQ(suspect_times(flights::shifted(truth, 3s), truth), "");
  EXPECT_EQ(suspect_times(Trajectory(), truth), "");
  EXPECT_EQ(suspect_times(sample(tour, 100ms, 50ms), truth), "");
}

TEST(SuspectQuaternionOrder, NamesTheFileThatHasItWrong) {
  const Trajectory truth = sample(tour, 10ms, 20s);
  const Trajectory estimate = sample(tour, 100ms, 20s);
  EXPECT_THAT(suspect_quaternion_order(misread(estimate), truth),
              HasSubstr("the estimate's quaternions look like w x y z"));
  EXPECT_THAT(suspect_quaternion_order(estimate, misread(truth)),
              HasSubstr("the truth's quaternions look like w x y z"));
}

TEST(SuspectQuaternionOrder, IsNotMisledByDriftNoiseOrAMounting) {
  const Trajectory truth = sample(tour, 10ms, 20s);
  const Trajectory estimate = sample(tour, 100ms, 20s);
  EXPECT_EQ(suspect_quaternion_order(estimate, truth), "");
  SequentialRandom random(3);
  const auto noisy = mapped(estimate, [&](const StampedPose& pose) {
    const Eigen::Vector3d turn(random.normal(), random.normal(), random.normal());
    return pose.world_from_body * make_pose(so3::exp(0.05 * turn), Eigen::Vector3d::Zero());
  });
  EXPECT_EQ(suspect_quaternion_order(noisy, truth), "");
  for (const Eigen::Vector3d& turn :
       {Eigen::Vector3d(0, 0, 1.57), Eigen::Vector3d(-1.57, 0, 0), Eigen::Vector3d(1.2, -1.2, 1.2),
        Eigen::Vector3d(3.1, 0, 0)}) {
    const auto mounted = mapped(estimate, [&](const StampedPose& pose) {
      return pose.world_from_body * make_pose(so3::exp(turn), Eigen::Vector3d::Zero());
    });
    EXPECT_EQ(suspect_quaternion_order(mounted, truth), "") << turn.transpose();
  }
}

}  // namespace
}  // namespace lidarena::evaluation
