// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/pose_graph.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "lidarena/base/error.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "tests/estimation/random_vector.hpp"

namespace lidarena::estimation {
namespace {

using Covariance = PoseGraph::Covariance;
using Eigen::Vector3d;

constexpr double kExact = 1e-6;  // accuracy of the solver

Pose random_pose(SequentialRandom& random, double meters, double radians) {
  const Vector3d turn = random_vector(random, radians);
  return make_pose(so3::exp(turn), random_vector(random, meters));
}

Pose along_x(double meters) { return make_pose(Eigen::Matrix3d::Identity(), {meters, 0.0, 0.0}); }

double distance(const Pose& a, const Pose& b) {
  return (a.translation() - b.translation()).norm() +
         so3::angle(a.linear().transpose() * b.linear());
}

/// A chain of edges between neighbors in `truth`, each with the error `off`.
PoseGraph chain(const std::vector<Pose>& truth, const Pose& off, const Covariance& covariance) {
  PoseGraph graph;
  graph.nodes.push_back(truth.front());
  graph.priors.push_back({0, truth.front(), 1e-8 * Covariance::Identity()});
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const Pose step = truth[i - 1].inverse() * truth[i] * off;
    graph.betweens.push_back({i - 1, i, step, covariance});
    graph.nodes.push_back(graph.nodes.back() * step);
  }
  return graph;
}

TEST(PoseGraph, AChainWithoutLoopsStaysAsTheOdometryHasIt) {
  SequentialRandom random(1, 1);
  std::vector<Pose> truth{Pose::Identity()};
  for (int i = 0; i < 10; ++i) truth.push_back(truth.back() * random_pose(random, 1.0, 0.5));
  const PoseGraph graph = chain(truth, Pose::Identity(), 1e-4 * Covariance::Identity());
  const PoseGraphSolution solution = optimize(graph);
  EXPECT_TRUE(solution.converged);
  EXPECT_LT(solution.final_cost, 1e-15);
  for (std::size_t i = 0; i < truth.size(); ++i)
    EXPECT_LT(distance(solution.nodes[i], truth[i]), kExact);
}

TEST(PoseGraph, PerfectMeasurementsPullWrongGuessesHome) {
  SequentialRandom random(2, 1);
  std::vector<Pose> truth{Pose::Identity()};
  for (int i = 0; i < 12; ++i) truth.push_back(truth.back() * random_pose(random, 1.0, 0.4));
  PoseGraph graph = chain(truth, Pose::Identity(), 1e-4 * Covariance::Identity());
  graph.betweens.push_back({12, 0, truth[12].inverse() * truth[0], 1e-4 * Covariance::Identity()});
  for (Pose& node : graph.nodes) node = node * random_pose(random, 0.3, 0.2);
  const PoseGraphSolution solution = optimize(graph);
  EXPECT_GT(solution.initial_cost, 1.0);
  for (std::size_t i = 0; i < truth.size(); ++i)
    EXPECT_LT(distance(solution.nodes[i], truth[i]), kExact) << i;
}

TEST(PoseGraph, ALoopsErrorIsSharedOutByVariance) {
  // On a line, four odometry steps of 1 m; the loop measures 4.4 m in total. Steps have variances
  // 1, 2, 3 and 4, the loop 2, in total 12: the excess of 0.4 m is distributed in proportion to
  // them.
  PoseGraph graph;
  graph.nodes.assign(5, Pose::Identity());
  graph.priors.push_back({0, Pose::Identity(), 1e-10 * Covariance::Identity()});
  for (std::size_t i = 0; i < 4; ++i) {
    graph.nodes[i + 1] = along_x(static_cast<double>(i) + 1.0);
    graph.betweens.push_back(
        {i, i + 1, along_x(1.0), (static_cast<double>(i) + 1.0) * Covariance::Identity()});
  }
  graph.betweens.push_back({0, 4, along_x(4.4), 2.0 * Covariance::Identity()});
  const PoseGraphSolution solution = optimize(graph);
  const double share = 0.4 / 12.0;
  const double expected[] = {0.0, 1.0 + share, 2.0 + 3.0 * share, 3.0 + 6.0 * share,
                             4.0 + 10.0 * share};
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_NEAR(solution.nodes[i].translation().x(), expected[i], kExact);
  EXPECT_NEAR(solution.final_cost, 0.5 * 0.4 * 0.4 / 12.0, 1e-9);
}

TEST(PoseGraph, ATurnTooMuchIsTakenBackEvenlyAllAroundACircle) {
  // 12 equal steps around a circle, the closing one included, each rotated 1 degree too far. By
  // symmetry every edge has the same rotation in the solution, so each is corrected by 1 degree.
  const double step = std::numbers::pi / 6.0;
  const auto on_circle = [&](int i) {
    return make_pose(so3::exp({0, 0, step * i}),
                     {5.0 * std::sin(step * i), 5.0 - 5.0 * std::cos(step * i), 0.0});
  };
  std::vector<Pose> truth;
  for (int i = 0; i < 12; ++i) truth.push_back(on_circle(i));
  const Pose off = make_pose(so3::exp({0.0, 0.0, std::numbers::pi / 180.0}), Vector3d::Zero());
  // Translations have so little weight that they do not resist the rotation.
  Covariance loose = Covariance::Identity();
  loose.topLeftCorner<3, 3>() *= 1e6;
  loose.bottomRightCorner<3, 3>() *= 1e-6;
  PoseGraph graph = chain(truth, off, loose);
  graph.betweens.push_back({11, 0, truth[11].inverse() * truth[0] * off, loose});
  EXPECT_GT(so3::angle(graph.nodes[11].linear().transpose() * truth[11].linear()), 0.19);
  const PoseGraphSolution solution = optimize(graph);
  for (int i = 0; i < 12; ++i) {
    const auto index = static_cast<std::size_t>(i);
    EXPECT_LT(so3::angle(solution.nodes[index].linear().transpose() * truth[index].linear()), 1e-5)
        << i;
  }
}

TEST(PoseGraph, AWrongLoopBendsTheChainUnlessItsKernelIsRobust) {
  // 20 m straight ahead, and a false loop that puts the end at the start.
  std::vector<Pose> truth;
  for (int i = 0; i <= 20; ++i) truth.push_back(along_x(i));
  const auto end_with = [&](RobustLoss loss) {
    PoseGraph graph = chain(truth, Pose::Identity(), 1e-4 * Covariance::Identity());
    graph.betweens.push_back({0, 20, Pose::Identity(), 1e-4 * Covariance::Identity(), loss});
    return optimize(graph).nodes.back().translation().x();
  };
  EXPECT_NEAR(end_with({}), 20.0 / 21.0, 0.01)
      << "same weight as any step: 1/21 of the length is left";
  EXPECT_LT(end_with({RobustKernel::kHuber, 1.0}), 19.9)
      << "linear kernel: the loop still has influence";
  EXPECT_GT(end_with({RobustKernel::kCauchy, 1.0}), 19.98);
  EXPECT_NEAR(end_with({RobustKernel::kTukey, 5.0}), 20.0, kExact) << "the loop has no influence";
}

TEST(PoseGraph, ATrueLoopCountsUnderARobustKernel) {
  std::vector<Pose> truth;
  for (int i = 0; i <= 20; ++i) truth.push_back(along_x(i));
  // odometry 2 cm per step too long; the loop is correct
  PoseGraph graph = chain(truth, along_x(0.02), 1e-3 * Covariance::Identity());
  EXPECT_NEAR(graph.nodes.back().translation().x(), 20.4, 1e-9);
  graph.betweens.push_back(
      {0, 20, along_x(20.0), 1e-3 * Covariance::Identity(), {RobustKernel::kCauchy, 3.0}});
  EXPECT_LT(optimize(graph).nodes.back().translation().x(), 20.04);
}

TEST(PoseGraph, PositionsHoldTheGraphWhereTheyAreTold) {
  SequentialRandom random(3, 1);
  std::vector<Pose> truth{Pose::Identity()};
  for (int i = 0; i < 6; ++i) truth.push_back(truth.back() * random_pose(random, 2.0, 0.5));
  PoseGraph graph = chain(truth, Pose::Identity(), 1e-4 * Covariance::Identity());
  graph.priors.clear();
  const Pose elsewhere = make_pose(so3::exp({0.1, 0.2, 1.5}), {10.0, 20.0, 5.0});
  for (const std::size_t node : {0U, 2U, 5U}) {
    graph.positions.push_back(
        {node, elsewhere * truth[node].translation(), 1e-4 * Eigen::Matrix3d::Identity()});
  }
  const PoseGraphSolution solution = optimize(graph);
  for (std::size_t i = 0; i < truth.size(); ++i)
    EXPECT_LT(distance(solution.nodes[i], elsewhere * truth[i]), 1e-5) << i;
}

TEST(PoseGraph, WithoutPriorsTheFirstNodeStays) {
  PoseGraph graph;
  graph.nodes = {along_x(3.0), along_x(9.0)};
  graph.betweens.push_back({0, 1, along_x(1.0), Covariance::Identity()});
  const PoseGraphSolution solution = optimize(graph);
  EXPECT_EQ(solution.nodes[0].translation(), Vector3d(3.0, 0.0, 0.0));
  EXPECT_NEAR(solution.nodes[1].translation().x(), 4.0, kExact);
}

TEST(PoseGraph, DistancesAreInSigmas) {
  PoseGraph graph;
  graph.nodes = {Pose::Identity(), along_x(1.3)};
  EXPECT_NEAR(squared_mahalanobis(graph, {0, 1, along_x(1.0), 0.01 * Covariance::Identity()}), 9.0,
              1e-12);
}

TEST(PoseGraph, TheSameGraphGivesTheSameBits) {
  SequentialRandom random(4, 1);
  std::vector<Pose> truth{Pose::Identity()};
  for (int i = 0; i < 30; ++i) truth.push_back(truth.back() * random_pose(random, 1.0, 0.4));
  PoseGraph graph = chain(truth, random_pose(random, 0.01, 0.01), 1e-4 * Covariance::Identity());
  graph.betweens.push_back({3, 29, truth[3].inverse() * truth[29], 1e-4 * Covariance::Identity()});
  const auto a = optimize(graph).nodes;
  const auto b = optimize(graph).nodes;
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].matrix(), b[i].matrix());
}

