// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>

#include <cmath>
#include <limits>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/odometry/lio_sam/config.hpp"
#include "lidarena/odometry/lio_sam/features.hpp"
#include "lidarena/odometry/lio_sam/initialization.hpp"
#include "lidarena/odometry/lio_sam/keyframes.hpp"
#include "lidarena/odometry/lio_sam/lio_sam.hpp"
#include "lidarena/odometry/lio_sam/range_image.hpp"
#include "lidarena/odometry/lio_sam/registration.hpp"
#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry::lio_sam {
namespace {

using Eigen::Vector3d;

Vector3d random_vector(SequentialRandom& random, double sigma) {
  const double x = random.normal();
  const double y = random.normal();
  return sigma * Vector3d(x, y, random.normal());
}

LidarInfo spinning() {
  LidarInfo lidar;
  lidar.kind = "spinning";
  lidar.columns = 360;
  lidar.max_range_m = 50.0;
  return lidar;
}

// --- Range image ---

Scan scan_of(const std::vector<Point>& points) {
  Scan scan;
  scan.points = points;
  return scan;
}

Point at(float x, float y, std::uint16_t ring) {
  Point point;
  point.position = {x, y, 0.0F};
  point.ring = ring;
  return point;
}

RangeImage image_of(const Scan& scan, const Config& config) {
  std::vector<Eigen::Vector3f> positions;
  for (const Point& point : scan.points) positions.push_back(point.position);
  return project(scan, positions, config);
}

TEST(LioSamRangeImage, PutsPointsInRowsByRingAndInColumnsByAzimuthTheFirstOneStays) {
  Config config;
  config.columns = 8;  // each 45 degrees, the first from -180 to -135
  const Scan scan = scan_of({at(2, 0.1F, 1), at(-2, -0.1F, 0), at(3, 0.1F, 1), at(0.1F, 2, 1)});
  const RangeImage image = image_of(scan, config);
  ASSERT_EQ(image.row_end, (std::vector<std::size_t>{1, 3}));
  EXPECT_EQ(image.row(0)[0].column, 0);
  EXPECT_EQ(image.row(1)[0].column, 4);
  EXPECT_EQ(image.row(1)[0].range, scan.points[0].position.norm()) << "the first point of the cell";
  EXPECT_EQ(image.row(1)[1].column, 5);
}

TEST(LioSamRangeImage, ByArrivalPointsStandAsTheyCame) {
  Config config;
  config.columns_by = Columns::kArrival;
  const Scan scan = scan_of({at(5, 0, 1), at(2, 0, 0), at(0, 5, 1), at(-5, 0, 1)});
  const RangeImage image = image_of(scan, config);
  ASSERT_EQ(image.row(1).size(), 3U);
  EXPECT_EQ(image.row(1)[1].position.y(), 5.0F);
  EXPECT_EQ(image.row(1)[2].column, 2);
}

TEST(LioSamRangeImage, LeavesOutWhatIsNotUsable) {
  Config config;
  config.min_range_m = 1.0;
  config.max_range_m = 10.0;
  config.row_stride = 2;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Scan scan =
      scan_of({at(0.5F, 0, 0), at(11, 0, 0), at(nan, 1, 0), at(5, 0, 1), at(5, 0, 2)});
  const RangeImage image = image_of(scan, config);
  ASSERT_EQ(image.pixels.size(), 1U);
  EXPECT_EQ(image.row(2).size(), 1U);
}

// --- Features ---

/// A row of points with these ranges (m), one degree apart.
std::vector<Pixel> row_of(const std::vector<float>& ranges) {
  std::vector<Pixel> row;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const float angle = 0.0175F * static_cast<float>(i);
    row.push_back({ranges[i] * Eigen::Vector3f(std::cos(angle), std::sin(angle), 0.0F), ranges[i],
                   static_cast<int>(i)});
  }
  return row;
}

