// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/features.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::lio_sam {
namespace {

using Eigen::Vector3d;

Time ms(int milliseconds) { return Time{milliseconds * 1'000'000}; }

/// A turn about z by 1 rad/s and a flight along x by 2 m/s, from time 0 on.
estimation::ImuTrack turning() {
  return {{.begin = Time{0}, .velocity = {2.0, 0.0, 0.0}, .rate = {0.0, 0.0, 1.0}}};
}

/// Points at (5, 0, 0) with these times, in this order.
Scan scan_of(const std::vector<int>& milliseconds) {
  Scan scan;
  for (const int at : milliseconds) {
    Point point;
    point.position = {5.0F, 0.0F, 0.0F};
    point.dt_ns = at * 1'000'000;
    scan.points.push_back(point);
  }
  return scan;
}

/// Angle about z of each point after de-skewing, rad.
std::vector<double> angles(const Scan& scan, Time known_until) {
  const estimation::ImageLayout layout{.min_range_m = 0.5};
  std::vector<double> angles;
  for (const Eigen::Vector3f& p : deskewed(scan, turning(), known_until, Pose::Identity(), layout))
    angles.push_back(std::atan2(double{p.y()}, double{p.x()}));
  return angles;
}

TEST(LioSamDeskew, RemovesTheRotationAndLeavesTheTranslation) {
  const Scan scan = scan_of({0, 50, 100});
  const auto points = deskewed(scan, turning(), ms(110), Pose::Identity(), {});
  EXPECT_EQ(points[0], scan.points[0].position);
  for (const std::size_t i : {1U, 2U}) {
    const double angle = 0.05 * static_cast<double>(i);
    const Vector3d turned = so3::exp({0.0, 0.0, angle}) * Vector3d(5.0, 0.0, 0.0);
    EXPECT_LT((points[i].cast<double>() - turned).norm(), 1e-6) << "2 m/s would be 10 cm";
  }
}

TEST(LioSamDeskew, TheFrameIsThatOfTheFirstUsablePointInMessageOrder) {
  Scan scan = scan_of({40, 60, 0});
  scan.points[0].position = {0.1F, 0.0F, 0.0F};  // too near
  const std::vector<double> turned = angles(scan, ms(110));
  EXPECT_NEAR(turned[1], 0.0, 1e-6);
  EXPECT_NEAR(turned[2], -0.06, 1e-6);
}

TEST(LioSamDeskew, TheEndIsThatOfTheLastPointInMessageOrder) {
  EXPECT_EQ(end_in_message(scan_of({0, 100, 50})), ms(50)) << "not 100 ms";
  EXPECT_EQ(end_in_message(scan_of({0, 50, 100})), ms(100));
  EXPECT_EQ(end_in_message(Scan{}), Time{0});
  Scan untimed = scan_of({0, 50});
  untimed.timed = false;
  EXPECT_EQ(end_in_message(untimed), Time{0});
}

TEST(LioSamDeskew, PointsLaterThanTheKnownRotationsGetTheLastOne) {
  const std::vector<double> turned = angles(scan_of({0, 50, 100}), ms(60));
  EXPECT_NEAR(turned[1], 0.05, 1e-6);
  EXPECT_NEAR(turned[2], 0.06, 1e-6);
}

TEST(LioSamDeskew, AMountedLidarTurnsAboutItself) {
  const Pose imu_from_lidar = make_pose(so3::exp({0.0, 0.0, 1.5}), {3.0, 1.0, 0.0});
  const auto points = deskewed(scan_of({0, 100}), turning(), ms(110), imu_from_lidar, {});
  EXPECT_NEAR(std::atan2(double{points[1].y()}, double{points[1].x()}), 0.1, 1e-6);
  EXPECT_NEAR(double{points[1].norm()}, 5.0, 1e-5);
}

TEST(LioSamFeatures, ThePortToLivoxFindsEdgesInOtherRows) {
  Config config;
  config.edge_threshold_m2 = 0.5;
  config.row_surface_voxel_size_m = 0.3;
  config.sensor = Sensor::kSpinning;
  const FeatureRule spinning = feature_rule(config);
  EXPECT_TRUE(spinning.layout.by_azimuth);
  EXPECT_EQ(spinning.edges.neighbors, estimation::kSpinningEdges.neighbors);
  EXPECT_EQ(spinning.edges.threshold_m2, 0.5);
  EXPECT_EQ(spinning.row_surface_voxel_size_m, 0.3);
  config.sensor = Sensor::kLivox;
  const FeatureRule livox = feature_rule(config);
  EXPECT_FALSE(livox.layout.by_azimuth);
  EXPECT_EQ(livox.edges.neighbors, estimation::kLivoxEdges.neighbors);
  EXPECT_EQ(livox.edges.threshold_m2, 0.5);
}

TEST(LioSamConfig, ThePresetsAreThoseOfTheProgramOrOfItsPort) {
  LidarInfo lidar;
  lidar.kind = "spinning";
  lidar.columns = 1024;
  EXPECT_EQ(published(lidar).sensor, Sensor::kSpinning);
  EXPECT_EQ(published(lidar).columns, 1024);
  EXPECT_EQ(published(lidar).surface_voxel_size_m, 0.4);
  EXPECT_EQ(published(lidar).min_range_m, 1.0);
  EXPECT_EQ(indoor(lidar).surface_voxel_size_m, 0.2);
  EXPECT_EQ(indoor(lidar).min_range_m, 0.5);
  lidar.kind = "rosette";
  EXPECT_EQ(published(lidar).sensor, Sensor::kLivox);
  EXPECT_EQ(published(lidar).keyframe_translation_m, 0.5);
  EXPECT_FALSE(indoor(lidar).loop_closure);
}

}  // namespace
}  // namespace lidarena::odometry::lio_sam
