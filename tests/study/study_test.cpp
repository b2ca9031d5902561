// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <set>
#include <thread>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/dataset/run_files.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "lidarena/stages/process.hpp"
#include "lidarena/stages/score_run.hpp"
#include "lidarena/stages/simulate_dataset.hpp"
#include "lidarena/study/plan.hpp"
#include "lidarena/study/program.hpp"
#include "tests/study/configs.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::study {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Runs a line of shell script as a process.
stages::ProcessEnd run_shell(const std::string& line, const stages::ProcessLimits& limits = {},
                             const std::filesystem::path& log = {}) {
  stages::Command command;
  command.arguments = {"/bin/sh", "-c", line};
  command.log = log;
  return stages::Process(command, limits).wait();
}

TEST(Process, OneThatSucceedsLeavesNoReasonAndTellsWhatItUsed) {
  const stages::ProcessEnd end = run_shell("i=0; while [ $i -lt 100000 ]; do i=$((i+1)); done");
  EXPECT_EQ(end.exit_code, 0);
  EXPECT_EQ(end.reason, "");
  EXPECT_GT(end.processor_s, 0.0);
  EXPECT_GT(end.peak_mb, 0.1);
}

TEST(Process, TheLastLineOfItsLogIsTheReasonOfItsFailure) {
  const TemporaryFolder scratch;
  const auto log = scratch.path() / "log";
  const stages::ProcessEnd end =
      run_shell("echo begin >&2; echo 'lidarena: file: is broken' >&2; exit 2", {}, log);
  EXPECT_EQ(end.exit_code, 2);
  EXPECT_EQ(end.reason, "file: is broken");
  EXPECT_EQ(dataset::read_bytes(log), "begin\nlidarena: file: is broken\n");
  EXPECT_THAT(run_shell("exit 7").reason, HasSubstr("exit code 7"));
  const stages::ProcessEnd killed = run_shell("kill -9 $$");
  EXPECT_EQ(killed.exit_code, -1);
  EXPECT_THAT(killed.reason, AllOf(HasSubstr("signal 9"), HasSubstr("out of memory")));
  stages::Command missing;
  missing.arguments = {"/no/such/program"};
  EXPECT_EQ(stages::Process(missing).wait().exit_code, 127);
}

TEST(Process, OneBeyondItsTimeIsStoppedWithAReason) {
  const auto begin = std::chrono::steady_clock::now();
  const stages::ProcessEnd late = run_shell("while :; do :; done", {.seconds = 0.3});
  EXPECT_EQ(late.exit_code, -1);
  EXPECT_THAT(late.reason, HasSubstr("not finished within its time limit"));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
}

TEST(Process, OneThatSleepsStallsAndOneThatComputesDoesNot) {
  EXPECT_THAT(run_shell("sleep 300", {.stall_seconds = 0.5}).reason, HasSubstr("stalled"));
  const std::string busy = "end=$(($(date +%s)+3)); while [ $(date +%s) -lt $end ]; do :; done";
  EXPECT_EQ(run_shell(busy, {.stall_seconds = 1.0}).reason, "");
}

TEST(Process, OneThatTakesTooMuchMemoryIsStopped) {
  const stages::ProcessEnd end =
      run_shell("x=$(head -c 300000000 /dev/zero | tr '\\0' x); sleep 60", {.memory_mb = 200.0});
  EXPECT_THAT(end.reason, HasSubstr("more than its limit of 200 MB"));
}

TEST(Process, UsesOnlyTheCoresItIsGiven) {
  const TemporaryFolder scratch;
  stages::Command command;
  command.arguments = {"/bin/sh", "-c", "grep Cpus_allowed_list /proc/self/status"};
  command.output = scratch.path() / "out";
  const int last = stages::usable_cores().back();
  command.cores = {last};
  EXPECT_EQ(stages::Process(command).wait().exit_code, 0);
  EXPECT_EQ(dataset::read_bytes(command.output),
            "Cpus_allowed_list:\t" + std::to_string(last) + "\n");
}

/// Whether a process still runs (a zombie, not yet waited for, does not).
bool runs(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string line;
  if (!std::getline(file, line)) return false;
  const char state = line[line.rfind(')') + 2];
  return state != 'Z' && state != 'X';
}

