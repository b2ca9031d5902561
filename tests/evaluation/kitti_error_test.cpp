// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/trajectory/kitti_error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "flights.hpp"
#include "lidarena/dataset/trajectories/trajectory_io.hpp"
#include "tum_text.hpp"

namespace lidarena::evaluation {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using flights::level;
using flights::sample;
using ::testing::HasSubstr;

/// Path of length `meters` in steps of exactly 1 m, 10 Hz.
Trajectory drive(int meters, double scale = 1.0, double yaw_per_m = 0.0) {
  return sample(
      [&](double t) {
        const double s = std::round(10.0 * t);
        return make_pose(so3::exp({0, 0, yaw_per_m * s}), Vector3d(scale * s, 0, 0));
      },
      100ms, meters * 100ms);
}

TEST(KittiError, PiecesStartAtEveryTenthFrameAndEndAtTheFirstBeyondTheLength) {
  // 300 m: pieces of 101 m start at 0, 10 .. 190 m, of 201 m at 0 .. 90 m, of 300 m none fits
  const KittiError error = kitti_error(drive(300, 1.01), drive(300));
  EXPECT_FALSE(error.refused);
  ASSERT_EQ(error.lengths.size(), 8U);
  EXPECT_EQ(error.lengths[0].pieces, 20U);
  EXPECT_EQ(error.lengths[1].pieces, 10U);
  EXPECT_EQ(error.lengths[2].pieces, 0U);
  EXPECT_EQ(error.pieces, 30U);
  // one percent of 101 m, divided by 100 m
  EXPECT_NEAR(error.lengths[0].translation_percent.value(), 1.01, 1e-9);
  EXPECT_NEAR(error.lengths[1].translation_percent.value(), 1.005, 1e-9);
  EXPECT_NEAR(error.translation_percent.value(), (20 * 1.01 + 10 * 1.005) / 30, 1e-9);
  EXPECT_NEAR(error.rotation_rad_per_m.value(), 0.0, 1e-12);
}

TEST(KittiError, RotationIsTheAnglePerMeter) {
  const double w = 0.002;
  const KittiError error = kitti_error(drive(300, 1.0, w), drive(300));
  EXPECT_NEAR(error.lengths[0].rotation_rad_per_m.value(), w * 1.01, 1e-12);
  EXPECT_NEAR(error.lengths[1].rotation_rad_per_m.value(), w * 1.005, 1e-12);
}

TEST(KittiError, TheLadderOfShortLengthsFollowsTheSameRule) {
  const KittiError error = kitti_error(drive(60, 1.01), drive(60), kRpeLengths_m);
  ASSERT_EQ(error.lengths.size(), 6U);
  EXPECT_NEAR(error.lengths[0].translation_percent.value(), 2.0,
              1e-9);                       // 2 m for 1 m: 1 is not beyond 1
  EXPECT_EQ(error.lengths[5].pieces, 1U);  // 51 m, only from 0 m
  EXPECT_NEAR(error.lengths[5].translation_percent.value(), 1.02, 1e-9);
}

TEST(KittiError, AFlightTooShortIsRefusedInWordsNotScoredAsNotANumber) {
  const KittiError error = kitti_error(drive(60), drive(60));
  EXPECT_EQ(error.pieces, 0U);
  EXPECT_THAT(error.refused.value(), HasSubstr("the common path is 60 m, no piece of 100 m fits"));
  EXPECT_TRUE(kitti_error(Trajectory(), drive(60)).refused);
  EXPECT_TRUE(kitti_error(drive(60), Trajectory()).refused);
}

TEST(KittiError, PathIsTheTruthsOwnAlsoWhereEstimatesAreMissing) {
  // a square with sides of 4 m, one round in 16 m: the 5 m chords between the estimates would cut
  // its corners
  const Trajectory truth = sample(
      [](double t) {
        const double s = std::fmod(t, 16.0);
        return level({std::clamp(s, 0.0, 4.0) - std::clamp(s - 8.0, 0.0, 4.0),
                      std::clamp(s - 4.0, 0.0, 4.0) - std::clamp(s - 12.0, 0.0, 4.0), 0});
      },
      100ms, 240s);
  std::vector<StampedPose> some;
  for (std::size_t i = 0; i < truth.size(); i += 50) some.push_back(truth.poses()[i]);
  const KittiError error = kitti_error(Trajectory(some), truth);
  // frames every 5 m of path: starts at 0, 50, 100 m end at 105, 155, 205 m; at 0 for 200 m
  EXPECT_EQ(error.lengths[0].pieces, 3U);
  EXPECT_EQ(error.lengths[1].pieces, 1U);
}

// Results of tests/oracle/kitti_error.py, which was written independently of the library. (The
// source of the trajectories publishes no numbers as text.) The rows have 7 digits: rotations are
// orthonormal only to 1e-6; the library makes them orthonormal, the script does not.
struct Sequence09 {
  const char* file;
  std::size_t pieces, pieces_100, pieces_800;
  double percent, percent_100, percent_800, deg_per_100m;
};

class KittiSequence09 : public ::testing::TestWithParam<Sequence09> {};

TEST_P(KittiSequence09, GivesWhatAnIndependentScriptGave) {
  const auto folder = tum_text::shared("trajectories/kitti_odometry");
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << "trajectories of KITTI's sequence 09 not found";
  }
  const Sequence09& known = GetParam();
  const KittiError error = kitti_error(dataset::read_trajectory(folder / known.file),
                                       dataset::read_trajectory(folder / "09_groundtruth.txt"));
  EXPECT_EQ(error.pieces, known.pieces);
  EXPECT_EQ(error.lengths[0].pieces, known.pieces_100);
  EXPECT_EQ(error.lengths[7].pieces, known.pieces_800);
  EXPECT_NEAR(error.translation_percent.value(), known.percent, 1e-5);
  EXPECT_NEAR(error.lengths[0].translation_percent.value(), known.percent_100, 1e-5);
  EXPECT_NEAR(error.lengths[7].translation_percent.value(), known.percent_800, 1e-5);
  const double degrees = error.rotation_rad_per_m.value() * 180.0 / std::numbers::pi * 100.0;
  EXPECT_NEAR(degrees, known.deg_per_100m, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(
    Estimates, KittiSequence09,
    ::testing::Values(Sequence09{"09_estimate_a.txt", 957, 147, 86, 72.109629922, 89.841107947,
                                 49.553169577, 0.249498990},
                      Sequence09{"09_estimate_b.txt", 958, 147, 86, 2.606843488, 3.325738561,
                                 2.110271000, 0.287702745}));

}  // namespace
}  // namespace lidarena::evaluation
