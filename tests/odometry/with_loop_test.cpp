// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/with_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/base/so3.hpp"
#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry {
namespace {

/// Moves on an ellipse in the room with an estimate that drifts upwards; publishes the room as seen
/// from the true pose.
class Drifter : public Odometry {
 public:
  OdometryTraits traits() const override { return {}; }
  ScanResult track(const Scan& scan) override {
    const double s = to_seconds(scan.stamp);
    const Pose truth = true_pose(s);
    pose_ = truth;
    pose_.translation().z() += 0.01 * s;
    published_.clear();
    for (const Eigen::Vector3f& p : view_) {
      const Eigen::Vector3d beam = truth.linear() * p.cast<double>();
      const double range = synthetic::cast(truth.translation(), beam);
      published_.push_back((pose_ * (range * p.cast<double>())).cast<float>());
    }
    poses_.push_back({scan.stamp, pose_});
    ScanResult result{.estimate = poses_.back(), .covariance = covariance()};
    result.up = UpDirection{Eigen::Vector3d::UnitZ(), 0.01};
    return result;
  }
  Trajectory trajectory() const override { return Trajectory(poses_, "drifter"); }
  std::vector<Eigen::Vector3f> map() const override { return {}; }
  std::span<const Eigen::Vector3f> registered_scan() const override { return published_; }
  MemoryUse memory() const override { return {}; }

  static Eigen::Matrix<double, 6, 6> covariance() {
    Eigen::Matrix<double, 6, 6> c = Eigen::Matrix<double, 6, 6>::Zero();
    c.diagonal() << 1.0, 4.0, 9.0, 0.1, 0.2, 0.3;
    c(0, 4) = c(4, 0) = 0.05;
    return c;
  }
  static Pose true_pose(double s) {
    const double angle = 0.15 * s;
    return make_pose(so3::exp({0.0, 0.0, angle}),
                     {2.5 * std::cos(angle), 1.8 * std::sin(angle), 0.0});
  }

 private:
  static std::vector<Eigen::Vector3f> beams() {
    std::vector<Eigen::Vector3f> all;
    for (int ring = -12; ring <= 12; ++ring) {
      for (int k = 0; k < 120; ++k) {
        const float e = 0.06F * static_cast<float>(ring);
        const float a = 0.05236F * static_cast<float>(k);
        all.emplace_back(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
      }
    }
    return all;
  }
  const std::vector<Eigen::Vector3f> view_ = beams();
  Pose pose_ = Pose::Identity();
  std::vector<Eigen::Vector3f> published_;
  std::vector<StampedPose> poses_;
};

WithLoopConfig quick() {
  WithLoopConfig config;
  config.keyframe_translation_m = 0.5;
  config.keyframe_rotation_rad = 0.4;
  config.loop.min_path_length_m = 10.0;
  return config;
}

/// The i-th scan, one each 0.2 s; what it sees is made up by the odometries here.
Scan scan_after(int i) {
  Scan scan;
  scan.stamp = from_seconds(0.2 * i);
  scan.points.resize(1);
  return scan;
}

double rms_height(std::span<const StampedPose> poses) {
  double sum = 0.0;
  for (const StampedPose& pose : poses)
    sum += pose.world_from_body.translation().z() * pose.world_from_body.translation().z();
  return std::sqrt(sum / static_cast<double>(poses.size()));
}

TEST(WithLoop, MovesAllThatIsInTheWorldAndSaysByHowMuch) {
  Drifter alone;
  WithLoop looped(std::make_unique<Drifter>(), quick(), Parallel(1));
  bool moved = false;
  for (int i = 0; i < 320; ++i) {
    const ScanResult raw = alone.register_scan(scan_after(i));
    const ScanResult result = looped.register_scan(scan_after(i));
    const Pose& world_from_odom = result.world_from_odom;
    const Eigen::Matrix3d rotation = world_from_odom.linear();
    moved = moved || so3::angle(rotation) > 1e-4;
    EXPECT_TRUE((world_from_odom.inverse() * result.estimate.world_from_body)
                    .isApprox(raw.estimate.world_from_body, 1e-9))
        << "without the loops it is the odometry's own, which is continuous";
    // the position's part turns with the world, the rotation's is about the body's axes
    EXPECT_TRUE(result.covariance->topLeftCorner(3, 3).isApprox(
        rotation * Drifter::covariance().topLeftCorner(3, 3) * rotation.transpose(), 1e-12));
    EXPECT_TRUE(result.covariance->topRightCorner(3, 3).isApprox(
        rotation * Drifter::covariance().topRightCorner(3, 3), 1e-12));
    EXPECT_TRUE(result.covariance->bottomRightCorner(3, 3).isApprox(
        Drifter::covariance().bottomRightCorner(3, 3), 1e-12));
    EXPECT_TRUE(result.up->direction.isApprox(rotation.col(2), 1e-12));
  }
  EXPECT_TRUE(moved);
}

TEST(WithLoop, CuresTheDriftOfAnyOdometryAndKeepsTheLiveEstimatesAsTheyWere) {
  Drifter alone;
  WithLoop looped(std::make_unique<Drifter>(), quick(), Parallel(1));
  std::vector<StampedPose> live;
  for (int i = 0; i < 320; ++i) {  // 64 s, one and a half rounds
    const Scan scan = scan_after(i);
    alone.register_scan(scan);
    live.push_back(looped.register_scan(scan).estimate);
  }
  looped.finish();
  EXPECT_TRUE(looped.traits().revises_past);
  EXPECT_FALSE(looped.traits().publishes_scans);
  ASSERT_GT(looped.loops().accepted(), 0U);
  const Trajectory before = alone.trajectory();
  const Trajectory after = looped.trajectory();
  ASSERT_EQ(after.size(), before.size());
  EXPECT_LT(rms_height(after.poses()), 0.6 * rms_height(before.poses()));
  // up to the first loop the live estimate is that of the odometry
  EXPECT_LT(
      (live[50].world_from_body.translation() - before.poses()[50].world_from_body.translation())
          .norm(),
      1e-9);
  EXPECT_LT(std::abs(live.back().world_from_body.translation().z()),
            0.7 * before.poses().back().world_from_body.translation().z());
  EXPECT_GT(looped.map().size(), 1000U);
  for (const Eigen::Vector3f& p : looped.map())
    EXPECT_LT(std::abs(p.z()), 2.6F) << "walls 4 m high";
}

TEST(WithLoop, AKnownPlaceIsNotKeptTwice) {
  WithLoop looped(std::make_unique<Drifter>(), quick(), Parallel(1));
  std::uint64_t after_two_rounds = 0;
  std::uint64_t loops_then = 0;
  std::size_t keyframes = 0;
  for (int i = 0; i < 1050; ++i) {  // 210 s, five rounds
    const Scan scan = scan_after(i);
    looped.register_scan(scan);
    if (i != 420) continue;
    after_two_rounds = looped.memory().map;
    loops_then = looped.loops().memory_bytes();
    keyframes = looped.loops().poses().size();
  }
  EXPECT_LT(static_cast<double>(looped.memory().map), 1.3 * static_cast<double>(after_two_rounds))
      << "it would be 2.5 times as much";
  // the graph grows with the path, descriptors do not
  EXPECT_LT(looped.loops().memory_bytes() - loops_then,
            (looped.loops().poses().size() - keyframes) * sizeof(loop::PlaceDescriptor) / 2);
}

/// Its first four scans are initializing, 5 cm off, and their poses are mended with the fifth.
class LateStarter : public Drifter {
 public:
  ScanResult track(const Scan& scan) override {
    ScanResult result = Drifter::track(scan);
    if (++scans_ >= 5) return result;
    result.status = ScanStatus::kInitializing;
    result.estimate.world_from_body.translation().x() += 0.05;
    return result;
  }

