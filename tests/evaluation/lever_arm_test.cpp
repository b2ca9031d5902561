// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/diagnosis/lever_arm.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "flights.hpp"
#include "lidarena/base/config_json.hpp"
#include "lidarena/evaluation/trajectory/trajectory_error.hpp"
#include "tum_text.hpp"

namespace lidarena::evaluation {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using flights::level;
using flights::mapped;
using flights::sample;
using flights::tour;
using ::testing::HasSubstr;

const Pose kArm = make_pose(so3::exp({0.1, -0.2, 0.3}), Vector3d(0.25, -0.10, 0.15));

/// A perfect estimate of another frame of the body, in its own world frame.
Trajectory sensor_estimate(const Trajectory& truth, const Pose& body_from_estimate) {
  SequentialRandom random(11);
  const Pose elsewhere = flights::random_pose(random, 5.0);
  return mapped(truth, [&](const StampedPose& pose) {
    return elsewhere * pose.world_from_body * body_from_estimate;
  });
}

TEST(MovedToBody, UndoesTheArmExactly) {
  const Trajectory truth = sample(tour, 10ms, 20s);
  const Trajectory sensor = sensor_estimate(truth, kArm);
  const Trajectory body = moved_to_body(sensor, kArm);
  EXPECT_GT(relative_pose_error(sensor, truth).translation_m.rmse, 0.1);
  EXPECT_LT(relative_pose_error(body, truth).translation_m.max, 1e-9);
  EXPECT_LT(absolute_trajectory_error(body, truth, AlignmentKind::kSe3).translation_m.max, 1e-9);
  EXPECT_LT(absolute_trajectory_error(body, truth, AlignmentKind::kFirstPose).rotation_rad.max,
            1e-9);
  // no alignment corrects it
  EXPECT_GT(absolute_trajectory_error(sensor, truth, AlignmentKind::kSe3).translation_m.rmse, 0.1);
}

TEST(LeverArm, OfAPerfectEstimateIsFoundToRounding) {
  const Trajectory truth = sample(tour, 10ms, 20s);
  const auto arm = find_lever_arm(sensor_estimate(truth, kArm), truth);
  ASSERT_TRUE(arm);
  EXPECT_LT((arm->body_from_estimate.matrix() - kArm.matrix()).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT(arm->misfit_m, 1e-9);
  EXPECT_GT(arm->misfit_without_m, 0.1);
  // 0.31 m and 0.374 rad
  EXPECT_THAT(warning_of(*arm), HasSubstr("0.308 m away and rotated by 21.4 deg"));
}

TEST(LeverArm, AHalfTurnOfTheMountingIsFoundToo) {
  const Pose camera = make_pose(so3::exp({0, 0, 3.14}) * so3::exp({-1.57, 0, 0}), {0.1, 0, 0});
  const Trajectory truth = sample(tour, 10ms, 20s);
  const auto arm = find_lever_arm(sensor_estimate(truth, camera), truth);
  ASSERT_TRUE(arm);
  EXPECT_LT((arm->body_from_estimate.matrix() - camera.matrix()).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(LeverArm, OfANoisyEstimateLiesWithinItsSigmas) {
  SequentialRandom random(12);
  const Trajectory truth = sample(tour, 10ms, 60s);
  const Trajectory slow = sample(tour, 100ms, 60s);
  const Trajectory sensor = mapped(sensor_estimate(slow, kArm), [&](const StampedPose& pose) {
    const Vector3d move(random.normal(), random.normal(), random.normal());
    const Vector3d turn(random.normal(), random.normal(), random.normal());
    return pose.world_from_body * make_pose(so3::exp(0.002 * turn), 0.01 * move);
  });
  const auto arm = find_lever_arm(sensor, truth);
  ASSERT_TRUE(arm);
  const Pose off = kArm.inverse() * arm->body_from_estimate;
  const Vector3d turn = so3::log(off.linear());
  const Vector3d move = kArm.linear() * off.translation();
  for (Eigen::Index i = 0; i < 3; ++i) {
    // overlapping pieces share poses, which makes the formal sigmas too small: allow five of them
    EXPECT_LT(std::abs(move[i]), 5.0 * arm->sigma[i]);
    EXPECT_LT(std::abs(turn[i]), 5.0 * arm->sigma[3 + i]);
    // 1 cm of noise over the rotation within a second: 0.4 rad about z, but only 0.1 rad about x
    // and y, which determine z
    EXPECT_LT(arm->sigma[i], i == 2 ? 0.05 : 0.01);
  }
}

TEST(LeverArm, NoneIsSeenAndNoneWarnedOfWhereTheFramesAreTheSame) {
  const Trajectory truth = sample(tour, 10ms, 20s);
  const Trajectory drifting = mapped(sample(tour, 100ms, 20s), [](const StampedPose& pose) {
    const double t = to_seconds(pose.stamp);
    return make_pose(so3::exp({0, 0, 0.01 * t}), Vector3d(0.02 * t, 0, 0)) * pose.world_from_body;
  });
  const auto arm = find_lever_arm(drifting, truth);
  ASSERT_TRUE(arm);
  // the drift of 2 cm/s looks like an arm of 25 cm along z, which the small tilts hardly determine
  EXPECT_LT(arm->body_from_estimate.translation().head<2>().norm(), 0.05);
  EXPECT_GT(2.0 * arm->misfit_m, arm->misfit_without_m);
  EXPECT_EQ(warning_of(*arm), "");
}

TEST(LeverArm, AFlightThatOnlyYawsDoesNotShowTheHeight) {
  const auto carousel = [](double t) {
    return make_pose(so3::exp({0, 0, 0.5 * t}), Vector3d(t, std::sin(t), 1.0));
  };
  const Trajectory truth = sample(carousel, 10ms, 20s);
  const auto arm = find_lever_arm(sensor_estimate(truth, level({0.2, 0.1, 0.4})), truth);
  ASSERT_TRUE(arm);
  EXPECT_NEAR(arm->body_from_estimate.translation().x(), 0.2, 1e-4);
  EXPECT_NEAR(arm->body_from_estimate.translation().y(), 0.1, 1e-4);
  EXPECT_NEAR(arm->body_from_estimate.translation().z(), 0.0, 1e-3);  // not observable: stays 0
}

TEST(LeverArm, AFlightThatDoesNotTurnShowsNone) {
  const Trajectory line = sample([](double t) { return level({t, 0, 0}); }, 100ms, 20s);
  EXPECT_FALSE(find_lever_arm(sensor_estimate(line, kArm), line).has_value());
  EXPECT_FALSE(find_lever_arm(Trajectory(), line).has_value());
  EXPECT_FALSE(find_lever_arm(line, Trajectory()).has_value());
}

TEST(LeverArm, OfTheFixtureIsTheOneItWasMadeWith) {
  std::ifstream in(tum_text::test_data("evo/evo_figures.json"));
  const Json files = Json::parse(in)["files"];
  const auto arm = find_lever_arm(tum_text::parse(files["uav_ref_lever.tum"].get<std::string>()),
                                  tum_text::parse(files["uav_ref.tum"].get<std::string>()));
  ASSERT_TRUE(arm);
  // "ypr 0.3,-0.2,0.1 rad; t 0.25,-0.10,0.15 m", rows with 6 decimals
  const Eigen::Matrix3d turn =
      so3::exp({0, 0, 0.3}) * so3::exp({0, -0.2, 0}) * so3::exp({0.1, 0, 0});
  EXPECT_LT((arm->body_from_estimate.translation() - Vector3d(0.25, -0.10, 0.15)).norm(), 1e-4);
  EXPECT_LT((arm->body_from_estimate.linear() - turn).norm(), 1e-5);
}

}  // namespace
}  // namespace lidarena::evaluation
