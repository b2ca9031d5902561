// SPDX-License-Identifier: BSD-3-Clause
// Tests of the single steps of CT-ICP.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "lidarena/base/so3.hpp"
#include "lidarena/odometry/ct_icp/ct_icp.hpp"
#include "lidarena/odometry/ct_icp/neighborhood.hpp"
#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry::ct_icp {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Pose turned(double yaw, const Eigen::Vector3d& position = Eigen::Vector3d::Zero()) {
  return make_pose(so3::exp({0.0, 0.0, yaw}), position);
}

estimation::ElasticMotion motion_of(const Pose& begin, const Pose& end) { return {{begin, end}}; }

Scan scan_of(std::vector<Point> points, bool timed = true) {
  return {Time{1'000'000'000}, std::move(points), timed};
}

TEST(CtIcpSampling, AlphaRunsFromTheEarliestPointToTheLatestAndBadPointsAreDropped) {
  const Scan scan = scan_of({{{1, 0, 0}, 0, 500},
                             {{2, 0, 0}, 0, 100},
                             {{3, 0, 0}, 0, 200},
                             {{kNan, 0, 0}, 0, 300},
                             {{0.1F, 0, 0}, 0, 300},
                             {{60, 0, 0}, 0, 300}});
  const estimation::ScanTimes times = estimation::times_of(scan, Time{77});
  EXPECT_EQ(times.first - scan.stamp, Time{100});
  EXPECT_EQ(times.last - scan.stamp, Time{500});
  EXPECT_TRUE(times.timed);
  SamplingConfig config;
  config.min_range_m = 0.5;
  config.max_range_m = 50.0;
  const auto points = timed_points(scan, times, false, config);
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points[0].alpha, 1.0F);
  EXPECT_EQ(points[1].alpha, 0.0F);
  EXPECT_EQ(points[2].alpha, 0.25F);
  for (const TimedPoint& point : timed_points(scan, times, true, config))
    EXPECT_EQ(point.alpha, 1.0F) << "rigid";
}

TEST(CtIcpSampling, AnEmptyScanLastsAsUsualAndOneWithoutTimesIsNotTimed) {
  const estimation::ScanTimes empty = estimation::times_of(scan_of({}), Time{77});
  EXPECT_EQ(empty.last - empty.first, Time{77});
  EXPECT_FALSE(empty.timed);
  EXPECT_FALSE(
      estimation::times_of(scan_of({{{1, 0, 0}, 0, 0}, {{2, 0, 0}, 0, 0}}), Time{77}).timed);
  EXPECT_FALSE(
      estimation::times_of(scan_of({{{1, 0, 0}, 0, 0}, {{2, 0, 0}, 0, 9}}, false), Time{77}).timed);
}

TEST(CtIcpSampling, ThinningKeepsOnePointOfEachCellFromAllOverTheScan) {
  std::vector<TimedPoint> points;
  for (int i = 0; i < 1000; ++i) {
    for (int cell = 0; cell < 20; ++cell)
      points.push_back(
          {{static_cast<float>(cell) + 0.5F, 0.5F, 0.5F}, 0.001F * static_cast<float>(i)});
  }
  const auto kept = thin(points, 1.0, map::VoxelRounding::kFloor);
  std::set<float> cells;
  double mean = 0.0;
  for (const TimedPoint& point : kept) {
    cells.insert(point.position.x());
    mean += point.alpha / 20.0;
  }
  EXPECT_EQ(kept.size(), 20U);
  EXPECT_EQ(cells.size(), 20U);
  // drawn uniformly from [0, 1): four standard deviations of the mean of 20
  EXPECT_NEAR(mean, 0.5, 4.0 / std::sqrt(12.0 * 20.0));
}

TEST(CtIcpSampling, TruncatedCellsAboutZeroAreTwiceAsWide) {
  const std::vector<TimedPoint> points{
      {{-0.9F, 0.1F, 0.1F}, 0}, {{0.9F, 0.1F, 0.1F}, 0}, {{1.1F, 0.1F, 0.1F}, 0}};
  EXPECT_EQ(thin(points, 1.0, map::VoxelRounding::kFloor).size(), 3U);
  EXPECT_EQ(thin(points, 1.0, map::VoxelRounding::kTruncate).size(), 2U);
}

TEST(CtIcpSampling, AdaptiveCellsGrowWithTheRangeAndTheLimitHolds) {
  std::vector<TimedPoint> points;
  for (const float range : {0.3F, 1.5F, 3.0F, 6.0F, 12.0F, 100.0F, 300.0F}) {
    // 32 cm along z in steps of 1 cm, away from the cells' faces
    for (int i = 0; i < 32; ++i)
      points.push_back({{range, 0.05F, 1.605F + 0.01F * static_cast<float>(i)}, 0.0F});
  }
  for (auto& point : points) point.position.z() -= point.position.x() < 2.0F ? 1.6F : 0.0F;
  const auto all =
      sample_keypoints(points, KeypointSampling::kAdaptive, 1.0, 0, map::VoxelRounding::kFloor);
  std::map<float, int> counts;
  for (const TimedPoint& point : all) ++counts[point.position.x()];
  EXPECT_EQ(counts.count(0.3F), 0U) << "nearer than 0.5 m";
  EXPECT_EQ(counts.count(300.0F), 0U) << "farther than 200 m";
  EXPECT_EQ(counts[1.5F], 4) << "cells of 0.1 m";
  EXPECT_EQ(counts[3.0F], 2) << "cells of 0.2 m";
  EXPECT_EQ(counts[6.0F], 1) << "cells of 0.4 m";
  EXPECT_EQ(counts[12.0F], 1) << "cells of 0.8 m";
  EXPECT_EQ(counts[100.0F], 1) << "cells of 1.6 m";
  EXPECT_EQ(
      sample_keypoints(points, KeypointSampling::kAdaptive, 1.0, 5, map::VoxelRounding::kFloor)
          .size(),
      5U);
}

/// Points in the plane z = 2, with twice the spread along x as along y.
std::vector<Eigen::Vector3f> plane_points() {
  std::vector<Eigen::Vector3f> points;
  for (int i = -2; i <= 2; ++i) {
    for (int j = -2; j <= 2; ++j)
      points.emplace_back(0.2F * static_cast<float>(i), 0.1F * static_cast<float>(j), 2.0F);
  }
  return points;
}

std::vector<map::Neighbor> neighbors_of(const std::vector<Eigen::Vector3f>& points,
                                        const Eigen::Vector3f& query) {
  std::vector<map::Neighbor> all;
  for (const auto& point : points) all.push_back({point, (point - query).squaredNorm()});
  return all;
}

TEST(CtIcpNeighborhood, OfAPlaneKnowsItsNormalItsPlanarityAndItsPoint) {
  const auto points = plane_points();
  const auto neighbors = neighbors_of(points, {0.0F, 0.01F, 2.1F});
  const Neighborhood mean = describe(neighbors, PlanePoint::kMean);
  EXPECT_NEAR(std::abs(mean.normal.z()), 1.0, 1e-6);
  EXPECT_NEAR(std::abs(mean.line.x()), 1.0, 1e-6);
  EXPECT_NEAR(mean.planarity, 0.5, 1e-3) << "deviations 2 : 1 : 0";
  EXPECT_NEAR(mean.linearity, 0.5, 1e-3);
  EXPECT_LT((mean.anchor - Eigen::Vector3d(0, 0, 2)).norm(), 1e-6);
  const Neighborhood nearest = describe(neighbors, PlanePoint::kNearest);
  EXPECT_LT((nearest.anchor - Eigen::Vector3d(0, 0, 2)).norm(), 1e-6);
  const Neighborhood farthest = describe(neighbors, PlanePoint::kFarthest);
  EXPECT_NEAR(std::abs(farthest.anchor.x()), 0.4, 1e-6);
  EXPECT_NEAR(farthest.anchor.y(), -0.2, 1e-6);
}

TEST(CtIcpNeighborhood, OfOnePointManyTimesHasNoShapeAndNoNan) {
  const std::vector<Eigen::Vector3f> same(10, Eigen::Vector3f(1, 2, 3));
  const Neighborhood found = describe(neighbors_of(same, {1, 2, 3}), PlanePoint::kMean);
  EXPECT_EQ(found.planarity, 0.0);
  EXPECT_EQ(found.linearity, 0.0);
  EXPECT_TRUE(found.normal.allFinite());
}

TEST(CtIcpNeighborhood, WeighsAPlaneAsThePublicProgramDoes) {
  Neighborhood near{{0, 0, 2}, {0, 0, 1}, {1, 0, 0}, {0, 1, 4}, 0.5, 0.5};
  RegistrationConfig config;
  config.min_neighbors = 20;
  const estimation::ElasticMatch match = plane_match(near, {0, 0, 2.3}, config);
  EXPECT_NEAR(match.weight, 0.9 * 0.25 + 0.1 * std::exp(-0.3 / (0.3 * 20)), 1e-12);
  EXPECT_EQ(match.rows, 1);
}

TEST(CtIcpNeighborhood, IsALineAPlaneOrADistribution) {
  const Eigen::Vector3d gap(0.3, 0.2, 0.1);
  const Neighborhood plane{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 1}, 0.9, 0.0};
  EXPECT_EQ(shape_match(plane).rows, 1);
  const Neighborhood line{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 0, 1}, 0.0, 0.9};
  EXPECT_EQ(shape_match(line).rows, 3);
  EXPECT_NEAR((shape_match(line).shape * gap).norm(), std::hypot(0.2, 0.1), 1e-12);
  EXPECT_NEAR(shape_match(line).weight, 0.81, 1e-12);
  // deviations 0.1, 0.2, 0.4 along z, y, x: distances are scaled by the smallest
  const Neighborhood cloud{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0.01, 0.04, 0.16}, 0.25, 0.5};
  const estimation::ElasticMatch match = shape_match(cloud);
  EXPECT_NEAR((match.shape * gap).squaredNorm(), 0.01 * (0.09 / 0.16 + 0.04 / 0.04 + 0.01 / 0.01),
              1e-12);
  EXPECT_EQ(match.weight, 0.1);
}