TEST(LioSamFeatures, RoughnessIsTheSquareOfWhatTheNeighborsRangesExceedBy) {
  Config config;
  config.smoothness_neighbors = 2;
  const auto rough = roughness(row_of({5, 5, 5, 6, 5, 5, 5, 5}), config);
  EXPECT_EQ(rough[3], 16.0F) << "4 neighbors, each 1 m nearer";
  EXPECT_EQ(rough[2], 1.0F);
  EXPECT_EQ(rough[5], 1.0F);
  EXPECT_EQ(rough[1], 0.0F) << "too near to the row's end";
}

TEST(LioSamFeatures, TheFarSideOfAJumpIsBarred) {
  Config config;
  config.occluded_points = 3;
  config.grazing_share = 0.5;
  const auto excluded = non_edge_points(row_of({8, 8, 8, 8, 8, 5, 5, 5, 9, 9, 9, 9, 9}), config);
  const std::vector<bool> expected{false, false, true, true, true,  false, false,
                                   false, true,  true, true, false, false};
  EXPECT_EQ(excluded, expected);
}

TEST(LioSamFeatures, AGrazingPointIsBarred) {
  Config config;
  config.occluded_points = 0;
  const auto excluded = non_edge_points(row_of({5.0F, 5.2F, 5.4F, 5.6F, 5.62F}), config);
  EXPECT_TRUE(excluded[1]) << "a difference of 0.2 m to both sides is 4 %";
  EXPECT_TRUE(excluded[2]);
  EXPECT_FALSE(excluded[3]) << "smooth to one side";
}

TEST(LioSamFeatures, TheCornersOfARoomAreItsEdges) {
  // a square room of 10 m seen from its middle: corners at 45, 135, ... degrees
  RangeImage image;
  for (int i = 0; i < 360; ++i) {
    const double angle = (i - 180) * std::acos(-1.0) / 180.0;
    const double range = 5.0 / std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)));
    const Eigen::Vector3f p(static_cast<float>(range * std::cos(angle)),
                            static_cast<float>(range * std::sin(angle)), 0.0F);
    image.pixels.push_back({p, static_cast<float>(range), i});
  }
  image.row_end = {360};
  Config config;
  config.edge_threshold_m2 = 1.0;  // 5 degrees beside a corner the range is 8 % less
  const Features features = extract_features(image, config, Parallel(1));
  EXPECT_EQ(features.edges.size() + features.surfaces.size(), 360U);
  ASSERT_GE(features.edges.size(), 4U);
  for (const Eigen::Vector3f& edge : features.edges) {
    EXPECT_GT(std::min(std::abs(edge.x()), std::abs(edge.y())), 4.0F)
        << "within 6 degrees of a corner";
  }
}

// --- Registration ---

TEST(LioSamRegistration, JacobiansAreTheNumericOnes) {
  SequentialRandom random(1, 1);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose pose = make_pose(so3::exp(random_vector(random, 1.0)), random_vector(random, 3.0));
    const Vector3d point = random_vector(random, 3.0);
    const Vector3d seen = pose * point;
    const Line line{seen + random_vector(random, 0.2), random_vector(random, 1.0).normalized()};
    const Vector3d normal = random_vector(random, 1.0).normalized();
    const estimation::Plane plane{normal, -normal.dot(seen) + 0.1 * random.normal()};
    const auto moved = [&](Eigen::Index k, double h) {
      const Eigen::Matrix<double, 6, 1> step = h * Eigen::Matrix<double, 6, 1>::Unit(k);
      Pose p = pose;
      p.linear() = so3::exp(step.head<3>()) * pose.linear();
      p.translation() += step.tail<3>();
      return p;
    };
    const auto check = [&](const auto& residual_at) {
      const std::optional<PointResidual> here = residual_at(pose);
      if (!here) return;
      // the Jacobian takes the weight as constant, so distances without the weight are compared
      const auto unweighted = [](const PointResidual& r) {
        return r.distance / r.row.tail(3).norm();
      };
      const double weight = here->row.tail<3>().norm();
      for (Eigen::Index k = 0; k < 6; ++k) {
        const double slope =
            (unweighted(*residual_at(moved(k, 1e-6))) - unweighted(*residual_at(moved(k, -1e-6)))) /
            2e-6;
        EXPECT_NEAR(here->row[k] / weight, slope, 1e-6) << k;
      }
    };
    check([&](const Pose& p) { return edge_residual(point, line, p); });
    check([&](const Pose& p) { return surface_residual(point, plane, p); });
  }
}