 private:
  int scans_ = 0;
};

TEST(WithLoop, PosesOfAnUnfinishedStartAreTakenOverOnceTheyAreRevised) {
  LateStarter alone;
  WithLoop looped(std::make_unique<LateStarter>(), quick(), Parallel(1));
  for (int i = 0; i < 20; ++i) {
    const Scan scan = scan_after(i);
    alone.register_scan(scan);
    const ScanResult result = looped.register_scan(scan);
    EXPECT_EQ(result.detail("keyframes") == 0, i < 4) << "no keyframe of a scan that will move";
  }
  const Trajectory poses = looped.trajectory();
  const Trajectory expected = alone.trajectory();
  ASSERT_EQ(poses.size(), expected.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(poses.poses()[i].stamp, expected.poses()[i].stamp);
    EXPECT_TRUE(
        poses.poses()[i].world_from_body.isApprox(expected.poses()[i].world_from_body, 1e-9))
        << i;
  }
}

/// Each pose is 2 cm off until the next scan revises it.
class Reviser : public Drifter {
 public:
  ScanResult track(const Scan& scan) override {
    const Trajectory before = trajectory();
    ScanResult result = Drifter::track(scan);
    if (before.size() > 0) result.revised = {before.poses().back()};
    result.estimate.world_from_body.translation().x() += 0.02;
    return result;
  }
};

TEST(WithLoop, APoseThatTheNextScanRevisesIsTakenOver) {
  Reviser alone;
  WithLoop looped(std::make_unique<Reviser>(), quick(), Parallel(1));
  for (int i = 0; i < 20; ++i) {
    const Scan scan = scan_after(i);
    alone.register_scan(scan);
    const ScanResult result = looped.register_scan(scan);
    ASSERT_EQ(result.revised.size(), i > 0 ? 1U : 0U);
  }
  ASSERT_GT(looped.loops().poses().size(), 2U) << "keyframes";
  const Trajectory poses = looped.trajectory();
  const Trajectory expected = alone.trajectory();
  ASSERT_EQ(poses.size(), expected.size());
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    EXPECT_TRUE(
        poses.poses()[i].world_from_body.isApprox(expected.poses()[i].world_from_body, 1e-9))
        << i;
  }
}

}  // namespace
}  // namespace lidarena::odometry