TEST(CtIcpPrediction, EachWayGoesOnFromTheMotionSoFar) {
  const Pose step = turned(0.1, {1.0, 0.0, 0.0});
  MotionHistory history;
  estimation::ScanTimes times{Time{0}, Time{100'000'000}, true};
  const auto next = [&] {
    times.first += Time{100'000'000};
    times.last += Time{100'000'000};
  };
  RegistrationConfig config;
  EXPECT_EQ(history.predict(times, config).end().matrix(), Pose::Identity().matrix());
  Pose end = Pose::Identity();
  for (int i = 0; i < 3; ++i) {
    history.add(motion_of(end, end * step), times, false, 1.0);
    end = end * step;
    next();
  }
  config.initial_motion = InitialMotion::kLastPose;
  EXPECT_LT((history.predict(times, config).begin().matrix() - end.matrix()).norm(), 1e-12);
  EXPECT_LT((history.predict(times, config).end().matrix() - end.matrix()).norm(), 1e-12);
  for (const auto way : {InitialMotion::kConstantMotion, InitialMotion::kConstantTwist}) {
    config.initial_motion = way;
    const estimation::ElasticMotion motion = history.predict(times, config);
    EXPECT_LT((motion.begin().matrix() - end.matrix()).norm(), 1e-12);
    EXPECT_LT((motion.end().matrix() - (end * step).matrix()).norm(), 1e-12);
  }
  next();  // a scan was dropped: by real time the end is two steps away
  config.segments = 2;
  const estimation::ElasticMotion motion = history.predict(times, config);
  EXPECT_LT((motion.begin().matrix() - (end * step).matrix()).norm(), 1e-12);
  EXPECT_LT((motion.end().matrix() - (end * step * step).matrix()).norm(), 1e-12);
  const estimation::MotionPrior prior = history.prior(motion, config, PriorConfig{});
  EXPECT_LT((prior.turn - Eigen::Vector3d(0, 0, 0.1)).norm(), 1e-12);
  EXPECT_EQ(prior.location, 0.001);
}

