// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/run_files.hpp"

#include <gmock/gmock.h>

#include "tests/dataset/file_helpers.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

using testing::AllOf;
using testing::HasSubstr;

RunFiles small_run() {
  RunFiles run;
  const Pose pose = make_pose(Eigen::Matrix3d::Identity(), Eigen::Vector3d(1, 2, 3));
  run.trajectory = Trajectory(
      {{Time{1690309709285305601}, Pose::Identity()}, {Time{1690309709385305601}, pose}});
  run.live = Trajectory({{Time{1690309709285305601}, pose}});
  run.motion = Trajectory({{Time{1690309709285305601}, Pose::Identity()},
                           {Time{1690309709335305601}, Pose::Identity()},
                           {Time{1690309709385305601}, pose}});
  run.map.points = {{1, 2, 3}, {4, 5, 6}};
  run.reprojected.points = {{7, 8, 9}};
  run.reprojected.intensity = {0.5F};
  run.resources = {{0.1, 0.012345678, 0.03, 1'000'000'000'000, 2, 3, 4, 5},
                   {0.2, 0.01, 0.01, 1, 2, 3, 4, 5}};
  run.events = {{-0.005, 0.25, RunEventKind::kFastTurn, 83.25}, {0.1, 0.0, RunEventKind::kLoop, 1}};
  run.manifest.algorithm = "kiss_icp";
  run.manifest.body_from_lidar = pose;
  run.manifest.summary.statuses["tracked"] = 7;
  return run;
}

class Run : public testing::Test {
 protected:
  Run() { write_run(path(), small_run()); }
  std::filesystem::path path() const { return folder_.path() / "deep" / "run"; }
  TemporaryFolder folder_;
};

TEST_F(Run, ComesBackAsItWasWritten) {
  const RunFiles run = small_run();
  const RunFiles back = read_run(path());
  EXPECT_EQ(to_json(back.manifest), to_json(run.manifest));
  ASSERT_EQ(back.trajectory.size(), 2U);
  EXPECT_EQ(back.trajectory.end_time(), run.trajectory.end_time());
  EXPECT_EQ(back.trajectory.poses()[1].world_from_body.matrix(),
            run.trajectory.poses()[1].world_from_body.matrix());
  EXPECT_EQ(back.live.size(), 1U);
  ASSERT_EQ(back.motion.size(), 3U);
  EXPECT_EQ(back.motion.poses()[1].stamp, run.motion.poses()[1].stamp);
  EXPECT_EQ(back.map.points, run.map.points);
  EXPECT_TRUE(back.map.intensity.empty());
  EXPECT_EQ(back.reprojected.points, run.reprojected.points);
  EXPECT_EQ(back.reprojected.intensity, run.reprojected.intensity);
  ASSERT_EQ(back.resources.size(), 2U);
  EXPECT_EQ(back.resources[0].t_sensor_s, 0.1);
  EXPECT_EQ(back.resources[0].latency_s, 0.012345678);
  EXPECT_EQ(back.resources[0].rss_bytes, 1'000'000'000'000U);
  EXPECT_EQ(back.resources[1].backlog_bytes, 5U);
  ASSERT_TRUE(back.events.has_value());
  ASSERT_EQ(back.events->size(), 2U);
  EXPECT_EQ(back.events->at(0).t_sensor_s, -0.005);
  EXPECT_EQ(back.events->at(0).duration_s, 0.25);
  EXPECT_EQ(back.events->at(0).kind, RunEventKind::kFastTurn);
  EXPECT_EQ(back.events->at(0).value, 83.25);
  EXPECT_EQ(back.events->at(1).kind, RunEventKind::kLoop);
}

TEST_F(Run, TrajectoriesNameTheirFramesAndInstant) {
  EXPECT_THAT(file_text(path() / "trajectory.tum"), HasSubstr("world_from_body"));
  EXPECT_THAT(file_text(path() / "live.tum"), HasSubstr("as known at each scan"));
  EXPECT_THAT(file_text(path() / "live.tum"), HasSubstr("at the stamped instant"));
  EXPECT_THAT(file_text(path() / "resources.csv"),
              testing::StartsWith("t_sensor_s,latency_s,cpu_s,rss_bytes"));
}