Neighbors five(const std::vector<Vector3d>& points) {
  Neighbors neighbors;
  for (std::size_t i = 0; i < kNeighbors; ++i) neighbors[i].point = points[i].cast<float>();
  return neighbors;
}

TEST(LioSamRegistration, LinesAndPlanesAreFoundWhereThereAreSome) {
  const auto line = fit_line(five({{0, 0, 0}, {1, 0.01, 0}, {2, 0, 0.01}, {3, 0, 0}, {4, 0, 0}}));
  ASSERT_TRUE(line.has_value());
  EXPECT_NEAR(std::abs(line->direction.x()), 1.0, 1e-4);
  EXPECT_FALSE(fit_line(five({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5, 0.5, 0}})));

  const std::vector<Vector3d> wall{{2, 0, 0}, {2, 1, 0}, {2, 0, 1}, {2, 1, 1}, {2.01, 0.5, 0.5}};
  for (const estimation::PlaneFit fit :
       {estimation::PlaneFit::kPrincipal, estimation::PlaneFit::kUnitOffset}) {
    const auto plane = estimation::fit_plane(map::columns_of(five(wall)), fit, 0.2);
    ASSERT_TRUE(plane.has_value());
    EXPECT_NEAR(std::abs(plane->normal.x()), 1.0, 1e-2);
    EXPECT_NEAR(std::abs(plane->offset), 2.0, 2e-2);
  }
  EXPECT_FALSE(estimation::fit_plane(
      map::columns_of(five({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}})),
      estimation::PlaneFit::kPrincipal, 0.2, 0.05));
  EXPECT_FALSE(estimation::fit_plane(
      map::columns_of(five({{0, 0, 0}, {1, 0, 0}, {2, 0.1, 0}, {3, 0, 0.01}, {4, 0, 0}})),
      estimation::PlaneFit::kPrincipal, 0.2, 0.05))
      << "points on a line, as from a single sweep";
}

/// Surface points of a room's walls; bit 0 of `open` leaves out those perpendicular to x, bit 1
/// those to y, bit 2 those to z.
FeatureMap walls(int open) {
  std::vector<Eigen::Vector3f> points;
  for (int axis = 0; axis < 3; ++axis) {
    if ((open >> axis & 1) != 0) continue;
    for (int i = -25; i <= 25; ++i) {
      for (int k = -25; k <= 25; ++k) {
        for (const float side : {-4.0F, 4.0F}) {
          Eigen::Vector3f p;
          p[axis] = side;
          p[(axis + 1) % 3] = 0.16F * static_cast<float>(i);
          p[(axis + 2) % 3] = 0.16F * static_cast<float>(k);
          points.push_back(p);
        }
      }
    }
  }
  FeatureMap map;
  map.surfaces.build(points);
  return map;
}

Features seen(const FeatureMap& map, const Pose& pose) {
  Features features;
  std::vector<Eigen::Vector3f> points = map.surfaces.points();
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });  // so that the result does not depend on the tree's order
  for (std::size_t i = 0; i < points.size(); i += 7)
    features.surfaces.push_back((pose.inverse() * points[i].cast<double>()).cast<float>());
  return features;
}

TEST(LioSamRegistration, FindsTheWayHomeWithEitherPreset) {
  const FeatureMap map = walls(0);
  const Pose truth = make_pose(so3::exp({0.1, -0.2, 0.5}), {0.3, 0.2, -0.4});
  const Features features = seen(map, truth);
  const Pose guess = truth * make_pose(so3::exp({0.02, 0.03, -0.03}), {0.1, -0.08, 0.1});
  for (const char* name : {"original", "improved"}) {
    Config config = (std::string(name) == "improved" ? indoor(spinning()) : published(spinning()));
    const Registration found = register_features(features, map, guess, config, Parallel(1));
    EXPECT_TRUE(found.converged) << name;
    EXPECT_EQ(found.degenerate_directions, 0) << name;
    EXPECT_LT((found.map_from_lidar.translation() - truth.translation()).norm(), 1e-3) << name;
    EXPECT_LT(so3::angle(truth.linear().transpose() * found.map_from_lidar.linear()), 1e-3);
  }
}

