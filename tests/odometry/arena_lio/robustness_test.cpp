// SPDX-License-Identifier: BSD-3-Clause
// Tests of arena_lio in situations that a robot gets into: dust, a bare corridor, glass, people, a
// clock that is off, a LiDAR that is mounted otherwise than told, a start on a slope.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/odometry/arena_lio/arena_lio.hpp"
#include "tests/odometry/playback.hpp"

namespace lidarena::odometry::arena_lio {
namespace {

using synthetic::Box;
using synthetic::Outcome;
using synthetic::Recording;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kPoints = 64 * 256;

/// Turns back and forth with up to 2 rad/s while it flies the usual curve.
Pose lively(double t) {
  const double u = std::max(0.0, t - 1.0);
  const double turn = 0.5 * std::sin(4.0 * u) * std::min(1.0, u * u);
  const double nod = 0.2 * std::sin(3.1 * u) * std::min(1.0, u * u);
  return synthetic::flight(t) * make_pose(so3::exp({0.2 * turn, nod, turn}), {0, 0, 0});
}

/// The results, with the poses as they stand at the end.
Outcome play(const Recording& recording, const std::vector<Event>& events,
             const Pose& misplaced = Pose::Identity()) {
  Rig rig = synthetic::rig_of(recording);
  LidarInfo& lidar = rig.lidars.front();
  lidar.body_from_lidar = lidar.body_from_lidar * misplaced;
  ArenaLio odometry(settings_for(lidar), lidar, rig.imus.front(), Parallel(1));
  Outcome outcome = synthetic::play(events, odometry);
  odometry.finish();
  const Trajectory trajectory = odometry.trajectory();
  for (std::size_t i = 0; i < outcome.results.size(); ++i)
    outcome.results[i].estimate = trajectory.poses()[i];
  return outcome;
}
Outcome play(const Recording& recording) { return play(recording, synthetic::record(recording)); }

double seconds_at(const ScanResult& result) {
  return to_seconds(result.estimate.stamp - Recording{}.epoch);
}

TEST(ArenaLioRobustness, FiveSecondsInDustAreSurvived) {
  const Recording recording{.motion = lively, .seconds = 9.0, .repeating = false};
  std::vector<Event> events = synthetic::record(recording);
  SequentialRandom random(1, 1);
  for (Event& event : events) {
    auto* scan = std::get_if<Scan>(&event.data);
    const double t = scan == nullptr ? 0.0 : to_seconds(scan->stamp - recording.epoch);
    if (t < 3.0 || t > 8.0) continue;
    for (Point& point : scan->points) {  // a return in eight is from dust
      const double dust = 0.5 + 2.0 * random.uniform();
      const auto range = static_cast<double>(point.position.norm());
      if (random.uniform() < 0.125 && dust < range)
        point.position *= static_cast<float>(dust / range);
    }
    std::erase_if(scan->points, [&](const Point&) { return random.uniform() < 0.9; });
  }
  const Outcome outcome = play(recording, events);
  EXPECT_LT(outcome.final_error(recording), 0.02);
  EXPECT_EQ(outcome.count(ScanStatus::kDiverged), 0U);
}

TEST(ArenaLioRobustness, ANoisyAccelerometerIsBorneBySlicesOfAScan) {
  const Recording recording{.motion = lively, .seconds = 6.0, .repeating = false};
  std::vector<Event> events = synthetic::record(recording);
  SequentialRandom random(2, 1);
  for (Event& event : events) {
    auto* sample = std::get_if<ImuSample>(&event.data);
    if (sample == nullptr) continue;
    for (double& axis : sample->accel) axis += 2.0 * random.normal();  // m/s^2
  }
  const auto error = [&](double max_slice_error_m) {
    const Rig rig = synthetic::rig_of(recording);
    Config config = settings_for(rig.lidars.front());
    config.max_slice_error_m = max_slice_error_m;
    ArenaLio odometry(config, rig.lidars.front(), rig.imus.front(), Parallel(1));
    synthetic::play(events, odometry);
    double sum = 0.0;
    const Trajectory trajectory = odometry.trajectory();
    const auto poses = trajectory.poses();
    const auto truth = [&](const StampedPose& pose) {
      return recording.motion(to_seconds(pose.stamp - recording.epoch));
    };
    for (std::size_t i = 1; i < poses.size(); ++i) {  // of the motion from scan to scan
      const Pose moved = poses[i - 1].world_from_body.inverse() * poses[i].world_from_body;
      const Pose truly = truth(poses[i - 1]).inverse() * truth(poses[i]);
      sum += (moved.translation() - truly.translation()).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(poses.size() - 1));
  };
  const double in_slices = error(Config{}.max_slice_error_m);
  RecordProperty("in_slices_mm", std::to_string(1e3 * in_slices));
  EXPECT_LT(in_slices, 0.5 * error(1.0)) << "against one update a scan";
}

/// 3 m wide and 2.4 m high, along x; only at its ends are there pillars. The range ends at 10 m.
double corridor(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double) {
  double range = cast(Box{{-100.0, -1.5, -1.2}, {200.0, 1.5, 1.2}}, origin, direction);
  for (const double x : {-6.0, -3.0, 2.0, 5.0, 31.0, 34.0, 37.0, 41.0, 44.0, 47.0})
    range = std::min(range, cast(Box{{x, 0.9, -1.2}, {x + 0.6, 1.5, 1.2}}, origin, direction));
  return range < 10.0 ? range : kInfinity;
}

TEST(ArenaLioRobustness, ABareCorridorIsToldAndDriftsAsTheImuDoes) {
  const auto along = [](double t) {  // up to 3 m/s, to x = 41
    const double u = std::max(0.0, t - 1.0);
    const double x = u < 2.0 ? 0.75 * u * u : 3.0 + 3.0 * (u - 2.0);
    return make_pose(so3::exp({0.0, 0.0, 0.3 * std::sin(u)}),
                     {x, 0.3 * (1.0 - std::cos(u)), 0.1 * std::sin(u)});
  };
  const Recording recording{.motion = along,
                            .seconds = 15.5,
                            .points_per_scan = kPoints,
                            .repeating = false,
                            .gyro_noise_density = 2.4e-4,
                            .accel_noise_density = 1.7e-3,
                            .scene = corridor};
  const Outcome outcome = play(recording);
  std::size_t told = 0;
  std::size_t bare = 0;
  for (const ScanResult& result : outcome.results) {
    const double x = along(seconds_at(result)).translation().x();
    if (x < 15.9 || x > 20.5) continue;  // no pillar within 10 m, 0.1 s before either
    ++bare;
    told += result.status == ScanStatus::kDegenerate ? 1 : 0;
  }
  EXPECT_GT(bare, 14U);
  EXPECT_GE(told, bare - bare / 10);
  EXPECT_LT(outcome.final_error(recording), 0.3);
  EXPECT_EQ(outcome.results.back().status, ScanStatus::kTracked);
  EXPECT_EQ(outcome.count(ScanStatus::kDiverged), 0U);
}

TEST(ArenaLioRobustness, PeopleWhoWalkThroughAreNotFollowed) {
  const auto with_people = [](const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                              double t) {
    double range = synthetic::cast(origin, direction);
    for (int i = 0; i < 8; ++i) {  // they walk to and fro at up to 1.5 m/s
      const Eigen::Array3d at(2.5 * std::sin(0.6 * t + 0.8 * i), -4.5 + 1.2 * i, -1.1);
      const Eigen::Array3d half(0.3, 0.25, 0.9);
      range = std::min(range, cast(Box{at - half, at + half}, origin, direction));
    }
    return range;
  };
  const Recording recording{.motion = lively,
                            .seconds = 9.0,
                            .points_per_scan = kPoints,
                            .repeating = false,
                            .scene = with_people};
  const Outcome outcome = play(recording);
  EXPECT_LT(outcome.final_error(recording), 0.02);
  EXPECT_EQ(outcome.count(ScanStatus::kDiverged), 0U);
}

TEST(ArenaLioRobustness, AGlassWallIsNoWall) {
  // The wall at x = 8 is of glass: seen when met squarely, a mirror when met at a low angle, and
  // otherwise what is seen is the wall behind it, at x = 14.
  const auto glass = [](const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double) {
    const double range = synthetic::cast(origin, direction);
    const Eigen::Vector3d hit = origin + range * direction;
    if (hit.x() < 8.0 - 1e-6 || direction.x() > 0.97) return range;
    Eigen::Vector3d mirrored = direction;
    mirrored.x() = -mirrored.x();
    if (direction.x() < 0.4) return range + synthetic::cast(hit - 1e-6 * direction, mirrored);
    return cast(Box{{-8.0, -20.0, -2.0}, {14.0, 20.0, 2.0}}, origin, direction);
  };
  const Recording recording{.motion = lively,
                            .seconds = 9.0,
                            .points_per_scan = kPoints,
                            .repeating = false,
                            .scene = glass};
  const Outcome outcome = play(recording);
  EXPECT_LT(outcome.final_error(recording), 0.02);
  EXPECT_EQ(outcome.count(ScanStatus::kDiverged), 0U);
}

TEST(ArenaLioRobustness, AClockThatIsOffIsFound) {
  for (const double off_s : {0.02, -0.02}) {
    const Recording recording{.motion = lively, .seconds = 8.0, .repeating = false};
    std::vector<Event> events = synthetic::record(recording);
    for (Event& event : events) {
      auto* scan = std::get_if<Scan>(&event.data);
      if (scan != nullptr) scan->stamp += from_seconds(off_s);
    }
    Outcome outcome = play(recording, events);
    EXPECT_NEAR(outcome.results.back().detail("imu_delay_s").value(), -off_s, 1e-3);
    EXPECT_EQ(outcome.count(ScanStatus::kDiverged), 0U);
    for (ScanResult& result : outcome.results) result.estimate.stamp -= from_seconds(off_s);
    EXPECT_LT(outcome.final_error(recording), 0.02);
  }
}

TEST(ArenaLioRobustness, ALidarThatIsMountedOtherwiseThanToldIsSurvivedAndTold) {
  const Recording recording{
      .motion = lively, .seconds = 11.0, .points_per_scan = kPoints, .repeating = false};
  constexpr double kDegree = 0.0174533;
  const Pose misplaced =
      make_pose(so3::exp(kDegree * Eigen::Vector3d(1.2, -1.2, 1.1)), {0.012, -0.010, 0.012});
  Outcome outcome = play(recording, synthetic::record(recording), misplaced);
  for (ScanResult& result : outcome.results)  // the body is where the LiDAR is told to be on it
    result.estimate.world_from_body = result.estimate.world_from_body * misplaced;
  const ScanResult& last = outcome.results.back();
  EXPECT_LT(outcome.final_error(recording), 0.05);
  EXPECT_EQ(outcome.count(ScanStatus::kDiverged), 0U);
  EXPECT_NEAR(last.detail("lidar_turned_rad").value(), 2.02 * kDegree, 0.4 * kDegree);
  const ScanResult as_told = play(recording).results.back();
  EXPECT_LT(as_told.detail("lidar_turned_rad").value(), 0.1 * kDegree);
  EXPECT_LT(as_told.detail("lidar_moved_m").value(), 0.004);
}

TEST(ArenaLioRobustness, TheWorldStandsStillAndIsLeveledInTheEndThoughTheAccelerometerIsBiased) {
  const Pose slope = make_pose(so3::exp({0.1, -0.15, 0.0}), {0.0, 0.0, 0.0});
  const Recording recording{
      .motion = [&](double t) { return lively(t) * slope; }, .seconds = 11.0, .repeating = false};
  const auto events = synthetic::with_imu(
      [](ImuSample& sample) {
        sample.accel += Eigen::Vector3d(0.1, -0.05, 0.05);
        return true;
      },
      synthetic::record(recording));
  const Rig rig = synthetic::rig_of(recording);
  ArenaLio odometry(settings_for(rig.lidars.front()), rig.lidars.front(), rig.imus.front(),
                    Parallel(1));
  const Outcome outcome = synthetic::play(events, odometry);
  odometry.finish();
  const auto true_up = [&](const StampedPose& pose) -> Eigen::Vector3d {
    const Pose truth = recording.motion(to_seconds(pose.stamp - recording.epoch));
    return pose.world_from_body.linear() * truth.linear().transpose() * Eigen::Vector3d::UnitZ();
  };
  const auto degrees_between = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b)) / 0.0174533;
  };
  const Eigen::Vector3d first_up = true_up(outcome.results[3].estimate);
  EXPECT_GT(degrees_between(first_up, Eigen::Vector3d::UnitZ()), 0.4)
      << "the bias is taken for gravity";
  for (std::size_t i = 3; i < outcome.results.size(); ++i)
    EXPECT_LT(degrees_between(true_up(outcome.results[i].estimate), first_up), 0.05) << i;
  const ScanResult& last = outcome.results.back();
  EXPECT_LT(degrees_between(last.up->direction, first_up), 0.05);
  EXPECT_GT(last.up->sigma_rad, 0.0);
  EXPECT_LT(last.up->sigma_rad, outcome.results[3].up->sigma_rad);
  const Trajectory leveled = transformed(odometry.leveled_from_world(), odometry.trajectory());
  for (const StampedPose& pose : leveled.poses())
    EXPECT_LT(degrees_between(true_up(pose), Eigen::Vector3d::UnitZ()), 0.05);
}

}  // namespace
}  // namespace lidarena::odometry::arena_lio
