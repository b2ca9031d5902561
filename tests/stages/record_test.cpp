// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/recorder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <thread>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/stages/process_memory.hpp"
#include "tests/listed_sources.hpp"
#include "tests/odometry/synthetic_room.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::stages {
namespace {

namespace synthetic = odometry::synthetic;

class KeepingSink : public LogSink {
 public:
  void message(LogLevel level, std::string_view text) override {
    if (level == LogLevel::kWarning) warnings.emplace_back(text);
  }
  void progress(std::string_view, double done, double total) override {
    last_done = done;
    last_total = total;
  }
  std::vector<std::string> warnings;
  double last_done = 0.0;
  double last_total = -1.0;
};

/// Moves 1 m along x with each scan and publishes two points there.
class Walker : public odometry::Odometry {
 public:
  odometry::OdometryTraits traits() const override {
    return {.revises_past = true, .publishes_scans = publishes};
  }
  void register_imu(const ImuSample&) override { ++imu_samples; }
  odometry::ScanResult track(const Scan& scan) override {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds_per_scan));
    const auto x = static_cast<double>(++scans);
    StampedPose pose{scan.stamp, make_pose(Eigen::Matrix3d::Identity(), {x, 0, 0})};
    odometry::ScanResult result;
    result.estimate = pose;
    if (scans == diverges_at) result.status = odometry::ScanStatus::kDiverged;
    if (scans == not_finite_at)
      result.estimate.world_from_body.translation().y() = std::numeric_limits<double>::quiet_NaN();
    published = {{static_cast<float>(x), 0, 0}, {static_cast<float>(x), 5, 0}};
    poses.push_back(pose);
    return result;
  }
  void finish() override {
    finished = true;
    for (auto& pose : poses) pose.world_from_body.translation().z() = 1.0;  // a late correction
  }
  Trajectory trajectory() const override { return Trajectory(poses); }
  std::vector<Eigen::Vector3f> map() const override { return {{7, 7, 7}}; }
  std::span<const Eigen::Vector3f> registered_scan() const override { return published; }
  odometry::MemoryUse memory() const override {
    return {.map = 100 * static_cast<std::uint64_t>(scans), .backlog = 3};
  }

  bool publishes = true;
  double seconds_per_scan = 0.0;
  int scans = 0, imu_samples = 0, diverges_at = 0, not_finite_at = 0;
  bool finished = false;
  std::vector<Eigen::Vector3f> published;
  std::vector<StampedPose> poses;
};

Event scan_event(const std::string& sensor, int tenth) {
  Scan scan;
  scan.stamp = Time{5} + tenth * from_seconds(0.1);
  Point point;
  point.dt_ns = 90'000'000;
  scan.points = {Point{}, point};
  return {sensor, scan};
}

std::vector<Event> ten_scans() {
  std::vector<Event> events;
  for (int i = 0; i < 10; ++i) events.push_back(scan_event("a", i));
  return events;
}

TEST(Run, KeepsLiveAndFinalPosesTheMapTheStatusesAndTheResources) {
  Walker walker;
  listed::Events source(ten_scans());
  KeepingSink sink;
  const RunResult result = record_run(walker, source, {.scan_count = 10}, sink);
  EXPECT_TRUE(walker.finished);
  ASSERT_EQ(result.files.live.size(), 10U);
  ASSERT_EQ(result.files.trajectory.size(), 10U);
  EXPECT_EQ(result.files.live.poses()[3].world_from_body.translation(), Eigen::Vector3d(4, 0, 0));
  EXPECT_EQ(result.files.trajectory.poses()[3].world_from_body.translation(),
            Eigen::Vector3d(4, 0, 1));
  EXPECT_EQ(result.files.map.points.size(), 20U);
  EXPECT_EQ(result.summary.scans, 10U);
  EXPECT_EQ(result.summary.statuses.at(odometry::ScanStatus::kTracked), 10U);
  EXPECT_FALSE(result.summary.diverged);
  ASSERT_EQ(result.files.resources.size(), 10U);
  const dataset::ResourceRow& row = result.files.resources[4];
  EXPECT_DOUBLE_EQ(row.t_sensor_s, 0.49);
  EXPECT_EQ(row.map_bytes, 500U);
  EXPECT_EQ(row.backlog_bytes, 3U);
  EXPECT_EQ(row.scan_buffer_bytes, 0U);
  EXPECT_GE(row.latency_s, 0.0);
  EXPECT_GT(row.cpu_s, 0.0);
  EXPECT_DOUBLE_EQ(result.summary.sensor_seconds, 0.99);
  double latency = 0.0;
  for (const auto& r : result.files.resources) latency += r.latency_s;
  EXPECT_NEAR(result.summary.compute_seconds, latency, 1e-12);
  EXPECT_EQ(sink.last_done, 10.0);
  EXPECT_EQ(sink.last_total, 10.0);
}

