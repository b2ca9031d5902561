// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/echoes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lidarena/base/random.hpp"

namespace lidarena::sensor {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

std::vector<Echo> merged(std::vector<Echo> parts, double pulse_length) {
  std::vector<Echo> echoes;
  merge_echoes(parts, pulse_length, echoes);
  return echoes;
}

TEST(Echoes, SurfacesWithinAPulseMixByTheirSignals) {
  const auto echoes = merged({{5.4, 0.1, 3.0, 0}, {5.0, 0.2, 1.0, 1}}, 0.5);
  ASSERT_EQ(echoes.size(), 1U);
  EXPECT_DOUBLE_EQ(echoes[0].range, (3.0 * 5.4 + 1.0 * 5.0) / 4.0);
  EXPECT_DOUBLE_EQ(echoes[0].energy, 0.3);
  EXPECT_DOUBLE_EQ(echoes[0].signal, 4.0);
  EXPECT_EQ(echoes[0].sub_ray, 0U);
}

TEST(Echoes, SurfacesAPulseApartAreEchoesOfTheirOwnNearestFirst) {
  const auto echoes =
      merged({{9.0, 0.1, 1.0, 0}, {5.0, 0.1, 2.0, 1}, {9.3, 0.1, 3.0, 2}, {5.1, 0.1, 2.0, 3}}, 0.5);
  ASSERT_EQ(echoes.size(), 2U);
  EXPECT_DOUBLE_EQ(echoes[0].range, 5.05);
  EXPECT_DOUBLE_EQ(echoes[1].range, (9.0 + 3.0 * 9.3) / 4.0);
  EXPECT_EQ(echoes[0].sub_ray, 1U);  // equal signals: the nearer part
  EXPECT_EQ(echoes[1].sub_ray, 2U);
}

TEST(Echoes, NothingMakesNoneAndBlackKeepsARange) {
  EXPECT_TRUE(merged({}, 0.5).empty());
  const auto black = merged({{3.0, 0.0, 0.0, 0}}, 0.5);
  ASSERT_EQ(black.size(), 1U);
  EXPECT_DOUBLE_EQ(black[0].range, 3.0);
}

TEST(Echoes, AreReportedInTheOrderAskedFor) {
  const std::vector<Echo> three{
      {1.0, 0.1, 2.0, 0}, {2.0, 0.1, 5.0, 0}, {3.0, 0.1, 3.0, 0}};  // nearest first
  const auto ranges = [&](EchoChoice choice, int count) {
    std::vector<Echo> echoes = three;
    choose_echoes({.choice = choice, .count = count}, echoes);
    std::vector<double> out;
    for (const Echo& echo : echoes) out.push_back(echo.range);
    return out;
  };
  EXPECT_EQ(ranges(EchoChoice::kStrongest, 5), (std::vector<double>{2, 3, 1}));
  EXPECT_EQ(ranges(EchoChoice::kStrongest, 1), (std::vector<double>{2}));
  EXPECT_EQ(ranges(EchoChoice::kFirst, 2), (std::vector<double>{1, 2}));
  EXPECT_EQ(ranges(EchoChoice::kLast, 2), (std::vector<double>{3, 2}));
}

TEST(SubRays, HaveTheProfilesSpreadAlikeInBothDirections) {
  constexpr int kCount = 4096;
  Vector2d sum = Vector2d::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  int beyond_one_sigma = 0;
  for (const Vector2d& offset : sub_ray_offsets(kCount)) {
    sum += offset / kCount;
    squares += offset * offset.transpose() / kCount;
    if (offset.x() > 1.0) ++beyond_one_sigma;
  }
  // The mean over a regular spiral of n rays approximates integrals to about 1 / sqrt(n), the width
  // of a cell.
  EXPECT_LT(sum.norm(), 0.02);
  EXPECT_LT((squares - Eigen::Matrix2d::Identity()).norm(), 0.02);
  EXPECT_NEAR(beyond_one_sigma / static_cast<double>(kCount), 0.158655, 0.01);
}

TEST(SubRays, AreTurnedAsideByTheAnglesAsked) {
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(-0.6, 0.64, 0.48), Vector3d(0, 0, 1)}) {
    const Vector3d left = deflected(axis, {1e-3, 0.0});
    const Vector3d up = deflected(axis, {0.0, 1e-3});
    EXPECT_NEAR(std::atan2(left.cross(axis).norm(), left.dot(axis)), 1e-3, 1e-9);
    EXPECT_NEAR(std::atan2(up.cross(axis).norm(), up.dot(axis)), 1e-3, 1e-9);
    EXPECT_NEAR((left - axis).dot(up - axis), 0.0, 1e-9);
    if (axis.z() < 1) {
      EXPECT_NEAR(left.z() - axis.z(), 0.0, 1e-6);
      EXPECT_GT(up.z(), axis.z());
      EXPECT_GT(axis.cross(left).z(), 0.0);  // left is counterclockwise seen from above
    }
  }
}

TEST(SlightlyDeflected, IsTheExactRotationInSinglePrecision) {
  SequentialRandom random(2);
  for (int i = 0; i < 1000; ++i) {
    Eigen::Vector3d axis(random.normal(), random.normal(), i % 10 == 0 ? 1e9 : random.normal());
    axis.normalize();
    const Eigen::Vector2d angles(2e-3 * random.normal(), 2e-3 * random.normal());
    const Eigen::Vector3f fast = slightly_deflected(
        axis.cast<float>(), static_cast<float>(angles.x()), static_cast<float>(angles.y()));
    EXPECT_LT((fast.cast<double>() - deflected(axis, angles)).norm(), 3e-7) << axis.transpose();
  }
}

}  // namespace
}  // namespace lidarena::sensor
