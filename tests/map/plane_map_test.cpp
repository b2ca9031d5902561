// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/plane_map.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "lidarena/base/error.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"

namespace lidarena::map {
namespace {

using Points = std::vector<Eigen::Vector3f>;

/// Points of the tilted plane with unit normal `normal` at `offset` (m) from the origin, 3 x 3 m.
Points wall(const Eigen::Vector3d& normal, double offset, double noise, int count) {
  SequentialRandom random(5, 1);
  const Eigen::Vector3d u = normal.unitOrthogonal();
  const Eigen::Vector3d v = normal.cross(u);
  Points points;
  for (int i = 0; i < count; ++i) {
    const double a = 3.0 * random.uniform();
    const double b = 3.0 * random.uniform();
    const Eigen::Vector3d p = (offset + noise * random.normal()) * normal + a * u + b * v;
    points.push_back(p.cast<float>());
  }
  return points;
}

const Eigen::Vector3d kNormal = Eigen::Vector3d(1.0, -2.0, 0.5).normalized();

TEST(PlaneMap, FindsTheWallInItsCells) {
  PlaneMap map({});
  const Points points = wall(kNormal, 7.0, 0.01, 20'000);
  map.insert(points);
  int found = 0;
  for (const Eigen::Vector3f& point : points) {
    const MapPlane* plane = map.plane_at(point);
    if (plane == nullptr) continue;
    ++found;
    const double off = kNormal.dot(plane->center.cast<double>()) - 7.0;
    EXPECT_LT(std::abs(off), 0.01) << "five sigmas of the mean of 25 points";
    EXPECT_LT(plane->variance, 4e-4);
  }
  EXPECT_GT(found, 17'000) << "all but those in corners that the wall cuts off cells";
  EXPECT_EQ(map.plane_at({0.0F, 0.0F, 0.0F}), nullptr);
}

/// Inserts points of a square patch of a cell, 0.26 m wide, with 1 cm of noise, and its heights.
template <class Height>
const MapPlane& patch(PlaneMap& map, int count, SequentialRandom& random, Height&& height) {
  Points points;
  for (int i = 0; i < count; ++i) {
    const double x = 0.02 + 0.26 * random.uniform();
    const double y = 0.02 + 0.26 * random.uniform();
    points.push_back(Eigen::Vector3d(x, y, height(x) + 0.01 * random.normal()).cast<float>());
    map.insert({&points.back(), 1});
  }
  return *map.plane_at(points.front());
}

TEST(PlaneMap, BoundsTheErrorOfANormalByFourStandardDeviations) {
  for (const int count : {30, 300}) {
    SequentialRandom random(6, 1);
    double stated = 0.0;
    double squared_error = 0.0;
    constexpr int kDraws = 500;
    for (int draw = 0; draw < kDraws; ++draw) {
      PlaneMap map({.axes = GridAxes::kParallel});
      const MapPlane& plane = patch(map, count, random, [](double) { return 0.15; });
      const double error = plane.normal.head<2>().norm();
      EXPECT_LT(error, 1.5 * plane.normal_error) << "the normal has two such errors";
      stated += plane.normal_error / kDraws;
      squared_error += error * error / 2.0 / kDraws;
    }
    // The narrower of the two spreads counts, and the fit is of up to a tenth fewer points.
    EXPECT_GT(stated, 4.0 * 0.95 * std::sqrt(squared_error)) << count;
    EXPECT_LT(stated, 4.0 * 1.3 * std::sqrt(squared_error)) << count;
  }
}

TEST(PlaneMap, TheNormalOfACornerStaysUnknownWithAnyNumberOfPoints) {
  SequentialRandom random(7, 1);
  const auto corner = [](double x) { return x < 0.15 ? 0.1 : 0.2; };
  PlaneMap few({.axes = GridAxes::kParallel});
  PlaneMap many({.axes = GridAxes::kParallel});
  const double of_few = patch(few, 40, random, corner).normal_error;
  const double of_many = patch(many, 400, random, corner).normal_error;
  EXPECT_GT(of_many, 0.2);
  EXPECT_GT(of_many, 0.5 * of_few);
}

/// The same by sorting all points into cells and fitting each at once, in double precision.
TEST(PlaneMap, HasThePlanesOfAllPointsOfACell) {
  const PlaneMap::Options options{.cell_size = 0.5, .axes = GridAxes::kParallel};
  PlaneMap map(options);
  // A cell is fitted anew each time it has a tenth more points: here at once.
  const Points points = wall(kNormal, 300.0, 0.02, 3'000);
  map.insert(points);
  std::map<std::tuple<int, int, int>, Points> cells;
  for (const Eigen::Vector3f& p : points) {
    const Voxel voxel = voxel_of(p, 2.0F);
    cells[{voxel.x(), voxel.y(), voxel.z()}].push_back(p);
  }
  EXPECT_EQ(map.size(), cells.size());
  int compared = 0;
  for (const auto& [voxel, own] : cells) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& p : own) mean += p.cast<double>() / static_cast<double>(own.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const auto& p : own) {
      const Eigen::Vector3d off = p.cast<double>() - mean;
      covariance += off * off.transpose() / static_cast<double>(own.size());
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
    const MapPlane* plane = map.plane_at(own.front());
    const bool is_wide = std::sqrt(std::max(0.0, axes.eigenvalues()[1])) >= options.min_width;
    ASSERT_EQ(plane != nullptr, own.size() >= 6 && is_wide) << own.size();
    if (plane == nullptr) continue;
    ++compared;
    EXPECT_LT((plane->center.cast<double>() - mean).norm(), 1e-4) << "float at 300 m: 0.03 mm";
    EXPECT_GT(std::abs(plane->normal.cast<double>().dot(axes.eigenvectors().col(0))), 1.0 - 1e-4);
    EXPECT_NEAR(plane->variance, axes.eigenvalues()[0], 2e-6);
  }
  EXPECT_GT(compared, 40);
}

TEST(PlaneMap, ALineOrAFewPointsAreNoPlane) {
  PlaneMap map({.axes = GridAxes::kParallel});
  Points line;
  for (int i = 0; i < 50; ++i) line.emplace_back(0.1F, 0.1F, 0.006F * static_cast<float>(i));
  map.insert(line);
  EXPECT_EQ(map.plane_at(line.front()), nullptr);
  const Points few{{5.15F, 5.15F, 5.0F},
                   {5.35F, 5.15F, 5.0F},
                   {5.15F, 5.35F, 5.0F},
                   {5.35F, 5.35F, 5.0F},
                   {5.25F, 5.25F, 5.0F}};
  map.insert(few);
  EXPECT_EQ(map.plane_at(few.front()), nullptr) << "five";
  map.insert(few);
  EXPECT_NE(map.plane_at(few.front()), nullptr);
}

TEST(PlaneMap, AFullCellStaysWhereItWas) {
  PlaneMap map({.max_points = 40, .axes = GridAxes::kParallel});
  const auto floor_at = [](float z) {
    Points points;
    for (int i = 0; i < 40; ++i)
      points.emplace_back(0.03F * static_cast<float>(i % 8), 0.05F * static_cast<float>(i / 8), z);
    return points;
  };
  map.insert(floor_at(0.1F));
  const MapPlane before = *map.plane_at({0.1F, 0.1F, 0.1F});
  EXPECT_NEAR(before.center.z(), 0.1F, 1e-6F);
  map.insert(floor_at(0.2F));
  EXPECT_EQ(map.plane_at({0.1F, 0.1F, 0.1F})->center, before.center);
}

TEST(PlaneMap, ForgetsWhatIsFarAndKnowsTheRest) {
  PlaneMap map({});
  Points points;
  for (const float x : {0.0F, 10.0F, 50.0F}) {
    for (const Eigen::Vector3f& p : wall(Eigen::Vector3d::UnitZ(), 0.0, 0.01, 4'000))
      points.push_back(p + Eigen::Vector3f(x, 0.0F, 0.0F));
  }
  map.insert(points);
  const std::size_t all = map.size();
  map.remove_far({10.0F, 0.0F, 0.0F}, 15.0F);
  EXPECT_LT(map.size(), all);
  const auto found = [&](std::size_t begin) {
    int planes = 0;
    for (std::size_t i = begin; i < begin + 4'000; ++i)
      planes += map.plane_at(points[i]) != nullptr;
    return planes;
  };
  EXPECT_GT(found(0), 3'200);
  EXPECT_GT(found(4'000), 3'200);
  EXPECT_EQ(found(8'000), 0);
  for (const Eigen::Vector3f& center : map.centers()) EXPECT_LT(center.x(), 26.0F);
  map.clear();
  EXPECT_TRUE(map.empty());
  EXPECT_EQ(found(0), 0);
}

TEST(PlaneMap, DoesNotDependOnHowThePointsAreDivided) {
  // Each insertion ends with fits, so only full cells have the same planes.
  const Points points = wall(kNormal, 2.0, 0.01, 60'000);
  PlaneMap whole({.max_points = 50});
  whole.insert(points);
  PlaneMap parts({.max_points = 50});
  for (std::size_t i = 0; i < points.size(); i += 1000)
    parts.insert(std::span(points).subspan(i, 1000));
  EXPECT_EQ(whole.size(), parts.size());
  int same = 0;
  int known = 0;
  for (const Eigen::Vector3f& point : points) {
    const MapPlane* a = whole.plane_at(point);
    const MapPlane* b = parts.plane_at(point);
    known += a != nullptr ? 1 : 0;
    same += a != nullptr && b != nullptr && a->center == b->center ? 1 : 0;
  }
  EXPECT_GT(same, 0.95 * known) << "the rest is in cells with fewer than 50 points";
}

TEST(PlaneMap, BadPointsAndOptionsAreRefused) {
  PlaneMap map({});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  map.insert(Points{{nan, 0.0F, 0.0F}});
  EXPECT_TRUE(map.empty());
  EXPECT_EQ(map.plane_at({nan, 0.0F, 0.0F}), nullptr);
  EXPECT_THROW(PlaneMap({.cell_size = 0.0}), InputError);
  EXPECT_THROW(PlaneMap({.max_points = 5}), InputError);
  EXPECT_THROW(PlaneMap({.min_points = 2}), InputError);
  EXPECT_THROW(PlaneMap({.min_width = 0.0}), InputError);
}

TEST(PlaneMap, KeepsTheSidesOfAWallApartIfItKnowsFromWhereTheyAreSeen) {
  const Eigen::Vector3f front = (9.0 * kNormal).cast<float>();
  const Eigen::Vector3f back = (5.0 * kNormal).cast<float>();
  const Points seen_from_front = wall(kNormal, 7.0, 0.002, 20'000);
  const Points seen_from_back = wall(kNormal, 6.9, 0.002, 20'000);
  PlaneMap map({});
  map.insert(seen_from_front, front);
  map.insert(seen_from_back, back);
  int found = 0;
  int right = 0;
  const auto expect_side = [&](const Points& points, const Eigen::Vector3f& sensor, double offset) {
    for (const Eigen::Vector3f& point : points) {
      const MapPlane* plane = map.plane_at(point, sensor);
      if (plane == nullptr) continue;
      ++found;
      right += std::abs(kNormal.dot(plane->center.cast<double>()) - offset) < 0.005 ? 1 : 0;
      EXPECT_GT(plane->normal.dot(sensor - plane->center), 0.0F) << "towards the sensor";
    }
  };
  expect_side(seen_from_front, front, 7.0);
  expect_side(seen_from_back, back, 6.9);
  EXPECT_GT(found, 30'000);
  EXPECT_GT(right, 0.9 * found)
      << "all but cells in which the first side has too few points for a plane";
}

}  // namespace
}  // namespace lidarena::map
