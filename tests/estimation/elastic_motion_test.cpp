// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/elastic_motion.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/so3.hpp"
#include "tests/estimation/pose_of.hpp"

namespace lidarena::estimation {
namespace {

using Vector12 = Eigen::Matrix<double, 12, 1>;

/// Left increments (translation, rotation about the knot's own position) of two knots.
ElasticSegment moved_segment(const Pose& from, const Pose& to, const Vector12& d) {
  const auto apply = [](const Pose& pose, const Eigen::Matrix<double, 6, 1>& step) {
    return make_pose(Eigen::Matrix3d(so3::exp(step.tail<3>()) * pose.linear()),
                     Eigen::Vector3d(pose.translation() + step.head<3>()));
  };
  return {apply(from, d.head<6>()), apply(to, d.tail<6>())};
}

TEST(ElasticMotion, IsLinearInPositionAndTurnsEvenly) {
  const ElasticMotion motion{
      {pose_of(1, 2, 3, 0, 0, 0.2), pose_of(2, 2, 5, 0, 0, 0.6), pose_of(2, 3, 5, 0, 0, 0.5)}};
  const Pose quarter = motion.at(0.125);
  EXPECT_LT((quarter.translation() - Eigen::Vector3d(1.25, 2, 3.5)).norm(), 1e-14);
  EXPECT_LT((so3::log(quarter.linear()) - Eigen::Vector3d(0, 0, 0.3)).norm(), 1e-14);
  EXPECT_LT((motion.at(0.5).matrix() - motion.knots[1].matrix()).norm(), 1e-14);
  EXPECT_LT((motion.at(1.0).matrix() - motion.end().matrix()).norm(), 1e-14);
  const MotionChange change = change_between(motion, ElasticMotion::still(motion.begin(), 2));
  EXPECT_NEAR(change.translation_m, Eigen::Vector3d(1, 1, 2).norm(), 1e-14);
  EXPECT_NEAR(change.rotation_rad, 0.3, 1e-14);
}

TEST(ElasticMotion, PlacesPointsAsItsInterpolatedPoseDoes) {
  const Eigen::Vector3d point(4.0, -7.0, 1.5);
  for (const double angle : {0.0, 1e-12, 1e-6, 0.01, 0.5, 3.0}) {
    const Eigen::Vector3d turn = angle * Eigen::Vector3d(2, -1, 2) / 3.0;
    const Pose from = pose_of(1, 2, 3, 0.3, -0.2, 1.0);
    const Pose to = make_pose(Eigen::Matrix3d(so3::exp(turn) * from.linear()), {1.5, 1, 3});
    const ElasticMotion motion{{from, to, from}};
    const ElasticTrack track(motion);
    for (const double alpha : {0.0, 0.1, 0.49, 0.5, 0.77, 1.0})
      // lever of 8 m; the angle is rounded like an arc cosine near one: 1e-8 squared and more
      EXPECT_LT((track.place(point, alpha) - motion.at(alpha) * point).norm(), 1e-11) << angle;
  }
}

TEST(ElasticMotion, DerivativeIsTheNumericOneAtAnyTurn) {
  const Eigen::Vector3d point(4.0, -7.0, 1.5);
  const Eigen::Vector3d direction = Eigen::Vector3d(1, 2, -2) / 3.0;
  for (const double angle : {0.0, 1e-6, 1e-3, 0.3, 2.0}) {
    const Pose from = pose_of(1, 2, 3, 0.3, -0.2, 1.0);
    const Eigen::Vector3d turn = angle * Eigen::Vector3d(2, -1, 2) / 3.0;
    const Pose to = make_pose(Eigen::Matrix3d(so3::exp(turn) * from.linear()), {1.5, 1, 3});
    const ElasticSegment segment(from, to);
    for (const double a : {0.0, 0.3, 0.5, 1.0}) {
      const auto row = segment.row(point, a, direction);
      constexpr double h = 1e-5;
      for (int k = 0; k < 12; ++k) {
        const auto at = [&](double s) {
          return direction.dot(moved_segment(from, to, s * Vector12::Unit(k)).place(point, a));
        };
        const double slope = (at(h) - at(-h)) / (2.0 * h);
        // h^2 / 6 times a third derivative of about 8 m, and rounding of 8 m by 1e-16, over h
        EXPECT_NEAR(row[k], slope, 2e-9) << "angle " << angle << " a " << a << " column " << k;
      }
    }
  }
}

}  // namespace
}  // namespace lidarena::estimation