bool ends_soon(pid_t pid) {
  for (int i = 0; i < 500 && runs(pid); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return !runs(pid);
}

/// The process id that a process writes to a file, once it has.
pid_t id_in(const std::filesystem::path& file) {
  pid_t id = 0;
  for (int i = 0; i < 500 && id == 0; ++i) {
    std::ifstream(file) >> id;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return id;
}

TEST(Process, NothingOutlivesTheProcessThatStartedIt) {
  const TemporaryFolder scratch;
  const std::string file = (scratch.path() / "id").string();
  const pid_t parent = fork();
  if (parent == 0) {
    run_shell("echo $$ > " + file + "; exec sleep 300");
    _exit(0);
  }
  const pid_t child = id_in(file);
  ASSERT_GT(child, 0);
  EXPECT_TRUE(runs(child));
  kill(parent, SIGKILL);
  EXPECT_TRUE(ends_soon(child));
  waitpid(parent, nullptr, 0);
}

TEST(Process, WhatItLeavesRunningEndsWithIt) {
  const TemporaryFolder scratch;
  const std::string file = (scratch.path() / "id").string();
  EXPECT_EQ(run_shell("sleep 300 & echo $! > " + file).exit_code, 0);
  const pid_t left = id_in(file);
  ASSERT_GT(left, 0);
  EXPECT_TRUE(ends_soon(left));
}

StudyOptions with_program() {
  StudyOptions options;
  options.program = LIDARENA_BINARY;
  return options;
}

StudySpec tiny_spec() {
  StudySpec spec;
  spec.scenes = {{"house", "house", 0.5}};
  spec.sensors = {"livox_mid360"};
  spec.algorithms = {"kiss_icp"};
  return spec;
}

TEST(RunStudy, AnotherOneInTheSameFolderIsRefusedUntilTheFirstHasEnded) {
  const TemporaryFolder scratch;
  LogSink log;
  // The other study holds its unit while its external program sleeps.
  StudySpec waiting = tiny_spec();
  const std::string started = (scratch.path() / "started").string();
  waiting.external = {
      {.name = "theirs", .command = "sh -c 'touch " + started + "; exec sleep 300'"}};
  waiting.algorithms = {"theirs"};
  const pid_t other = fork();
  if (other == 0) {
    run_study(waiting, configs(), scratch.path() / "study", with_program(), log);
    _exit(0);
  }
  for (int i = 0; i < 6000 && !std::filesystem::exists(started); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ASSERT_TRUE(std::filesystem::exists(started));
  EXPECT_THROW(run_study(tiny_spec(), configs(), scratch.path() / "study", with_program(), log),
               InputError);
  kill(other, SIGKILL);
  waitpid(other, nullptr, 0);
  // Its work ended with it; the incomplete run is not reused.
  const StudyOutcome outcome =
      run_study(tiny_spec(), configs(), scratch.path() / "study", with_program(), log);
  EXPECT_EQ(outcome.runs, 1U);
  EXPECT_EQ(outcome.failed, 0U);
}

TEST(RunStudy, WithoutTheProgramItSaysHowToGiveIt) {
  const TemporaryFolder scratch;
  LogSink log;
  StudyOptions options;
  options.program = scratch.path() / "lidarena";
  EXPECT_THROW(run_study(tiny_spec(), configs(), scratch.path() / "out", options, log), InputError);
  options.program = "/bin/true";
  try {
    run_study(tiny_spec(), configs(), scratch.path() / "out", options, log);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("does not answer to --version --json"));
  }
}

TEST(RunStudy, AFlightThatFailsAfterItsManifestIsNotTakenForWhole) {
  const TemporaryFolder scratch;
  LogSink log;
  const std::filesystem::path program = scratch.path() / "lidarena";
  std::ofstream(program) << "#!/bin/sh\n" LIDARENA_BINARY " \"$@\" && [ \"$1\" != simulate ]\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  StudyOptions options;
  options.program = program;
  const StudyOutcome outcome =
      run_study(tiny_spec(), configs(), scratch.path() / "out", options, log);
  EXPECT_EQ(outcome.failed, outcome.runs);
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path() / "out/datasets"));
}

/// Keeps the warnings.
class WarningList : public LogSink {
 public:
  void message(LogLevel level, std::string_view text) override {
    if (level == LogLevel::kWarning) texts.emplace_back(text);
  }
  std::vector<std::string> texts;
};