/// A walker that learns in the end that its world leans to the side.
class LeaningWalker final : public Walker {
 public:
  Pose leveled_from_world() const override {
    return make_pose(so3::exp({0.1, 0.0, 0.0}), Eigen::Vector3d::Zero());
  }
};

TEST(Run, TheFinalFilesAreLeveledOnceAndTheLiveOnesAreAsTheyWere) {
  LeaningWalker walker;
  listed::Events source(ten_scans());
  KeepingSink sink;
  const dataset::RunFiles files = record_run(walker, source, {}, sink).files;
  const Pose leveled = walker.leveled_from_world();
  EXPECT_EQ(files.live.poses()[3].world_from_body.translation(), Eigen::Vector3d(4, 0, 0));
  EXPECT_TRUE(files.trajectory.poses()[3].world_from_body.translation().isApprox(
      leveled * Eigen::Vector3d(4, 0, 1)));
  const Eigen::Vector3d side = leveled * Eigen::Vector3d(1, 5, 0);
  EXPECT_TRUE(files.map.points[1].isApprox(side.cast<float>(), 1e-6F));
}

TEST(Run, AMapThatIsWrittenWhileScansComeIsTheOneOfTheMemory) {
  const TemporaryFolder folder;
  KeepingSink sink;
  LeaningWalker walker, again;
  listed::Events source(ten_scans()), source_again(ten_scans());
  const auto in_memory = record_run(walker, source, {}, sink).files.map.points;
  const std::filesystem::path file = folder.path() / "map.ply";
  const auto files = record_run(again, source_again, {}, sink, {.file = file}).files;
  EXPECT_TRUE(files.map.points.empty());
  EXPECT_EQ(dataset::read_cloud(file).points, in_memory);
  EXPECT_EQ(in_memory.size(), 20U);
}

TEST(Run, AMapThatIsNotWantedIsNotKept) {
  Walker walker;
  listed::Events source(ten_scans());
  KeepingSink sink;
  EXPECT_TRUE(record_run(walker, source, {}, sink, {.is_kept = false}).files.map.points.empty());
}

TEST(Run, AMethodThatDoesNotPublishScansIsAskedForItsMap) {
  Walker walker;
  walker.publishes = false;
  listed::Events source(ten_scans());
  LogSink sink;
  EXPECT_EQ(record_run(walker, source, {}, sink).files.map.points,
            (std::vector<Eigen::Vector3f>{{7, 7, 7}}));
}

TEST(Run, TheMapKeepsTheFirstPointOfAVoxel) {
  Walker walker;
  listed::Events source(ten_scans());
  LogSink sink;
  const RunResult result = record_run(walker, source, {}, sink, {.voxel_size_m = 4.0});
  // x from 1 to 10 is in the cells 0 to 3, 4 to 7 and 8 to 11, at y = 0 and y = 5
  EXPECT_EQ(result.files.map.points,
            (std::vector<Eigen::Vector3f>{
                {1, 0, 0}, {1, 5, 0}, {4, 0, 0}, {4, 5, 0}, {8, 0, 0}, {8, 5, 0}}));
}

TEST(Run, StopsWhereTheMethodDivergesAndKeepsWhatCameBefore) {
  for (const bool says_so : {true, false}) {
    Walker walker;
    (says_so ? walker.diverges_at : walker.not_finite_at) = 4;
    listed::Events source(ten_scans());
    KeepingSink sink;
    const RunResult result = record_run(walker, source, {}, sink);
    EXPECT_EQ(walker.scans, 4) << "no scans are fed after divergence";
    EXPECT_TRUE(result.summary.diverged);
    EXPECT_THAT(result.summary.reason, testing::HasSubstr("scan 3"));
    EXPECT_EQ(result.summary.scans, 4U);
    EXPECT_EQ(result.files.live.size(), 3U);
    EXPECT_EQ(result.files.trajectory.size(), 3U);
    EXPECT_EQ(result.files.resources.size(), 4U);
    EXPECT_EQ(result.files.map.points.size(), 6U);
    EXPECT_EQ(sink.warnings.size(), 1U);
    ASSERT_TRUE(result.files.events && result.files.events->size() == 1U);
    const dataset::RunEvent& event = result.files.events->front();
    EXPECT_EQ(event.kind, dataset::RunEventKind::kDiverged);
    EXPECT_DOUBLE_EQ(event.t_sensor_s, 0.39) << "the end of scan 3, as in resources.csv";
    EXPECT_EQ(event.value, 3.0);
  }
}

