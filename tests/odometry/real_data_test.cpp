// SPDX-License-Identifier: BSD-3-Clause
// Tests of the LiDAR-only methods on recorded sweeps; skipped if the shared data is not there.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "lidarena/base/so3.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/odometry/factory.hpp"

namespace lidarena::odometry {
namespace {

const std::filesystem::path kLidarData = std::filesystem::path(LIDARENA_SHARED_DATA) / "lidar";

struct Case {
  const char* algorithm;
  const char* preset;
};

class OnRealData : public ::testing::TestWithParam<Case> {
 protected:
  static std::unique_ptr<Odometry> make() {
    Rig rig;
    rig.lidars.emplace_back();
    return make_odometry({GetParam().algorithm, GetParam().preset, "", {}}, rig, "", Parallel(2))
        .odometry;
  }
  /// Pose of the second scan in the frame of the first.
  static Pose motion_between(const std::vector<Eigen::Vector3f>& first,
                             const std::vector<Eigen::Vector3f>& second);
};

Scan untimed(const std::vector<Eigen::Vector3f>& positions, int index) {
  Scan scan;
  scan.stamp = index * from_seconds(0.1);
  scan.timed = false;
  for (const auto& position : positions) scan.points.emplace_back().position = position;
  return scan;
}

Pose OnRealData::motion_between(const std::vector<Eigen::Vector3f>& first,
                                const std::vector<Eigen::Vector3f>& second) {
  const auto odometry = make();
  odometry->register_scan(untimed(first, 0));
  return odometry->register_scan(untimed(second, 1)).estimate.world_from_body;
}

double degrees(const Pose& pose) { return so3::angle(pose.linear()) * 57.29578; }

TEST_P(OnRealData, FollowsACarAlongAStreet) {
  const auto folder = kLidarData / "kitti_drive";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "skipped: the 15 sweeps of kitti_drive are missing";
  dataset::Dataset dataset = dataset::open_dataset(folder);
  const auto odometry = make();
  while (const auto event = dataset.events->next())
    odometry->register_scan(std::get<Scan>(event->data));
  const Trajectory trajectory = odometry->trajectory();
  ASSERT_EQ(trajectory.size(), 15U);
  const auto poses = trajectory.poses();
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Pose step = poses[i - 1].world_from_body.inverse() * poses[i].world_from_body;
    const Eigen::Vector3d turn = so3::log(step.linear()) * 57.29578;
    // 0.40 to 0.46 m forward and about 1 degree of yaw per sweep, according to another ICP; spread
    // of 3 cm and 0.3 degrees for either method
    EXPECT_NEAR(step.translation().x(), 0.43, 0.06) << i;
    EXPECT_LT(step.translation().tail<2>().norm(), 0.06) << i;
    EXPECT_NEAR(turn.z(), 1.0, 0.6) << i;
    EXPECT_LT(turn.head<2>().norm(), 0.5) << i;
  }
}

TEST_P(OnRealData, FindsThePublishedMotionBetweenTwoSweeps) {
  const auto folder = kLidarData / "small_gicp_pair";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "skipped: the pair of small_gicp_pair is missing";
  Pose target_from_source = Pose::Identity();
  std::ifstream in(folder / "T_target_source.txt");
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) in >> target_from_source.matrix()(row, column);
  }
  ASSERT_TRUE(in);
  const Pose found = motion_between(dataset::read_cloud(folder / "target.ply").points,
                                    dataset::read_cloud(folder / "source.ply").points);
  const Pose error = target_from_source.inverse() * found;
  // The published motion agrees with another ICP to 0.02 m and 0.3 degrees. A method's own noise
  // comes on top: keypoints are 1.5 m apart, so 0.25 m of matching noise divided by the square root
  // of about 1000 keypoints is 8 mm, at 10 m 0.05 degrees.
  EXPECT_LT(error.translation().norm(), 0.05);
  EXPECT_LT(degrees(error), 0.35);
}

TEST_P(OnRealData, ThereAndBackAgainIsNoMotion) {
  const auto folder = kLidarData / "gtsam_points" / "kitti_00";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: the pair of kitti_00 is missing";
  dataset::ReadOptions options;
  options.layout = "xyz";
  dataset::Dataset dataset = dataset::open_dataset(folder, options);
  std::vector<std::vector<Eigen::Vector3f>> clouds;
  while (const auto event = dataset.events->next()) {
    auto& cloud = clouds.emplace_back();
    for (const Point& point : std::get<Scan>(event->data).points) cloud.push_back(point.position);
  }
  ASSERT_EQ(clouds.size(), 2U);
  const Pose there = motion_between(clouds[0], clouds[1]);
  const Pose back = motion_between(clouds[1], clouds[0]);
  EXPECT_GT(there.translation().x(), 0.3) << "the car drives forward";
  EXPECT_LT((there * back).translation().norm(), 0.05);
  EXPECT_LT(degrees(there * back), 0.2);
}

INSTANTIATE_TEST_SUITE_P(LidarOnly, OnRealData,
                         ::testing::Values(Case{"kiss_icp_head", ""}, Case{"kiss_icp", "indoor"},
                                           Case{"kiss_icp", "published"},
                                           Case{"ct_icp", "published"}, Case{"arena_lo", ""}),
                         [](const auto& tried) {
                           const std::string preset = tried.param.preset;
                           return tried.param.algorithm + (preset.empty() ? "" : "_" + preset);
                         });

}  // namespace
}  // namespace lidarena::odometry