TEST(LioSamRegistration, InATunnelTheWayAlongIsLeftToTheGuess) {
  const FeatureMap map = walls(1);
  const Pose truth = make_pose(so3::exp({0.1, 0.0, 0.3}), {0.0, 0.2, -0.4});
  const Features features = seen(map, truth);
  const Pose guess = truth * make_pose(so3::exp({0.02, 0.0, -0.02}), {0.1, -0.08, 0.1});
  for (const char* name : {"original", "improved"}) {
    const Registration found = register_features(
        features, map, guess,
        (std::string(name) == "improved" ? indoor(spinning()) : published(spinning())),
        Parallel(1));
    EXPECT_EQ(found.degenerate_directions, 1) << name;
    EXPECT_NEAR(found.map_from_lidar.translation().x(), guess.translation().x(), 5e-3) << name;
    EXPECT_LT((found.map_from_lidar.translation() - truth.translation()).tail<2>().norm(), 2e-3);
  }
}

TEST(LioSamRegistration, DegeneracyByShareDoesNotDependOnHowManyPointsThereAre) {
  PoseEquations few;
  const auto add = [&](const Vector3d& normal, const Vector3d& arm) {
    Eigen::Matrix<double, 1, 6> row;
    row << arm.cross(normal).transpose(), normal.transpose();
    few.add<1>(row, Eigen::Matrix<double, 1, 1>(0.0), 1.0);
  };
  for (const double s : {-3.0, 3.0}) {
    add(Vector3d::UnitX(), {s, 1, 1});
    add(Vector3d::UnitX(), {s, -1, 2});
    add(Vector3d::UnitY(), {1, s, -1});
    add(Vector3d::UnitY(), {-1, s, 2});
    add(Vector3d::UnitZ(), {2, 1, s});
    add(Vector3d::UnitZ(), {-2, 2, s});
  }
  EXPECT_EQ(find_degenerate(few, 3.0, Degeneracy::kShare).directions, 0);
  EXPECT_GT(find_degenerate(few, 3.0, Degeneracy::kEigenvalue).directions, 0)
      << "12 points never reach 100, a fault that `share` does not have";
}

// --- Start, keyframes ---

std::vector<ImuSample> resting(const Vector3d& force, const Vector3d& rate) {
  std::vector<ImuSample> samples;
  for (int i = 0; i < 20; ++i) samples.push_back({from_seconds(0.005 * i), rate, force});
  return samples;
}

TEST(LioSamStart, FeelsHowTheBodyLeansAndHowTheImuIsMounted) {
  const Config config = indoor(spinning());
  const Eigen::Matrix3d lean = so3::exp({0.0, 0.2, 0.0}) * so3::exp({0.1, 0.0, 0.0});
  const Pose body_from_imu = make_pose(so3::exp({0.5, -0.3, 1.0}), {0.1, 0.0, 0.0});
  const Vector3d force = (lean * body_from_imu.linear()).transpose() * Vector3d(0, 0, 9.81);
  const Start start = start_from(resting(force, {0.01, 0.0, -0.01}), body_from_imu, config);
  EXPECT_TRUE(start.still);
  const Pose world_from_body = start.inertial.state.world_from_imu * body_from_imu.inverse();
  EXPECT_LT((world_from_body.linear() - lean).norm(), 1e-9) << "no yaw";
  EXPECT_LT(world_from_body.translation().norm(), 1e-12);
  EXPECT_LT((start.inertial.state.bias.gyro - Vector3d(0.01, 0.0, -0.01)).norm(), 1e-12);
  EXPECT_EQ(start.accel_scale, 1.0);
}