TEST(PoseGraph, WhatCannotBeSolvedIsRefused) {
  PoseGraph graph;
  graph.nodes = {Pose::Identity()};
  graph.betweens.push_back({0, 1, Pose::Identity(), Covariance::Identity()});
  EXPECT_THROW(optimize(graph), InputError) << "no node 1";
  graph.priors.push_back({1, Pose::Identity(), Covariance::Identity()});
  EXPECT_THROW(optimize(graph), InputError) << "a prior of a node that does not exist";
  graph.priors.clear();
  graph.nodes.push_back(Pose::Identity());
  graph.betweens.front().covariance(2, 2) = 0.0;
  EXPECT_THROW(optimize(graph), InputError) << "singular";
  graph.betweens.clear();
  graph.nodes.back().translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(optimize(graph), InputError) << "not finite";
  EXPECT_TRUE(optimize(PoseGraph{}).nodes.empty());
}

TEST(PoseGraph, AChainIsPutTogetherStepByStepAndStartsWhereItIsTold) {
  PoseGraph graph;
  for (int i = 0; i < 3; ++i)
    append_to_chain(along_x(1.0 + i), diagonal_covariance(4.0, 9.0), graph);
  ASSERT_EQ(graph.nodes.size(), 3U);
  EXPECT_LT(distance(graph.nodes[2], along_x(6.0)), 1e-12);
  ASSERT_EQ(graph.priors.size(), 1U);
  ASSERT_EQ(graph.betweens.size(), 2U);
  EXPECT_EQ(graph.betweens[1].first, 1U);
  EXPECT_EQ(graph.betweens[1].covariance(2, 2), 4.0);
  EXPECT_EQ(graph.betweens[1].covariance(3, 3), 9.0);
  EXPECT_LT(distance(optimize(graph).nodes[0], along_x(1.0)), kExact);
  EXPECT_GE(memory_bytes(graph), 3 * sizeof(Pose) + 2 * sizeof(PoseGraph::Between));
}

}  // namespace
}  // namespace lidarena::estimation
