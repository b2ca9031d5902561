// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/cloud_comparison.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "lidarena/base/error.hpp"
#include "lidarena/base/random.hpp"

namespace lidarena::evaluation {
namespace {

/// A floor of 1.6 x 1.6 m with a point each 4 cm, at a height.
std::vector<Eigen::Vector3f> floor_at(float z, int columns = 40) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < columns; ++i) {
    for (int k = 0; k < 40; ++k)
      points.emplace_back(0.04F * static_cast<float>(i), 0.04F * static_cast<float>(k), z);
  }
  return points;
}

TEST(CompareClouds, AShiftedCopyIsThatFarAway) {
  const CloudComparison found =
      compare_clouds(floor_at(0.02F), floor_at(0.0F), "test", Parallel(2));
  EXPECT_NEAR(found.accuracy_m, 0.02, 1e-6);
  EXPECT_NEAR(found.completeness_m, 0.02, 1e-6);
  EXPECT_NEAR(found.chamfer_m, 0.02, 1e-6);
  EXPECT_EQ(found.f_score_5cm, 1.0);
  const CloudComparison far = compare_clouds(floor_at(0.07F), floor_at(0.0F), "test", Parallel(1));
  EXPECT_EQ(far.f_score_5cm, 0.0);
  EXPECT_EQ(far.f_score_10cm, 1.0);
}

TEST(CompareClouds, HalfAMapIsAccurateButNotComplete) {
  const CloudComparison found =
      compare_clouds(floor_at(0.0F, 20), floor_at(0.0F), "test", Parallel(1));
  EXPECT_EQ(found.accuracy_m, 0.0);
  // rows 21 to 40 are 4 cm, 8 cm ... 80 cm from the last row of the map
  EXPECT_NEAR(found.completeness_m, 0.04 * (20.0 * 21.0 / 2.0) / 40.0, 1e-6);
  const auto f_score = [](double recall) { return 2.0 * recall / (1.0 + recall); };
  EXPECT_NEAR(found.f_score_5cm, f_score(21.0 / 40.0), 1e-12);
  EXPECT_NEAR(found.f_score_10cm, f_score(22.0 / 40.0), 1e-12);
}

TEST(CompareClouds, PointsThatAreNotFiniteAreLeftOut) {
  auto map = floor_at(0.0F);
  map.emplace_back(NAN, 0.0F, 0.0F);
  EXPECT_EQ(compare_clouds(map, floor_at(0.0F), "test", Parallel(1)).map_points, 1600U);
  EXPECT_THROW(compare_clouds({}, map, "test", Parallel(1)), InputError);
}

/// A plane of 3 x 3 m with normal noise of `sigma` across it.
std::vector<Eigen::Vector3f> noisy_plane(double sigma) {
  SequentialRandom random(5);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 20'000; ++i) {
    points.emplace_back(static_cast<float>(random.uniform(0.0, 3.0)),
                        static_cast<float>(random.uniform(0.0, 3.0)),
                        static_cast<float>(sigma * random.normal()));
  }
  return points;
}

TEST(MapAgreement, ThePlanesThicknessIsTheirNoise) {
  for (const double sigma : {0.005, 0.02, 0.05}) {
    const MapAgreement found = map_agreement(noisy_plane(sigma), Parallel(2));
    EXPECT_GT(found.neighborhoods, 19'000U);
    EXPECT_NEAR(found.plane_thickness_m, sigma, 0.08 * sigma);  // the flatter half is flatter
  }
}

TEST(MapAgreement, EntropyGrowsWithTheLogarithmOfTheThickness) {
  const double thin = map_agreement(noisy_plane(0.005), Parallel(1)).mean_map_entropy;
  const double thick = map_agreement(noisy_plane(0.02), Parallel(1)).mean_map_entropy;
  EXPECT_NEAR(thick - thin, std::log(4.0), 0.02);
  // a disc of radius r: variance r^2 / 4 along each of its axes; edges of the plane are smaller
  const double disc = 0.3 * 0.3 / 4.0;
  const double expected = 0.5 * std::log(std::pow(2.0 * std::numbers::pi * std::numbers::e, 3) *
                                         disc * disc * 0.005 * 0.005);
  EXPECT_NEAR(thin, expected, 0.2);
}

TEST(MapAgreement, ASparseMapHasNone) {
  const std::vector<Eigen::Vector3f> points{{0, 0, 0}, {5, 0, 0}, {0, 5, 0}};
  EXPECT_EQ(map_agreement(points, Parallel(1)).neighborhoods, 0U);
}

}  // namespace
}  // namespace lidarena::evaluation