TEST(LioSamStart, WhatTheForceAtRestIsTooLongByIsTheAccelerometersBias) {
  const Config config = indoor(spinning());
  const Vector3d up = Vector3d(0.1, -0.05, 1.0).normalized();
  const Start start =
      start_from(resting((config.gravity + 0.07) * up, Vector3d::Zero()), Pose::Identity(), config);
  EXPECT_LT((start.inertial.state.bias.accel - 0.07 * up).norm(), 1e-12);
}

TEST(LioSamStart, TheProgramTakesTheBodyToBeLevel) {
  const Start start = start_from(resting({1.0, 0.0, 9.7}, Vector3d::Zero()), Pose::Identity(),
                                 published(spinning()));
  EXPECT_TRUE(start.inertial.state.world_from_imu.matrix().isIdentity());
}

TEST(LioSamStart, AccelerationsInUnitsOfGAreScaled) {
  const Config config = indoor(spinning());
  const Start start =
      start_from(resting({0.0, 0.0, 1.0}, Vector3d::Zero()), Pose::Identity(), config);
  EXPECT_EQ(start.accel_scale, config.gravity);
  EXPECT_TRUE(start.still);
}

TEST(LioSamKeyframes, ComeWithDistanceTurnAndInTheProgramsLivoxModeWithTime) {
  Config config;
  const Keyframe last{from_seconds(10.0), Pose::Identity(), {}, 0};
  const auto moved = [](double x, double yaw) {
    return make_pose(so3::exp({0, 0, yaw}), {x, 0, 0});
  };
  EXPECT_FALSE(is_keyframe(last, from_seconds(100.0), moved(0.99, 0.19), config));
  EXPECT_TRUE(is_keyframe(last, from_seconds(11.0), moved(1.0, 0.0), config));
  EXPECT_TRUE(is_keyframe(last, from_seconds(11.0), moved(0.0, -0.2), config));
  config.keyframe_interval_s = 1.0;
  EXPECT_FALSE(is_keyframe(last, from_seconds(11.0), moved(0.0, 0.0), config));
  EXPECT_TRUE(is_keyframe(last, from_seconds(11.1), moved(0.0, 0.0), config));
}

TEST(LioSamKeyframes, TheSubmapTakesTheNearTheOldestOfEachCellAndTheRecent) {
  Config config;
  config.submap_radius_m = 5.0;
  config.submap_keyframe_spacing_m = 2.0;
  config.submap_recent_s = 10.0;
  std::vector<Keyframe> keyframes;
  const std::vector<std::pair<double, double>> time_and_x{{0, 0.5},  {20, 1.5}, {40, 2.5},
                                                          {60, 9.0}, {95, 3.0}, {96, 3.5}};
  for (const auto& [t, x] : time_and_x)
    keyframes.push_back(
        {from_seconds(t), make_pose(Eigen::Matrix3d::Identity(), {x, 0, 0}), {}, 0});
  EXPECT_EQ(surrounding(keyframes, {3.5, 0, 0}, from_seconds(100.0), config),
            (std::vector<std::uint32_t>{0, 2, 4, 5}));
}

TEST(LioSamKeyframes, TheSubmapFollowsAsIfMadeAnew) {
  const Config config;
  SequentialRandom random(4);
  const auto seen = [&] {
    Features features;
    for (int i = 0; i < 400; ++i) {
      const auto coordinate = [&] { return static_cast<float>(random.uniform(-3.0, 3.0)); };
      const float x = coordinate(), y = coordinate(), z = coordinate();
      (i < 40 ? features.edges : features.surfaces).emplace_back(x, y, z);
    }
    return features;
  };
  std::vector<Keyframe> keyframes;
  for (int i = 0; i < 8; ++i) {
    const Pose pose = make_pose(so3::exp({0.0, 0.1 * i, 0.3 * i}), {0.5 * i, 0.1, -0.2});
    keyframes.push_back({from_seconds(i), pose, seen(), 0});
  }
  const auto sorted = [](std::vector<Eigen::Vector3f> points) {
    std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
      return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    });
    return points;
  };
  Submap follows(config);
  const auto expect_as_anew = [&](const std::vector<std::uint32_t>& chosen) {
    follows.select(keyframes, chosen);
    Submap anew(config);
    anew.select(keyframes, chosen);
    EXPECT_EQ(sorted(follows.map().edges.points()), sorted(anew.map().edges.points()));
    EXPECT_EQ(sorted(follows.map().surfaces.points()), sorted(anew.map().surfaces.points()));
  };
  expect_as_anew({0, 1, 2, 3});
  expect_as_anew({1, 3, 4, 7});
  keyframes[3].features = seen();  // new features
  ++keyframes[3].revision;
  expect_as_anew({1, 3, 4, 7});
  for (Keyframe& keyframe : keyframes) {  // moved by a loop
    keyframe.world_from_lidar.translation().x() += 0.37;
    ++keyframe.revision;
  }
  expect_as_anew({1, 3, 4, 7});
  expect_as_anew({0, 1, 2, 3, 4, 5, 6, 7});
  expect_as_anew({});
}

