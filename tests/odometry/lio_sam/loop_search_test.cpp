// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/loop_search.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/so3.hpp"
#include "tests/loop/places.hpp"

namespace lidarena::odometry::lio_sam {
namespace {

namespace places = loop::places;

map::Keyframe keyframe_at(double seconds, const Pose& pose) {
  return {from_seconds(seconds), pose, {}, 0};
}

Pose pose_at(double x) { return make_pose(Eigen::Matrix3d::Identity(), {x, 0, 0}); }

TEST(LioSamLoops, TheCandidateIsTheNearestThatIsOldEnough) {
  const LoopRule rule;  // 15 m, 30 s
  std::vector<map::Keyframe> keyframes{
      keyframe_at(0.0, pose_at(0.0)), keyframe_at(10.0, pose_at(5.0)),
      keyframe_at(25.0, pose_at(6.5)), keyframe_at(50.0, pose_at(7.0))};
  EXPECT_EQ(find_candidate(keyframes, rule), 1U) << "the third is nearer, but 25 s old";
  keyframes.push_back(keyframe_at(90.0, pose_at(22.5)));
  EXPECT_EQ(find_candidate(keyframes, rule), std::nullopt) << "all old ones are beyond 15 m";
}

/// 1.3 times around a block with odometry that is 1 % too long and turns too far.
struct Trip {
  std::vector<Pose> truth;
  std::vector<map::Keyframe> keyframes;
  std::size_t accepted = 0;

  explicit Trip(const Config& config) {
    const places::Points world = places::ring_corridor();
    LoopSearch loops(config, Parallel(1));
    for (int i = 0; i <= 104; ++i) {
      truth.push_back(places::around_the_block(i));
      const Pose error = make_pose(so3::exp({0, 0, 0.001}), {0.01, 0, 0});
      const Pose step = i == 0 ? truth[0] : truth.end()[-2].inverse() * truth.back() * error;
      const Pose pose = i == 0 ? step : keyframes.back().world_from_lidar * step;
      keyframes.push_back(keyframe_at(i, pose));
      keyframes.back().features.surfaces =
          places::seen_from(truth.back(), world, 9.0, static_cast<std::uint64_t>(i));
      if (!loops.close(keyframes, step)) continue;
      for (std::size_t k = 0; k < keyframes.size(); ++k)
        keyframes[k].world_from_lidar = loops.poses()[k];
    }
    accepted = loops.accepted();
  }
  double rms_error() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i)
      sum += (keyframes[i].world_from_lidar.translation() - truth[i].translation()).squaredNorm();
    return std::sqrt(sum / static_cast<double>(truth.size()));
  }
};

TEST(LioSamLoops, ComingBackCuresTheDriftAndEverySearchAddsALoop) {
  Config config;
  config.surface_voxel_size_m = 0.4;
  config.loop.target_keyframes = 8;
  config.loop.interval_s = 4.0;
  const Trip drifted(config);
  EXPECT_EQ(drifted.accepted, 0U) << "not asked for";
  config.loop_closure = true;
  const Trip closed(config);
  EXPECT_GT(closed.accepted, 2U);
  EXPECT_LT(closed.rms_error(), 0.5 * drifted.rms_error());
}

TEST(LioSamLoops, AFewPointsAreNoPlace) {
  Config config;
  config.loop_closure = true;
  LoopSearch loops(config, Parallel(1));
  std::vector<map::Keyframe> keyframes;
  for (int i = 0; i < 40; ++i) {
    keyframes.push_back(keyframe_at(i, pose_at(0.0)));
    keyframes.back().features.surfaces.assign(20, {1.0F, 2.0F, 3.0F});
    EXPECT_FALSE(loops.close(keyframes, Pose::Identity()));
  }
  EXPECT_GT(loops.tried(), 0U);
  EXPECT_EQ(loops.accepted(), 0U);
}

}  // namespace
}  // namespace lidarena::odometry::lio_sam
