// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/deskew.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "lidarena/base/random.hpp"

namespace lidarena::estimation {
namespace {

using se3::Vector6;

Vector6 twist(double vx, double vy, double vz, double wx, double wy, double wz) {
  Vector6 xi;
  xi << vx, vy, vz, wx, wy, wz;
  return xi;
}

/// Landmarks within 5 m, each measured at a different instant by a lidar that starts at the origin
/// and moves with the constant twist `xi` for 0.1 s.
Scan sweep(const std::vector<Eigen::Vector3d>& landmarks, const Vector6& xi) {
  Scan scan;
  scan.stamp = Time{1'700'000'000'123'456'789};
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    Point point;
    point.dt_ns = static_cast<std::int32_t>(i * 100'000'000 / landmarks.size());
    const Pose world_from_lidar = se3::exp(xi * (point.dt_ns * 1e-9));
    point.position = (world_from_lidar.inverse() * landmarks[i]).cast<float>();
    scan.points.push_back(point);
  }
  return scan;
}

std::vector<Eigen::Vector3d> some_landmarks() {
  SequentialRandom random(5);
  std::vector<Eigen::Vector3d> landmarks;
  for (int i = 0; i < 5000; ++i)
    landmarks.emplace_back(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5));
  return landmarks;
}

// Points are floats within 8.7 m: two roundings of 2^-24 x 8.7 m on three axes.
constexpr double kRounding = 2e-6;

TEST(Deskew, UndoesAConstantTwistExactlyWhateverTheReferenceInstant) {
  const auto landmarks = some_landmarks();
  for (const Vector6& xi :
       {twist(2, -1, 0.5, 0.3, -1, 3), twist(3, 0, 0, 0, 0, 0), twist(0, 0, 0, 0, 0, 6),
        twist(1, 2, 3, 1e-5, 0, 0), twist(1, 2, 3, 0, 1e-10, 0)}) {
    const Scan scan = sweep(landmarks, xi);
    for (const double reference_s : {0.0, 0.05, 0.1, 0.35}) {
      const Pose world_from_reference = se3::exp(xi * reference_s);
      const auto points = deskew(scan, xi, scan.stamp + from_seconds(reference_s), Parallel(1));
      ASSERT_EQ(points.size(), landmarks.size());
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3d error =
            world_from_reference * points[i].cast<double>() - landmarks[i];
        ASSERT_LT(error.norm(), kRounding) << xi.transpose() << " at " << reference_s;
      }
    }
  }
}

TEST(Deskew, IsTheSameBitsOnAnyNumberOfThreads) {
  const Vector6 xi = twist(2, -1, 0.5, 0.3, -1, 3);
  const Scan scan = sweep(some_landmarks(), xi);
  EXPECT_EQ(deskew(scan, xi, scan.stamp, Parallel(1)), deskew(scan, xi, scan.stamp, Parallel(3)));
}

TEST(Deskew, LeavesAnUntimedScanAlone) {
  Scan scan = sweep(some_landmarks(), twist(2, -1, 0.5, 0.3, -1, 3));
  scan.timed = false;
  EXPECT_EQ(deskew(scan, twist(1, 1, 1, 1, 1, 1), scan.stamp, Parallel(1)), positions(scan));
}

TEST(Deskew, APointThatIsNotFiniteStaysSoAndHarmsNoOther) {
  Scan scan = sweep(some_landmarks(), Vector6::Zero());
  const auto whole = deskew(scan, twist(1, 0, 0, 0, 0, 1), scan.stamp, Parallel(1));
  scan.points[17].position.y() = std::numeric_limits<float>::quiet_NaN();
  const auto holed = deskew(scan, twist(1, 0, 0, 0, 0, 1), scan.stamp, Parallel(1));
  EXPECT_FALSE(holed[17].allFinite());
  EXPECT_EQ(holed[16], whole[16]);
  EXPECT_EQ(holed[18], whole[18]);
}

TEST(ConstantTwist, IsTheExponentialOfTheTwist) {
  SequentialRandom random(8);
  for (int i = 0; i < 200; ++i) {
    Vector6 xi;
    for (double& x : xi) x = random.uniform(-4, 4);
    if (i % 3 == 0) xi.tail<3>() *= 1e-7;
    const double seconds = random.uniform(-0.5, 0.5);
    const Pose expected = se3::exp(xi * seconds);
    // differences of numbers of order 1, some divided by rates of 1e-7
    EXPECT_LT((ConstantTwist(xi).at(seconds).matrix() - expected.matrix()).norm(), 1e-8);
  }
}

}  // namespace
}  // namespace lidarena::estimation