Registration registration_of(double yaw, double meters, std::size_t matches) {
  Registration registration{motion_of(Pose::Identity(), turned(yaw, {meters, 0, 0}))};
  registration.keypoints = 100;
  registration.matches = matches;
  return registration;
}

TEST(CtIcpRobust, VerdictsFollowMotionAndMatches) {
  const estimation::ElasticMotion guess = estimation::ElasticMotion::still(Pose::Identity(), 1);
  RobustConfig config;  // trusted up to 3 deg, lost beyond 30 deg or 5 m
  config.min_matched_share = 0.5;
  const auto verdict = [&](const Registration& r) { return verdict_on(r, guess, config); };
  EXPECT_EQ(verdict(registration_of(0.05, 1.0, 60)), Verdict::kTrusted);
  EXPECT_EQ(verdict(registration_of(0.06, 1.0, 60)), Verdict::kSuspect);
  EXPECT_EQ(verdict(registration_of(0.05, 1.0, 40)), Verdict::kSuspect);
  EXPECT_EQ(verdict(registration_of(0.6, 1.0, 60)), Verdict::kLost);
  EXPECT_EQ(verdict(registration_of(0.0, 5.5, 60)), Verdict::kLost);
  EXPECT_EQ(verdict(registration_of(0.0, std::nan(""), 60)), Verdict::kLost);
  Registration few = registration_of(0.0, 0.0, 5);
  few.enough = false;
  EXPECT_EQ(verdict(few), Verdict::kLost);
}