// --- Whole ---

TEST(LioSam, StandingStillNothingGrowsUnlessTheProgramsLivoxModeIsAskedFor) {
  const synthetic::Recording still{.motion = [](double) { return synthetic::flight(0.0); }};
  const auto events = synthetic::record(still);
  const auto keyframes_after = [&](const char* name, double age) {
    const Rig rig = synthetic::rig_of(still);
    Config config =
        (std::string(name) == "improved" ? indoor(rig.lidars[0]) : published(rig.lidars[0]));
    config.keyframe_interval_s = age;
    LioSam odometry(config, rig.lidars[0], rig.imus[0], Parallel(1));
    double keyframes = 0.0;
    for (const dataset::Event& event : events) {
      if (const auto* scan = std::get_if<Scan>(&event.data)) {
        keyframes = odometry.register_scan(*scan).counters.keyframes.value();
      } else {
        odometry.register_imu(std::get<ImuSample>(event.data));
      }
    }
    return keyframes;
  };
  EXPECT_EQ(keyframes_after("improved", 0.0), 1.0);
  EXPECT_GE(keyframes_after("original", 1.0), 3.0);
}

/// Root of the mean square error (m) of the motion from each scan to the next.
double step_error(const synthetic::Recording& recording, const Config& config) {
  const Rig rig = synthetic::rig_of(recording);
  LioSam odometry(config, rig.lidars[0], rig.imus[0], Parallel(1));
  std::vector<StampedPose> poses;
  for (const dataset::Event& event : synthetic::record(recording)) {
    if (const auto* scan = std::get_if<Scan>(&event.data)) {
      poses.push_back(odometry.register_scan(*scan).estimate);
    } else {
      odometry.register_imu(std::get<ImuSample>(event.data));
    }
  }
  double sum = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Pose step = poses[i - 1].world_from_body.inverse() * poses[i].world_from_body;
    const Pose truth = synthetic::truth(recording, poses[i - 1].stamp, poses[i].stamp);
    sum += (step.translation() - truth.translation()).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(poses.size() - 1));
}

TEST(LioSam, PointsAndImuTogetherAreSmootherThanPointsAlone) {
  synthetic::Recording sparse{.range_noise_m = 0.03, .points_per_scan = 2048, .repeating = false};
  sparse.gyro_noise_density = 2.4e-4;
  sparse.accel_noise_density = 1.7e-3;
  Config config = indoor(synthetic::rig_of(sparse).lidars[0]);
  ASSERT_TRUE(config.smoothed_pose);
  const double together = step_error(sparse, config);
  config.smoothed_pose = false;
  const double alone = step_error(sparse, config);
  EXPECT_LT(together, 0.5 * alone) << together << " m and " << alone << " m";
}

TEST(LioSam, WithoutImuEveryScanSaysSo) {
  const Rig rig = synthetic::rig_of({});
  LioSam odometry(indoor(rig.lidars[0]), rig.lidars[0], rig.imus[0], Parallel(1));
  for (const Scan& scan : synthetic::scans_of({.seconds = 0.3})) {
    EXPECT_EQ(odometry.register_scan(scan).status, ScanStatus::kInitializing);
  }
  EXPECT_TRUE(odometry.map().empty());
}

}  // namespace
}  // namespace lidarena::odometry::lio_sam