TEST(RunStudy, AWarningThatDiffersInFiguresAloneIsShownOnceAndCounted) {
  const TemporaryFolder scratch;
  const std::filesystem::path program = scratch.path() / "lidarena";
  std::ofstream(program) << "#!/bin/sh\n[ \"$1\" = evaluate ] && echo \"warning: $$.5 cm too far\" "
                            ">&2\n" LIDARENA_BINARY " \"$@\"\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  StudyOptions options;
  options.program = program;
  StudySpec spec = tiny_spec();
  spec.seeds = {1, 2, 3};
  WarningList log;
  EXPECT_EQ(run_study(spec, configs(), scratch.path() / "out", options, log).runs, 3U);
  std::vector<std::string> ours;
  std::ranges::copy_if(log.texts, std::back_inserter(ours),
                       [](const std::string& text) { return text.ends_with(".5 cm too far"); });
  ASSERT_EQ(ours.size(), 2U);
  EXPECT_THAT(ours[0], HasSubstr("house-house-s1"));
  EXPECT_THAT(ours[1], HasSubstr("2 more runs, with their own figures: "));
}

TEST(ProgramCode, OfAProgramThatWasKilledSaysSo) {
  const TemporaryFolder scratch;
  const std::filesystem::path program = scratch.path() / "lidarena";
  std::ofstream(program) << "#!/bin/sh\nkill -9 $$\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  try {
    ProgramCode::ask(program);
    FAIL();
  } catch (const InputError& error) {
    FAIL() << "blames the program: " << error.what();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("killed by signal 9"));
  }
}

/// All files below a folder that do not tell times, with their content.
std::map<std::string, std::string> results_in(const std::filesystem::path& folder) {
  const std::set<std::string> timed{"resources.csv", "resources.json", "manifest.json",
                                    "lidarena.log", "request.json"};
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || timed.contains(entry.path().filename())) continue;
    files[entry.path().lexically_relative(folder)] = dataset::read_bytes(entry.path());
  }
  return files;
}