TEST_F(Run, AMotionAndEventsOfAnEarlierRunDoNotStay) {
  RunFiles run = small_run();
  run.motion = {};
  run.events = {};
  write_run(path(), run);
  EXPECT_TRUE(read_run(path()).motion.empty());
  EXPECT_FALSE(read_run(path()).events.has_value());
}

TEST(RunEvents, EveryKindHasANameOfItsOwnAtItsPlace) {
  for (std::size_t i = 0; i < kRunEvents.size(); ++i) {
    EXPECT_EQ(static_cast<std::size_t>(kRunEvents[i].kind), i);
    for (std::size_t j = 0; j < i; ++j) EXPECT_STRNE(kRunEvents[i].name, kRunEvents[j].name);
  }
}

TEST_F(Run, ThatGaveNoPoseIsStillARun) {
  RunFiles run = small_run();
  run.trajectory = {};
  run.live = {};
  run.map = {};
  run.resources.clear();
  write_run(path(), run);
  const RunFiles back = read_run(path());
  EXPECT_TRUE(back.trajectory.empty());
  EXPECT_TRUE(back.map.points.empty());
  EXPECT_TRUE(back.resources.empty());
}

TEST_F(Run, WithoutAManifestIsNotFinished) {
  std::filesystem::remove(path() / "manifest.json");
  EXPECT_THAT(input_error([&] { read_run(path()); }), HasSubstr("it has no manifest.json"));
}

TEST_F(Run, WrittenAnewLeavesNoMetricsOfTheOldOne) {
  write_file(path() / "metrics.json", "{}");
  write_run(path(), small_run());
  EXPECT_FALSE(exists(path() / "metrics.json"));
}

TEST_F(Run, ThatCannotBeWrittenLeavesNoManifest) {
  std::filesystem::remove(path() / "map.ply");
  std::filesystem::create_directories(path() / "map.ply/full");  // cannot be replaced by a file
  EXPECT_THROW(write_run(path(), small_run()), Error);
  EXPECT_FALSE(exists(path() / "manifest.json"));
}

TEST_F(Run, BrokenFilesAreNamed) {
  const auto error_with = [&](const char* name, std::string_view text) {
    const std::string whole = file_text(path() / name);
    write_file(path() / name, text);
    const std::string error = input_error([&] { read_run(path()); });
    write_file(path() / name, whole);
    return error;
  };
  EXPECT_THAT(error_with("resources.csv", "t,latency\n"), HasSubstr("resources.csv:1: is not the"));
  const std::string header = file_text(path() / "resources.csv").substr(0, 90);
  EXPECT_THAT(error_with("resources.csv", header + "1,2\n"), HasSubstr("resources.csv:2: holds 2"));
  EXPECT_THAT(error_with("resources.csv", header + "1,2,3,-3,4,5,6,7\n"),
              HasSubstr("resources.csv:2: '-3' is not a number of bytes"));
  EXPECT_THAT(error_with("events.csv", "stamp,kind\n"), HasSubstr("events.csv:1: is not the"));
  const std::string events = "t_sensor_s,duration_s,kind,value\n";
  EXPECT_THAT(error_with("events.csv", events + "1,0,loop\n"), HasSubstr("events.csv:2: holds 3"));
  EXPECT_THAT(error_with("events.csv", events + "1,0,lop,1\n"),
              AllOf(HasSubstr("events.csv:2: 'lop' is not a kind"), HasSubstr("few_points")));
  EXPECT_THAT(error_with("events.csv", events + "1,-1,loop,1\n"),
              HasSubstr("events.csv:2: '-1' is a negative"));
  EXPECT_THAT(error_with("events.csv", events + "nan,0,loop,1\n"), HasSubstr("events.csv:2: "));
  EXPECT_THAT(error_with("trajectory.tum", "1 2 3\n"), HasSubstr("trajectory.tum:1: holds 3"));
  EXPECT_THAT(error_with("map.ply", "ply\n"), HasSubstr("map.ply: ends after line 1"));
  EXPECT_THAT(error_with("manifest.json", "{\"a\": "), HasSubstr("manifest.json: byte"));
}

}  // namespace
}  // namespace lidarena::dataset
