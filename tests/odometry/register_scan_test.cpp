// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "lidarena/odometry/odometry.hpp"

namespace lidarena::odometry {
namespace {

/// Counts the scans that reach it; its pose moves by 1 m along x with each.
class Counting final : public Odometry {
 public:
  OdometryTraits traits() const override { return {}; }
  Trajectory trajectory() const override { return {}; }
  std::vector<Eigen::Vector3f> map() const override { return {}; }
  MemoryUse memory() const override { return {}; }
  int tracked = 0;

 protected:
  ScanResult track(const Scan& scan) override {
    ScanResult result;
    const Eigen::Vector3d position(++tracked, 0.0, 0.0);
    result.estimate = {scan.stamp, make_pose(Eigen::Matrix3d::Identity(), position)};
    return result;
  }
};

Scan scan_between(int begin_ms, int end_ms) {
  Scan scan;
  scan.stamp = std::chrono::milliseconds(begin_ms);
  Point last;
  last.dt_ns = (end_ms - begin_ms) * 1'000'000;
  scan.points = {last};
  return scan;
}

TEST(RegisterScan, AScanThatIsNotLaterIsRefusedCountedAndChangesNothing) {
  Counting odometry;
  EXPECT_EQ(odometry.register_scan(scan_between(100, 200)).status, ScanStatus::kTracked);
  EXPECT_EQ(odometry.register_scan(scan_between(200, 300)).status, ScanStatus::kTracked);
  // twice, before the last one, with an earlier first or last point
  for (const Scan& late : {scan_between(200, 300), scan_between(100, 150), scan_between(150, 400),
                           scan_between(250, 290)}) {
    const ScanResult refused = odometry.register_scan(late);
    EXPECT_EQ(refused.status, ScanStatus::kRefused);
    EXPECT_EQ(refused.estimate.stamp, std::chrono::milliseconds(200));
    EXPECT_EQ(refused.estimate.world_from_body.translation().x(), 2.0);
  }
  EXPECT_EQ(odometry.tracked, 2);
  EXPECT_EQ(odometry.scans_refused(), 4U);
  EXPECT_EQ(odometry.register_scan(scan_between(250, 350)).status, ScanStatus::kTracked)
      << "scans may overlap";
  Scan empty;
  empty.stamp = std::chrono::milliseconds(351);
  EXPECT_EQ(odometry.register_scan(empty).status, ScanStatus::kTracked);
}

TEST(RegisterScan, DetailsAreFoundByName) {
  ScanResult result;
  result.details = {{"matches", 12.0}};
  EXPECT_EQ(result.detail("matches"), 12.0);
  EXPECT_FALSE(result.detail("match"));
}

}  // namespace
}  // namespace lidarena::odometry