TEST(RunStudy, ADatasetIsSimulatedOnceForItsRunsAndTheResultsAreThoseOfSimulatingItForEach) {
  const TemporaryFolder scratch;
  LogSink log;
  StudySpec spec = tiny_spec();
  spec.sensors = {"livox_mid360", "ouster_os0_128"};
  StudyOptions options = with_program();
  EXPECT_EQ(run_study(spec, configs(), scratch.path() / "kept", options, log).failed, 0U);
  options.scratch_bytes = 0;
  EXPECT_EQ(run_study(spec, configs(), scratch.path() / "anew", options, log).failed, 0U);
  const auto kept = results_in(scratch.path() / "kept/runs");
  EXPECT_EQ(kept.size(), 2U * 8U);
  EXPECT_EQ(kept, results_in(scratch.path() / "anew/runs"));
  const auto dataset = scratch.path() / "kept/datasets/house-house-s1";
  EXPECT_FALSE(std::filesystem::exists(dataset / "data.mcap")) << "no run needs it any more";
  for (const char* picture : {"livox_mid360_scan.ply", "livox_mid360_scan_skewed.ply"}) {
    const dataset::Cloud scan = dataset::read_cloud(dataset / picture);
    ASSERT_GT(scan.points.size(), 10'000U) << picture;
    EXPECT_LT(std::accumulate(scan.distance.begin(), scan.distance.end(), 0.0F),
              0.05F * static_cast<float>(scan.points.size()))
        << picture << ": range noise of 2 cm, and almost no motion at the start";
  }
}

TEST(RunStudy, ARunScoredAgainLaterHasTheSameMetrics) {
  const TemporaryFolder scratch;
  LogSink log;
  ASSERT_EQ(run_study(tiny_spec(), configs(), scratch.path(), with_program(), log).failed, 0U);
  const auto run = std::filesystem::directory_iterator(scratch.path() / "runs")->path();
  const Json metrics = dataset::read_json(run / "metrics.json");
  EXPECT_FALSE(metrics.contains("resources")) << "resources differ between repeated runs";
  ASSERT_TRUE(metrics.at("maps").at("reprojected").at("first_pose").at("identity").is_object());
  // again, without the hits, which are gone: by the rays of the map's points
  EXPECT_FALSE(stages::score_run(run, {}, Parallel(1), log).resources.empty());
  const Json again = dataset::read_json(run / "metrics.json");
  EXPECT_EQ(again.at("final"), metrics.at("final"));
  const Json &map = metrics.at("maps").at("reprojected").at("first_pose"),
             &map_again = again.at("maps").at("reprojected").at("first_pose");
  EXPECT_EQ(map_again.at("histogram"), map.at("histogram"));
  EXPECT_TRUE(map_again.at("completeness").is_object());
  EXPECT_FALSE(stages::score_run(run, {stages::ScorePart::kTrajectory}, Parallel(1), log)
                   .maps.reprojected.has_value());
}

TEST(RunStudy, WhereMapsAreNotKeptTheFiguresAreTheSame) {
  const TemporaryFolder scratch;
  LogSink log;
  StudySpec spec = tiny_spec();
  const auto metrics_of = [&](const char* study) {
    const std::filesystem::path out = scratch.path() / study;
    EXPECT_EQ(run_study(spec, configs(), out, with_program(), log).failed, 0U);
    return dataset::read_json(out /
                              "runs/house-house-s1-livox_mid360-kiss_icp-indoor/metrics.json");
  };
  const Json kept = metrics_of("kept");
  spec.keep_maps = false;
  EXPECT_EQ(metrics_of("not_kept"), kept);
  const std::filesystem::path run =
      scratch.path() / "not_kept/runs/house-house-s1-livox_mid360-kiss_icp-indoor";
  for (const auto& entry : std::filesystem::directory_iterator(run)) {
    EXPECT_NE(entry.path().extension(), ".ply") << entry.path();
  }
  EXPECT_THROW(dataset::read_run(run), InputError);
  EXPECT_EQ(run_study(spec, configs(), scratch.path() / "not_kept", with_program(), log).reused,
            1U);
  spec.keep_maps = true;
  EXPECT_EQ(run_study(spec, configs(), scratch.path() / "not_kept", with_program(), log).reused, 0U)
      << "the maps were deleted, so the run must be repeated";
}

TEST(RunStudy, AnExternalProgramIsScoredLikeOursAndItsFailureIsARow) {
  const TemporaryFolder scratch;
  LogSink log;
  // Three programs: one writes constant poses, one writes nothing, one fails.
  const auto poses_at = [](const std::string& stamps, const std::string& file) {
    return " && for t in " + stamps + "; do echo $t 0 0 0 0 0 0 1; done > " + file;
  };
  const std::string still = "cd {output}" + poses_at("0.0 0.1 0.2 0.3 0.4", "trajectory.tum");
  const std::string fine = still + poses_at("0.00 0.05 0.10 0.40", "motion.tum");
  StudySpec spec = tiny_spec();
  spec.external = {{.name = "still", .command = still},
                   {.name = "fine", .command = fine},
                   {.name = "silent", .command = "true {input}"},
                   {.name = "broken", .command = "sh -c 'echo no such luck; exit 3'"}};
  spec.algorithms = {"still", "fine", "silent", "broken"};
  StudyOptions two_jobs = with_program();
  two_jobs.jobs = 2;
  const StudyOutcome outcome = run_study(spec, configs(), scratch.path(), two_jobs, log);
  EXPECT_EQ(outcome.runs, 4U);
  EXPECT_EQ(outcome.failed, 2U);
  const auto run = [&](const std::string& name) {
    return scratch.path() / "runs" / ("house-house-s1-livox_mid360-" + name + "-external");
  };
  const Json metrics = dataset::read_json(run("still") / "metrics.json");
  EXPECT_EQ(metrics.at("status"), "ok");
  EXPECT_TRUE(metrics.at("/maps/interpolation_floor/rmse_m"_json_pointer).is_number());
  const Json told = dataset::read_json(run("fine") / "metrics.json");
  EXPECT_TRUE(told.at("/maps/interpolation_floor"_json_pointer).is_null());
  EXPECT_EQ(dataset::read_run(run("fine")).motion.size(), 4U);
  EXPECT_FALSE(std::filesystem::exists(run("still") / "input")) << "the recording must be deleted";
  const Json silent = dataset::read_json(run("silent") / "manifest.json");
  EXPECT_THAT(silent.at("reason").get<std::string>(), HasSubstr("left no trajectory.tum"));
  const Json broken = dataset::read_json(run("broken") / "manifest.json");
  EXPECT_THAT(broken.at("reason").get<std::string>(), HasSubstr("exit code 3"));
  EXPECT_EQ(dataset::read_bytes(run("broken") / "program.log"), "no such luck\n");
  const StudyOutcome again = run_study(spec, configs(), scratch.path(), with_program(), log);
  EXPECT_EQ(again.reused, 2U) << "failed runs must be tried again";
}

}  // namespace
}  // namespace lidarena::study