TEST(CtIcpRobust, EachLevelIsFinerLongerAndWider) {
  const Config config;
  const Config second = at_level(config, 2);
  EXPECT_DOUBLE_EQ(second.sampling.keypoint_voxel_size_m, 0.6 / 2.25);
  EXPECT_EQ(second.sampling.max_keypoints, 3200);
  EXPECT_EQ(second.registration.max_iterations, 48);
  EXPECT_EQ(second.registration.inner_iterations, 80);
  EXPECT_NEAR(second.registration.robust_kernel_scale_m, 0.144, 1e-12);
  EXPECT_NEAR(second.registration.max_plane_distance_m, 0.675, 1e-12);
  EXPECT_NEAR(second.registration.convergence_translation_m, 1e-4, 1e-12);
}

TEST(CtIcpInsertion, ScansThatTurnAreKeptOutUntilSixWere) {
  InsertionGate gate{InsertionConfig{}};
  const estimation::ElasticMotion slow = motion_of(Pose::Identity(), turned(0.05));
  const estimation::ElasticMotion fast = motion_of(Pose::Identity(), turned(0.06));
  EXPECT_TRUE(gate.admits(slow, Verdict::kSuspect));
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < 6; ++i) EXPECT_FALSE(gate.admits(fast, Verdict::kTrusted));
    EXPECT_TRUE(gate.admits(fast, Verdict::kTrusted)) << "more than five in a row";
  }
  InsertionConfig trusted;
  trusted.rule = Insertion::kTrusted;
  InsertionGate other(trusted);
  EXPECT_TRUE(other.admits(fast, Verdict::kTrusted));
  EXPECT_FALSE(other.admits(slow, Verdict::kSuspect));
}

TEST(CtIcp, SuspectScansAreTriedAgainAtHigherLevels) {
  const synthetic::Recording recording{.seconds = 2.5};
  Config config = indoor(synthetic::rig_of(recording).lidars[0]);
  config.robust.enabled = true;
  config.robust.max_attempts = 3;
  config.robust.max_rotation_rad = 0.01;  // suspect from 6 deg/s on
  CtIcp odometry(config, synthetic::rig_of(recording).lidars[0], Parallel(1));
  double highest = 0.0;
  for (const Scan& scan : synthetic::scans_of(recording))
    highest = std::max(highest, odometry.register_scan(scan).counters.retry_level.value());
  EXPECT_EQ(highest, 3.0) << "after an untrusted scan: level 1 and two more attempts";
}

TEST(CtIcp, AScanWithoutTimesIsRigidAndHasNoMotionWithin) {
  const synthetic::Recording recording{.motion = [](double) { return synthetic::flight(0.0); },
                                       .seconds = 0.5};
  const LidarInfo lidar = synthetic::rig_of(recording).lidars[0];
  for (const char* name : {"improved", "original"}) {
    CtIcp odometry((std::string(name) == "improved" ? indoor(lidar) : published(lidar)), lidar,
                   Parallel(1));
    for (Scan scan : synthetic::scans_of(recording)) {
      scan.timed = false;
      for (Point& point : scan.points) point.dt_ns = 0;
      const ScanResult result = odometry.register_scan(scan);
      EXPECT_NE(result.status, ScanStatus::kDiverged);
      EXPECT_TRUE(result.motion.empty());
      EXPECT_LT(result.estimate.world_from_body.translation().norm(), 0.02) << "at rest";
    }
  }
}

TEST(CtIcp, AFloorAloneIsDegenerate) {
  const LidarInfo lidar = synthetic::rig_of({}).lidars[0];
  CtIcp odometry(indoor(lidar), lidar, Parallel(1));
  std::vector<Point> points;
  for (int i = 0; i < 4000; ++i) {
    const double radius = 1.0 + 0.002 * i;
    points.push_back({{static_cast<float>(radius * std::cos(2.4 * i)),
                       static_cast<float>(radius * std::sin(2.4 * i)), -1.5F},
                      0,
                      i * 20'000});
  }
  ScanResult result;
  for (int k = 0; k < 3; ++k)
    result = odometry.register_scan({Time{1'000'000'000 + k * 100'000'000LL}, points, true});
  EXPECT_EQ(result.status, ScanStatus::kDegenerate);
}

}  // namespace
}  // namespace lidarena::odometry::ct_icp
