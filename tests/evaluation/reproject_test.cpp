// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/reproject.hpp"
#include "tests/listed_sources.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <limits>

#include "flights.hpp"

namespace lidarena::evaluation {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;
using flights::sample;
using flights::tour;
using listed::Events;

const Pose kBodyFromLidar = make_pose(so3::exp({0.3, -0.2, 1.1}), Vector3d(0.1, -0.05, 0.2));

/// Returns of a LiDAR moving along `truth` from the wall x = 7 m: scans at 10 Hz, 500 returns each,
/// spread over the scan.
Events scans_of_a_wall(const Trajectory& truth) {
  SequentialRandom random(31);
  Events source;
  for (Time stamp = truth.begin_time(); stamp + 100ms <= truth.end_time(); stamp += 100ms) {
    Scan scan{stamp, {}, true};
    for (int i = 0; i < 500; ++i) {
      const auto dt = static_cast<std::int32_t>(i * 200'000);
      const Vector3d hit(7.0, random.uniform(-8, 8), random.uniform(0, 4));
      const Pose lidar_from_world = (*truth.at(stamp + Time{dt}) * kBodyFromLidar).inverse();
      scan.points.push_back({(lidar_from_world * hit).cast<float>(), 7.0F, dt, 0, 0});
    }
    source.events.push_back({"front", std::move(scan)});
  }
  return source;
}

TEST(Reproject, EveryReturnLandsOnTheWallItCameFromThoughTheBodyTurnsWithinTheScan) {
  const Trajectory truth = sample(tour, 100ms, 10s);  // its interpolation is the true motion
  Events source = scans_of_a_wall(truth);
  ReprojectionCounts counts;
  const dataset::Cloud cloud = reprojected(source, "front", kBodyFromLidar, truth, &counts);
  EXPECT_EQ(counts.returns, 100U * 500U);
  EXPECT_EQ(counts.without_pose, 0U);
  EXPECT_GT(cloud.points.size(), 30000U);  // 16 x 4 m have 160 000 voxels
  EXPECT_EQ(cloud.intensity.size(), cloud.points.size());
  for (const Eigen::Vector3f& p : cloud.points) ASSERT_NEAR(p.x(), 7.0F, 1e-5F);
}

TEST(Reproject, TheMotionWithinScansIsUsedWithTheGapsOfTheTrajectory) {
  const Trajectory fine = sample(tour, 5ms, 10s);
  const Trajectory truth = sample(tour, 100ms, 10s);
  dataset::RunFiles run;
  run.trajectory = flights::with_gap(truth, 4s, 5s);
  run.motion = flights::with_gap(fine, 4s, 5s);
  for (int i = 0; i < 2; ++i) {
    Events source = scans_of_a_wall(fine);
    ReprojectionCounts counts;
    const dataset::Cloud cloud =
        reprojected(source, "front", kBodyFromLidar, BodyMotion(run), &counts);
    EXPECT_EQ(counts.without_pose, 5000U - 1U) << "a second without poses, but for the one at 4 s";
    double worst = 0.0;
    for (const Eigen::Vector3f& p : cloud.points) worst = std::max(worst, std::abs(p.x() - 7.0));
    if (i == 0) {
      EXPECT_LT(worst, 1e-5);
    } else {
      EXPECT_GT(worst, 1e-4) << "interpolated over 100 ms";
    }
    run.motion = {};
  }
}

TEST(Reproject, KeepsTheFirstReturnOfEachVoxelItself) {
  const Trajectory still = sample([](double) { return Pose::Identity(); }, 100ms, 1s);
  Events source;
  Scan scan{Time(0), {}, true};
  scan.points.push_back({{1.001F, 0.001F, 0.001F}, 1.0F, 0, 0, 0});
  scan.points.push_back({{1.019F, 0.019F, 0.019F}, 2.0F, 10, 0, 0});  // same 2 cm cell
  scan.points.push_back({{1.021F, 0.001F, 0.001F}, 3.0F, 20, 0, 0});  // the next cell
  source.events.push_back({"front", scan});
  const dataset::Cloud cloud = reprojected(source, "front", Pose::Identity(), still);
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_EQ(cloud.points[0], Eigen::Vector3f(1.001F, 0.001F, 0.001F));
  EXPECT_EQ(cloud.intensity, (std::vector{1.0F, 3.0F}));
}

TEST(Reproject, ReturnsWithoutAPoseAreDroppedAndCounted) {
  const Trajectory truth = sample(tour, 100ms, 10s);
  // estimates from 1 s to 9 s, with none strictly between 4 and 5 s
  const Trajectory estimate =
      flights::with_gap(flights::with_gap(flights::with_gap(truth, -1s, 1s), 9s, 20s), 4s, 5s);
  Events source = scans_of_a_wall(truth);
  ReprojectionCounts counts;
  const dataset::Cloud cloud = reprojected(source, "front", kBodyFromLidar, estimate, &counts);
  // 3 s of 5000 returns a second; the two returns exactly at 4 s and at 9 s have a pose
  EXPECT_EQ(counts.without_pose, 15000U - 2U);
  for (const Eigen::Vector3f& p : cloud.points) ASSERT_NEAR(p.x(), 7.0F, 1e-5F);
}

TEST(Reproject, TakesTheNamedLidarAloneAndLeavesOutNaN) {
  const Trajectory still = sample([](double) { return Pose::Identity(); }, 100ms, 1s);
  Events source;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  source.events.push_back({"imu", ImuSample{}});
  source.events.push_back({"rear", Scan{Time(0), {{{1, 1, 1}, 0, 0, 0, 0}}, true}});
  source.events.push_back(
      {"front", Scan{Time(0), {{{2, 2, 2}, 0, 0, 0, 0}, {{nan, 0, 0}, 0, 0, 0, 0}}, false}});
  ReprojectionCounts counts;
  const dataset::Cloud cloud = reprojected(source, "front", Pose::Identity(), still, &counts);
  ASSERT_EQ(cloud.points.size(), 1U);
  EXPECT_EQ(cloud.points[0], Eigen::Vector3f(2, 2, 2));
  EXPECT_EQ(counts.returns, 2U);
  EXPECT_EQ(counts.not_finite, 1U);
  EXPECT_EQ(counts.untimed_scans, 1U);
}

}  // namespace
}  // namespace lidarena::evaluation
