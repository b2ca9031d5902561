// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "lidarena/base/so3.hpp"
#include "lidarena/flight/flight.hpp"

/// Properties that every Flight must have.
namespace lidarena::flight::conformance {

/// Maximum differences between the derivatives that a flight returns and central differences (step
/// h) of the next lower derivatives.
struct Disagreement {
  double velocity = 0.0, acceleration = 0.0, angular_rate = 0.0, angular_acceleration = 0.0;
};

inline Disagreement disagreement(const Flight& flight, Time h, Time spacing) {
  Disagreement most;
  const double span = 2.0 * to_seconds(h);
  for (Time t = h; t + h <= flight.duration(); t += spacing) {
    const Motion before = flight.at(t - h);
    const Motion now = flight.at(t);
    const Motion after = flight.at(t + h);
    const auto raise = [](double& maximum, const Eigen::Vector3d& error) {
      maximum = std::max(maximum, error.norm());
    };
    const Pose turn = before.world_from_body.inverse() * after.world_from_body;
    const Eigen::Vector3d step =
        after.world_from_body.translation() - before.world_from_body.translation();
    raise(most.velocity, step / span - now.velocity_world);
    raise(most.acceleration,
          (after.velocity_world - before.velocity_world) / span - now.acceleration_world);
    // R(t-h)^T R(t+h) is a rotation by the mean rate; it equals the rate at t up to O(h^2)
    raise(most.angular_rate, so3::log(turn.linear()) / span - now.angular_rate_body);
    raise(most.angular_acceleration, (after.angular_rate_body - before.angular_rate_body) / span -
                                         now.angular_acceleration_body);
  }
  return most;
}

/// The derivatives that a flight returns are the limits of numeric ones: halving the step divides
/// the difference by 2^order (20 % are allowed for higher-order terms), down to rounding. The order
/// is 2 if the third derivative of the differentiated quantity is continuous, 1 if it has jumps.
inline void expect_derivatives_converge(const Flight& flight, int order, Time spacing) {
  constexpr double kRounding = 1e-8;  // 1e-14 m or rad over steps of 1 us
  const Time h = std::chrono::microseconds(400);
  const Disagreement coarse = disagreement(flight, h, spacing);
  const Disagreement fine = disagreement(flight, h / 2, spacing);
  const double share = 1.2 / static_cast<double>(1 << order);
  EXPECT_LE(fine.velocity, share * coarse.velocity + kRounding);
  EXPECT_LE(fine.acceleration, share * coarse.acceleration + kRounding);
  EXPECT_LE(fine.angular_rate, share * coarse.angular_rate + kRounding);
  EXPECT_LE(fine.angular_acceleration, share * coarse.angular_acceleration + kRounding);
}

inline void expect_rotations_are_rotations(const Flight& flight, Time spacing) {
  for (Time t{0}; t <= flight.duration(); t += spacing) {
    const Eigen::Matrix3d r = flight.pose_at(t).linear();
    ASSERT_NEAR((r.transpose() * r - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-12);
    ASSERT_GT(r.determinant(), 0.0);
  }
}

inline void expect_pose_at_is_the_pose_of_at(const Flight& flight, Time spacing) {
  for (Time t{0}; t <= flight.duration(); t += spacing) {
    const Pose difference = flight.pose_at(t).inverse() * flight.at(t).world_from_body;
    ASSERT_NEAR((difference.matrix() - Eigen::Matrix4d::Identity()).norm(), 0.0, 1e-12);
  }
}

inline void expect_rest_outside(const Flight& flight) {
  const Time end = flight.duration();
  const Time far = std::chrono::hours(1);
  for (const auto& [outside, inside] :
       {std::pair{Time{-1}, Time{0}}, {-far, Time{0}}, {end + Time{1}, end}, {end + far, end}}) {
    const Motion there = flight.at(outside);
    EXPECT_TRUE(there.world_from_body.matrix() == flight.at(inside).world_from_body.matrix());
    EXPECT_TRUE(flight.pose_at(outside).matrix() == flight.pose_at(inside).matrix());
    EXPECT_EQ(there.velocity_world.norm(), 0.0);
    EXPECT_EQ(there.acceleration_world.norm(), 0.0);
    EXPECT_EQ(there.angular_rate_body.norm(), 0.0);
    EXPECT_EQ(there.angular_acceleration_body.norm(), 0.0);
  }
}

inline void expect_lawful(const Flight& flight, int order) {
  ASSERT_GT(flight.duration(), Time{0});
  const Time spacing = std::chrono::microseconds(3137);  // not commensurable with the knots
  expect_rotations_are_rotations(flight, spacing);
  expect_pose_at_is_the_pose_of_at(flight, spacing);
  expect_rest_outside(flight);
  expect_derivatives_converge(flight, order, spacing);
}

}  // namespace lidarena::flight::conformance
