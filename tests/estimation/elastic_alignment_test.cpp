// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/elastic_alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"

namespace lidarena::estimation {
namespace {

using Vector12 = Eigen::Matrix<double, 12, 1>;

Pose pose_of(double x, double y, double z, double rx, double ry, double rz) {
  return make_pose(so3::exp({rx, ry, rz}), {x, y, z});
}

/// Left increments (translation, rotation about the knot's own position) of two knots.
ElasticSegment moved(const Pose& from, const Pose& to, const Vector12& d) {
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
      const auto first_order = segment.first_order_row(point, a, direction);
      constexpr double h = 1e-5;
      for (int k = 0; k < 12; ++k) {
        const auto at = [&](double s) {
          return direction.dot(moved(from, to, s * Vector12::Unit(k)).place(point, a));
        };
        const double slope = (at(h) - at(-h)) / (2.0 * h);
        // h^2 / 6 times a third derivative of about 8 m, and rounding of 8 m by 1e-16, over h
        EXPECT_NEAR(row[k], slope, 2e-9) << "angle " << angle << " a " << a << " column " << k;
        // The approximation leaves out terms of half the rotation angle times a lever of 8.2 m
        EXPECT_NEAR(first_order[k], slope, 2e-9 + 4.1 * angle);
      }
    }
  }
}

/// Points in all directions at random times of a true motion, each with a plane (or line) through
/// its true position.
struct Scene {
  ElasticMotion truth;
  std::vector<ElasticMatch> matches;
};

Scene scene(int segments, double noise, double outlier_share = 0.0, bool shapes = false) {
  Scene result;
  for (int i = 0; i <= segments; ++i) {
    const double s = static_cast<double>(i) / segments;
    result.truth.knots.push_back(
        pose_of(0.3 * s, -0.1 * s * s, 0.05 * s, 0.1 * s, 0.05 * s * s, 0.3 * s * s + 0.1));
  }
  const CounterRandom random(7);
  for (std::uint64_t i = 0; i < 600; ++i) {
    const auto n = random.normals(i, 0);
    const auto m = random.normals(i, 1);
    ElasticMatch match;
    match.point = Eigen::Vector3d(5.0 * n[0], 5.0 * n[1], 3.0 * m[0]);
    match.alpha = random.uniform(i, 2);
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(static_cast<int>(i % 3));
    match.shape.row(0) = axis;
    if (shapes && i % 5 == 0) {
      match.rows = 3;
      match.shape = Eigen::Matrix3d::Identity() - axis * axis.transpose();
    }
    match.weight = 0.5 + 0.5 * random.uniform(i, 3);
    match.anchor = result.truth.at(match.alpha) * match.point +
                   Eigen::Vector3d(noise * m[1], noise * random.normals(i, 4)[0],
                                   noise * random.normals(i, 4)[1]);
    if (random.uniform(i, 5) < outlier_share) match.anchor += Eigen::Vector3d(0.6, 0.8, -0.7);
    result.matches.push_back(match);
  }
  return result;
}

MotionPrior full_prior(const ElasticMotion& truth) {
  MotionPrior prior;
  prior.begin = pose_of(0.02, 0.01, -0.03, 0.01, 0.02, 0.08);
  prior.step =
      truth.end().translation() - truth.begin().translation() + Eigen::Vector3d(0.02, -0.01, 0.01);
  prior.turn = so3::log(truth.end().linear() * truth.begin().linear().transpose()) +
               Eigen::Vector3d(0.01, 0.0, 0.02);
  prior.location = 0.01;
  prior.orientation = 0.02;
  prior.velocity = 0.03;
  prior.angular_velocity = 0.05;
  prior.small_velocity = 0.001;
  prior.velocity_change = 0.02;
  prior.angular_velocity_change = 0.03;
  return prior;
}

double largest_gap(const ElasticMotion& a, const ElasticMotion& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.knots.size(); ++i)
    largest = std::max(largest, (a.knots[i].matrix() - b.knots[i].matrix()).norm());
  return largest;
}

TEST(ElasticAlignment, FindsTheTrueMotionFromPerfectMatches) {
  for (const int segments : {1, 2, 3}) {
    const Scene s = scene(segments, 0.0);
    const ElasticProblem problem{s.matches, {}, RobustKernel::kCauchy, 0.1, true};
    const auto guess = ElasticMotion::still(pose_of(0.1, 0.0, 0.0, 0, 0, 0.2), segments);
    const auto ours = align_by_gauss_newton(problem, guess, 30, Parallel(1));
    EXPECT_LT(largest_gap(ours, s.truth), 1e-9) << segments;
    // Ceres stops at a relative change of cost of 1e-6, here of a cost near zero
    EXPECT_LT(largest_gap(align_by_ceres(problem, guess, 60), s.truth), 1e-6) << segments;
  }
}

