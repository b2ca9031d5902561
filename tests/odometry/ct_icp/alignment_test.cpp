// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/alignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "tests/odometry/ct_icp/alignment_oracle.hpp"
#include "tests/odometry/ct_icp/pose_of.hpp"

namespace lidarena::odometry::ct_icp {
namespace {

const Parallel kOne(1);

/// Points in all directions at random times of a true motion, each with a plane through its true
/// position.
struct Scene {
  ElasticMotion truth;
  std::vector<ElasticMatch> matches;
};

Scene scene(double noise, double outlier_share = 0.0) {
  Scene result;
  result.truth = {pose_of(0.0, 0.0, 0.0, 0.0, 0.0, 0.1), pose_of(0.3, -0.1, 0.05, 0.1, 0.05, 0.4)};
  const CounterRandom random(7);
  for (std::uint64_t i = 0; i < 600; ++i) {
    const auto n = random.normals(i, 0);
    const auto m = random.normals(i, 1);
    ElasticMatch match;
    match.point = Eigen::Vector3d(5.0 * n[0], 5.0 * n[1], 3.0 * m[0]);
    match.alpha = random.uniform(i, 2);
    match.normal = Eigen::Vector3d::Unit(static_cast<int>(i % 3));
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
      truth.end.translation() - truth.begin.translation() + Eigen::Vector3d(0.02, -0.01, 0.01);
  prior.location = 0.01;
  prior.orientation = 0.5;
  prior.velocity = 0.03;
  prior.small_velocity = 0.001;
  return prior;
}

double largest_gap(const ElasticMotion& a, const ElasticMotion& b) {
  return std::max((a.begin.matrix() - b.begin.matrix()).norm(),
                  (a.end.matrix() - b.end.matrix()).norm());
}

/// The solver ends at a relative gain of 1e-6; started again there, it goes on.
ElasticMotion solved(const ElasticProblem& problem, ElasticMotion motion) {
  for (int i = 0; i < 3; ++i) motion = align(problem, motion, 60, kOne);
  return motion;
}

/// How far a solver that ends when a step lowers the cost by less than 1e-6 may end from the
/// minimum: there the cost is 1e-6 higher. A pose's curvature is at least a ninth of all matches: a
/// third for the direction, a third for the mean square of its share in a point's position.
double bound_at_end(const ElasticProblem& problem, const ElasticMotion& end) {
  const double curvature = static_cast<double>(problem.matches.size()) / 9.0;
  return std::sqrt(2.0 * 1e-6 * cost_of(problem, end) / curvature);
}

TEST(CtIcpAlignment, FindsTheTrueMotionFromPerfectMatches) {
  const Scene s = scene(0.0);
  const ElasticProblem problem{s.matches, {}, 0.1};
  const auto guess = ElasticMotion::still(pose_of(0.1, 0.0, 0.0, 0, 0, 0.2));
  // the relative change of cost refers to a cost that goes to zero
  EXPECT_LT(largest_gap(align(problem, guess, 60, kOne), s.truth), 1e-6);
}

TEST(CtIcpAlignment, AndCeresFindTheSameMinimumWithEveryTerm) {
  const Scene s = scene(0.02, 0.05);
  const ElasticProblem problem{s.matches, full_prior(s.truth), 0.1};
  const auto ours = align(problem, s.truth, 60, kOne);
  const auto theirs = oracle::align_by_ceres(problem, s.truth, 60);
  EXPECT_LT(largest_gap(ours, theirs), bound_at_end(problem, theirs));
  EXPECT_LE(cost_of(problem, ours), cost_of(problem, theirs) * (1.0 + 1e-6));
}

TEST(CtIcpAlignment, EachTermOfThePriorMovesTheMinimumWhereCeresSaysItDoes) {
  const Scene s = scene(0.02, 0.05);
  const MotionPrior all = full_prior(s.truth);
  const ElasticProblem without{s.matches, {}, 0.1};
  const auto free = solved(without, s.truth);
  for (const auto term : {&MotionPrior::location, &MotionPrior::orientation, &MotionPrior::velocity,
                          &MotionPrior::small_velocity}) {
    MotionPrior prior;
    prior.begin = pose_of(0.2, 0.1, -0.3, 0.1, 0.2, -0.4);  // far off, so that the pull is seen
    prior.step = all.step + Eigen::Vector3d(0.2, -0.1, 0.1);
    prior.*term = 0.5;
    const ElasticProblem problem{s.matches, prior, 0.1};
    const auto ours = solved(problem, s.truth);
    const auto theirs = oracle::align_by_ceres(problem, s.truth, 100);
    const double bound = bound_at_end(problem, theirs);
    EXPECT_LT(largest_gap(ours, theirs), bound);
    EXPECT_GT(largest_gap(ours, free), 3.0 * bound) << "the term has an effect";
  }
}

TEST(CtIcpAlignment, TheFirstStepsAreThoseOfCeres) {
  // Few steps with frozen matches are a part of the published method: they must not only end at the
  // same minimum but get as far at each step.
  const Scene s = scene(0.02, 0.05);
  const ElasticProblem problem{s.matches, full_prior(s.truth), 0.1};
  const auto guess = ElasticMotion::still(pose_of(0.2, -0.1, 0.1, 0.05, 0, 0.3));
  for (const int steps : {1, 2, 3}) {
    const auto ours = align(problem, guess, steps, kOne);
    const auto theirs = oracle::align_by_ceres(problem, guess, steps);
    // Ceres adds half rotation vectors to quaternions and damps after scaling its columns, which
    // changes a step of 0.2 by some 1e-4 of the damping of 1e-4
    EXPECT_LT(largest_gap(ours, theirs), 1e-4 * largest_gap(guess, theirs)) << steps;
  }
}

TEST(CtIcpAlignment, NeverEndsAtAHigherCost) {
  const Scene s = scene(0.05, 0.3);
  const ElasticProblem problem{s.matches, {}, 0.05};
  for (int i = 0; i < 40; ++i) {  // up to a turn of 2 rad and 2 m, where plain steps overshoot
    const double size = 0.05 * i;
    const auto guess = ElasticMotion::still(pose_of(size, -size, 0.5 * size, size, 0.0, -size));
    for (const int steps : {1, 5, 20}) {
      const auto found = align(problem, guess, steps, kOne);
      EXPECT_LE(cost_of(problem, found), cost_of(problem, guess)) << i << " " << steps;
    }
  }
}

TEST(CtIcpAlignment, TheMinimumIsOneOfTheCostInEveryDirection) {
  const Scene s = scene(0.02, 0.05);
  const ElasticProblem problem{s.matches, full_prior(s.truth), 0.1};
  const ElasticMotion found = solved(problem, s.truth);
  const double least = cost_of(problem, found);
  for (const auto end : {&ElasticMotion::begin, &ElasticMotion::end}) {
    for (int k = 0; k < 6; ++k) {
      for (const double h : {-1e-3, 1e-3}) {
        ElasticMotion other = found;
        Pose& pose = other.*end;
        if (k < 3) pose.translation()[k] += h;
        if (k >= 3) pose.linear() = so3::exp(h * Eigen::Vector3d::Unit(k - 3)) * pose.linear();
        EXPECT_GT(cost_of(problem, other), least);
      }
    }
  }
}

TEST(CtIcpAlignment, TheKernelHoldsOutliersBack) {
  const Scene s = scene(0.01, 0.1);
  const auto error = [&](double scale) {
    return largest_gap(solved({s.matches, {}, scale}, s.truth), s.truth);
  };
  // 60 of 600 points are off by 0.7 m in the same direction: an error of 7 cm when the kernel is
  // far wider. At a scale of 5 cm the influence of such an error is 0.05^2 / 0.7 = 3.6 mm, for a
  // tenth of all points 0.4 mm, beside noise of 1 cm / sqrt(100) per direction.
  EXPECT_GT(error(100.0), 0.05);
  EXPECT_LT(error(0.05), 0.01);
}

TEST(CtIcpAlignment, IsTheSameBitsOnAnyNumberOfThreads) {
  const Scene s = scene(0.02, 0.05);
  const ElasticProblem problem{s.matches, full_prior(s.truth), 0.1};
  const auto guess = ElasticMotion::still(s.truth.begin);
  EXPECT_EQ(largest_gap(align(problem, guess, 5, kOne), align(problem, guess, 5, Parallel(3))),
            0.0);
}

TEST(CtIcpAlignment, WhatNothingTellsStaysAsItWas) {
  Scene s = scene(0.0);
  for (ElasticMatch& match : s.matches) {
    match.anchor = s.truth.end * match.point;  // a rigid scan, taken at its end
    match.alpha = 1.0;
  }
  const ElasticProblem problem{s.matches, {}, 0.1};
  const ElasticMotion guess;
  const ElasticMotion found = align(problem, guess, 40, kOne);
  EXPECT_LT((found.end.matrix() - s.truth.end.matrix()).norm(), 1e-6);
  EXPECT_LT((found.begin.matrix() - guess.begin.matrix()).norm(), 1e-9);
  const ElasticProblem nothing{{}, {}, 0.1};
  EXPECT_EQ(largest_gap(align(nothing, guess, 5, kOne), guess), 0.0);
}

TEST(CtIcpAlignment, ObservabilityIsTheShareOfTheWeakestDirection) {
  std::vector<ElasticMatch> matches(12);
  for (std::size_t i = 0; i < matches.size(); ++i)
    matches[i].normal = Eigen::Vector3d::Unit(static_cast<int>(i % 3));
  EXPECT_NEAR(observability_of(matches), 1.0 / 3.0, 1e-12);
  for (ElasticMatch& match : matches) {
    if (match.normal.z() == 1.0) match.normal = Eigen::Vector3d::UnitX();
  }
  EXPECT_NEAR(observability_of(matches), 0.0, 1e-12);
}

}  // namespace
}  // namespace lidarena::odometry::ct_icp