TEST(Run, OtherSensorsAreLeftOutAndTheFirstImuIsTaken) {
  std::vector<Event> events;
  for (int i = 0; i < 5; ++i) {
    events.push_back({"imu1", ImuSample{}});
    events.push_back({"imu2", ImuSample{}});
    events.push_back({"imu2", ImuSample{}});
    events.push_back(scan_event("b", i));
    events.push_back(scan_event("a", i));
  }
  LogSink sink;
  Walker first;
  listed::Events again(events);
  EXPECT_EQ(record_run(first, again, {.lidar_id = "a"}, sink).summary.scans, 5U);
  EXPECT_EQ(first.imu_samples, 5);
  Walker named;
  listed::Events once_more(events);
  record_run(named, once_more, {.lidar_id = "a", .imu_id = "imu2"}, sink);
  EXPECT_EQ(named.imu_samples, 10);
}

TEST(Run, ScansOutOfOrderAreSkippedWithAWarning) {
  std::vector<Event> events = ten_scans();
  events.insert(events.begin() + 5, events[2]);
  events.insert(events.begin() + 5, events[4]);
  Walker walker;
  listed::Events source(events);
  KeepingSink sink;
  EXPECT_EQ(record_run(walker, source, {}, sink).summary.scans, 10U);
  EXPECT_EQ(sink.warnings.size(), 2U);
}

TEST(Run, APacedMethodThatIsLateLosesScansButNoImuSample) {
  std::vector<Event> events;
  for (int i = 0; i < 20; ++i) {
    events.push_back({"imu", ImuSample{}});
    Scan scan;
    scan.stamp = i * std::chrono::milliseconds(1);
    events.push_back({"a", scan});
  }
  LogSink sink;
  Walker late;
  late.seconds_per_scan = 5e-3;  // five scans arrive in that time
  listed::Events source(events);
  const RunResult result = record_run(late, source, {.paced = true}, sink);
  EXPECT_GE(result.summary.dropped, 12U);  // four each time
  EXPECT_EQ(result.summary.scans + result.summary.dropped, 20U);
  EXPECT_EQ(late.scans, static_cast<int>(result.summary.scans));
  EXPECT_EQ(late.imu_samples, 20);
  EXPECT_GE(result.summary.longest_delay_s, 5e-3);

  Walker unhurried;
  unhurried.seconds_per_scan = 5e-3;
  listed::Events again(events);
  EXPECT_EQ(record_run(unhurried, again, {}, sink).summary.scans, 20U);
}

TEST(Run, NothingGivesNothing) {
  Walker walker;
  listed::Events source;
  LogSink sink;
  const RunResult result = record_run(walker, source, {}, sink);
  EXPECT_EQ(result.summary.scans, 0U);
  EXPECT_TRUE(result.files.trajectory.empty());
}

TEST(Run, KissIcpIsDrivenFromARecording) {
  const synthetic::Recording recording{.seconds = 2.0};
  listed::Events source(synthetic::record(recording));
  LogSink sink;
  auto made = odometry::make_odometry({.algorithm = "kiss_icp"}, synthetic::rig_of(recording), "",
                                      Parallel(1));
  const RunResult result = record_run(*made.odometry, source, {.lidar_id = "lidar"}, sink);
  EXPECT_EQ(result.summary.scans, 20U);
  EXPECT_EQ(result.summary.statuses.at(odometry::ScanStatus::kInitializing), 1U);
  EXPECT_EQ(result.summary.statuses.at(odometry::ScanStatus::kTracked), 19U);
  EXPECT_GT(result.files.map.points.size(), 50000U);
  EXPECT_GT(result.summary.compute_seconds, 0.0);
}

TEST(ProcessMemory, GrowsWithWhatIsAllocatedAndTouched) {
  const std::uint64_t before = resident_bytes();
  ASSERT_GT(before, 1U << 20U);
  const std::vector<char> ballast(64U << 20U, 'x');
  EXPECT_NEAR(static_cast<double>(resident_bytes() - before), static_cast<double>(ballast.size()),
              4e6);
  const auto share = proportional_bytes();
  if (!share) GTEST_SKIP() << "skipped: this system has no /proc/self/smaps_rollup";
  EXPECT_LE(*share, resident_bytes() + (4U << 20U));
  EXPECT_GT(*share, ballast.size());
}

}  // namespace
}  // namespace lidarena::stages