TEST(ElasticAlignment, BothSolversFindTheSameMinimumWithEveryTermAndLoss) {
  for (const int segments : {1, 2, 3}) {
    for (const RobustKernel kernel :
         {RobustKernel::kNone, RobustKernel::kHuber, RobustKernel::kCauchy, RobustKernel::kTukey}) {
      const Scene s = scene(segments, 0.02, 0.05, true);
      const double scale = kernel == RobustKernel::kTukey ? 0.5 : 0.1;
      const ElasticProblem problem{s.matches, full_prior(s.truth), kernel, scale, true};
      const auto ours = align_by_gauss_newton(problem, s.truth, 60, Parallel(1));
      const auto theirs = align_by_ceres(problem, s.truth, 60);
      // Ceres stops when a step lowers the cost by less than 1e-6 of it. A knot's curvature is at
      // least 1 / 9 / segments of all matches: a third for the direction, a third for the mean
      // square of a hat function over the scan.
      const double curvature = static_cast<double>(s.matches.size()) / (9.0 * segments);
      const double bound = std::sqrt(2.0 * 1e-6 * cost_of(problem, theirs) / curvature);
      EXPECT_LT(largest_gap(ours, theirs), bound) << segments;
      EXPECT_LE(cost_of(problem, ours), cost_of(problem, theirs) * (1.0 + 1e-9));
    }
  }
}

TEST(ElasticAlignment, TheMinimumIsOneOfTheCostInEveryDirection) {
  const Scene s = scene(2, 0.02, 0.05, true);
  const ElasticProblem problem{s.matches, full_prior(s.truth), RobustKernel::kCauchy, 0.1, true};
  const auto found = align_by_gauss_newton(problem, s.truth, 60, Parallel(1));
  const double least = cost_of(problem, found);
  for (std::size_t knot = 0; knot < found.knots.size(); ++knot) {
    for (int k = 0; k < 6; ++k) {
      for (const double h : {-1e-4, 1e-4}) {
        ElasticMotion other = found;
        Pose& pose = other.knots[knot];
        if (k < 3) pose.translation()[k] += h;
        if (k >= 3) pose.linear() = so3::exp(h * Eigen::Vector3d::Unit(k - 3)) * pose.linear();
        EXPECT_GT(cost_of(problem, other), least);
      }
    }
  }
}

TEST(ElasticAlignment, ALossHoldsOutliersBack) {
  const Scene s = scene(1, 0.01, 0.1);
  const auto error = [&](RobustKernel kernel) {
    const ElasticProblem problem{s.matches, {}, kernel, 0.05, true};
    return largest_gap(align_by_gauss_newton(problem, s.truth, 30, Parallel(1)), s.truth);
  };
  // 60 of 600 points are off by 0.7 m in the same direction: an error of 7 cm without a robust
  // kernel. With a Cauchy kernel the influence of such an error is 0.05^2 / 0.7 = 3.6 mm, for a
  // tenth of all points 0.4 mm, beside noise of 1 cm / sqrt(100) per direction.
  EXPECT_GT(error(RobustKernel::kNone), 0.05);
  EXPECT_LT(error(RobustKernel::kCauchy), 0.01);
  EXPECT_LT(error(RobustKernel::kTukey), error(RobustKernel::kNone) / 5.0);
}

TEST(ElasticAlignment, TheFirstOrderStandInEndsAtTheSamePlaceForASmallTurn) {
  Scene s = scene(1, 0.0);
  const ElasticProblem exact{s.matches, {}, RobustKernel::kNone, 1.0, true};
  ElasticProblem first_order = exact;
  first_order.exact_slerp = false;
  const auto guess = ElasticMotion::still(s.truth.begin(), 1);
  const auto a = align_by_gauss_newton(exact, guess, 6, Parallel(1));
  const auto b = align_by_gauss_newton(first_order, guess, 6, Parallel(1));
  EXPECT_LT(largest_gap(a, s.truth), 1e-9);
  EXPECT_LT(largest_gap(b, s.truth), 1e-4) << "converges, but only linearly";
}

TEST(ElasticAlignment, IsTheSameBitsOnAnyNumberOfThreads) {
  const Scene s = scene(2, 0.02, 0.05);
  const ElasticProblem problem{s.matches, full_prior(s.truth), RobustKernel::kCauchy, 0.1, true};
  const auto one = align_by_gauss_newton(problem, s.truth, 5, Parallel(1));
  const auto three = align_by_gauss_newton(problem, s.truth, 5, Parallel(3));
  for (std::size_t i = 0; i < one.knots.size(); ++i)
    EXPECT_EQ(one.knots[i].matrix(), three.knots[i].matrix());
}

TEST(ElasticAlignment, WhatNothingTellsStaysAsItWas) {
  Scene s = scene(1, 0.0);
  for (ElasticMatch& match : s.matches) {
    match.anchor = s.truth.end() * match.point;  // a rigid scan, taken at its end
    match.alpha = 1.0;
  }
  const ElasticProblem problem{s.matches, {}, RobustKernel::kCauchy, 0.1, true};
  const ElasticMotion guess = ElasticMotion::still(Pose::Identity(), 1);
  const auto ours = align_by_gauss_newton(problem, guess, 20, Parallel(1));
  EXPECT_LT((ours.end().matrix() - s.truth.end().matrix()).norm(), 1e-9);
  EXPECT_LT((ours.begin().matrix() - guess.begin().matrix()).norm(), 1e-9);
  const ElasticProblem nothing{{}, {}, RobustKernel::kCauchy, 0.1, true};
  EXPECT_EQ(largest_gap(align_by_gauss_newton(nothing, guess, 5, Parallel(1)), guess), 0.0);
  EXPECT_EQ(largest_gap(align_by_ceres(nothing, guess, 5), guess), 0.0);
}

}  // namespace
}  // namespace lidarena::estimation
