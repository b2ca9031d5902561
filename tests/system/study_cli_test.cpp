// SPDX-License-Identifier: BSD-3-Clause
// Studies by the command-line program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/system/command_line.hpp"

namespace lidarena::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(Cli, AStudyIsResumedAndARunThatWasNotFlownIsARow) {
  write("room.obj", room_obj());
  const std::string flight = write("flight.yaml", kRoomFlight);
  const std::string through = write(
      "through.yaml", "kind: waypoints\nwaypoints: [[2, 2, 1.5], [14, 2, 1.5], [2, 2, 1.5]]\n");
  const std::string study = write(
      "study.yaml", "title: A study of a test\nscenes:\n  - {world: " + path("room.obj") +
                        ", flight: " + flight + ", seconds: 3}\n  - {world: " + path("room.obj") +
                        ", flight: " + through +
                        ", seconds: 3}\nsensors: [livox_mid360]\nalgorithms: [kiss_icp]\n");
  const Outcome first = call("study --json " + study + " --out " + path("study_out"));
  ASSERT_EQ(first.exit_code, 0) << "a cell that was not flown is a result\n" << first.err;
  const auto counts = nlohmann::json::parse(first.out);
  EXPECT_EQ(counts.at("runs"), 2);
  EXPECT_EQ(counts.at("failed"), 1);
  EXPECT_EQ(counts.at("reused"), 0);
  const std::string csv = content(path("study_out") + "/results.csv");
  EXPECT_THAT(csv, AllOf(HasSubstr(",ok,"), HasSubstr(",not flown,")));
  if (LIDARENA_TEST_VIEWER) {
    EXPECT_THAT(content(path("study_out") + "/report.html"), HasSubstr("A study of a test"));
  }
  const Outcome second = call("study --json " + study + " --out " + path("study_out"));
  EXPECT_EQ(nlohmann::json::parse(second.out).at("reused"), 1);
  EXPECT_EQ(content(path("study_out") + "/results.csv"), csv)
      << "the reused run must not be measured again";
}

TEST_F(Cli, TheCommandsThatAReportShowsMakeDatasetAndRunAgain) {
  const std::string study =
      write("study.yaml",
            "scenes: [{world: house, flight: house_aggressive, seconds: 1}]\nnew_scenes: true\n"
            "seeds: [5]\nmodes: [frozen]\nsensors: [ouster_os0_32, livox_mid360_paper]\n"
            "algorithms: [arena_lo, 'fast_lio2:published']\n");
  const Outcome made = call("study " + study + " --out study");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto report = nlohmann::json::parse(content(path("study") + "/report.json"));
  const auto& run = report.at("runs").back();
  std::string command = run.at("command");
  EXPECT_THAT(command, HasSubstr("--sensor livox_mid360_paper --seed 5 --new-scene"));
  for (std::size_t at = 0; (at = command.find("lidarena ", at)) != std::string::npos;) {
    command.replace(at, 9, std::string(LIDARENA_BINARY) + " ");
    at += std::string(LIDARENA_BINARY).size();
  }
  ASSERT_EQ(
      std::system(("cd " + folder_.path().string() + " && " + command + " >out 2>err").c_str()), 0)
      << command << "\n"
      << content(path("err"));
  const std::string dataset = path("study") + "/datasets/" + run.at("dataset").get<std::string>();
  for (const char* file : {"world.ply", "truth.tum", "flight.yaml"})
    EXPECT_TRUE(same(path("data") + "/" + file, dataset + "/" + file)) << file;
  const auto manifest = [](const std::string& folder) {
    return nlohmann::json::parse(content(folder + "/manifest.json"));
  };
  for (const char* key : {"rig", "simulation"})  // the study's also counts its measurements
    EXPECT_EQ(manifest(path("data")).at(key), manifest(dataset).at(key)) << key;
  const std::string folder = path("study") + "/" + run.at("folder").get<std::string>();
  for (const char* file : {"trajectory.tum", "map.ply", "events.csv", "metrics.json"})
    EXPECT_TRUE(same(path("run") + "/" + file, folder + "/" + file)) << file;

  const Outcome alone = call("report run");
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  const auto again = nlohmann::json::parse(content(path("run") + "/report.json"));
  EXPECT_EQ(again.at("runs").at(0).at("command"), run.at("command"));
}

/// A study of two short flights, each with two algorithms; returns its name.
std::string write_small_study(const TemporaryFolder& folder) {
  folder.write("room.obj", room_obj());
  folder.write("flight.yaml", kRoomFlight);
  return folder
      .write("study.yaml",
             "title: Shared\nscenes: [{world: room.obj, flight: flight.yaml, seconds: 1}]\n"
             "seeds: [1, 2]\nsensors: [livox_mid360]\nalgorithms: [kiss_icp, arena_lo]\n")
      .string();
}

TEST_F(Cli, APlannedStudyIsDoneByWorkersAndItsStatusAndReportTellWhatIsMissing) {
  const std::string study = write_small_study(folder_);
  const Outcome printed =
      call("study " + study + " --out plan --slurm --print --partition long --time 2:00:00");
  ASSERT_EQ(printed.exit_code, 0) << printed.err;
  EXPECT_THAT(printed.out, AllOf(HasSubstr("#SBATCH --array=1-2"), HasSubstr("--time=2:00:00"),
                                 HasSubstr("--partition=long")));
  const auto status = [&] { return nlohmann::json::parse(call("status --json plan").out); };
  EXPECT_EQ(status().at("missing"), 4);
  const Outcome report = call("report plan");
  EXPECT_EQ(report.exit_code, 1) << "runs are missing";
  EXPECT_THAT(report.out, HasSubstr("missing: the run has no results yet"));

  const Outcome worker = call("study --worker --out plan --json --scratch scratch");
  ASSERT_EQ(worker.exit_code, 0) << worker.err;
  EXPECT_EQ(nlohmann::json::parse(worker.out).at("runs"), 4);
  EXPECT_EQ(status().at("done"), 4);
  EXPECT_EQ(status().at("missing"), 0);
  EXPECT_THAT(call("status plan --watch").out, HasSubstr("4 runs, 100 %"));
  EXPECT_EQ(call("report plan").exit_code, 0);
}

TEST_F(Cli, ShardsInFoldersOfTheirOwnMakeOneReport) {
  const std::string study = write_small_study(folder_);
  for (const std::string part : {"1", "2"}) {
    const Outcome shard = call("study " + study + " --shard " + part + "/2 --out part" + part);
    ASSERT_EQ(shard.exit_code, 0) << shard.err;
    EXPECT_FALSE(fs::exists(path("part" + part) + "/report.html")) << "one report is of all parts";
  }
  EXPECT_EQ(call("report part1").exit_code, 1) << "the other part is missing";
  EXPECT_EQ(call("report part1 part2 --out all").exit_code, 0);
  EXPECT_THAT(refusal("study " + study + " --shard 1/3 --out part1"), HasSubstr("has 2 shards"));
}

TEST_F(Cli, WhatAClusterCannotDoIsSaid) {
  const std::string study = write_small_study(folder_);
  EXPECT_THAT(refusal("status ."), HasSubstr("holds no plan.json"));
  EXPECT_THAT(refusal("study --worker --out nothing"), HasSubstr("holds no plan.json"));
  // stands for Slurm's program, first one that refuses, then one that writes down its calls
  const auto sbatch = [&](const std::string& script) {
    fs::permissions(write("bin/sbatch", "#!/bin/sh\n" + script), fs::perms::owner_all);
  };
  const std::string path_before = std::getenv("PATH");
  setenv("PATH", (path("bin") + ":" + path_before).c_str(), 1);
  sbatch("echo 'sbatch: error: invalid partition' >&2; exit 1");
  EXPECT_THAT(refusal("study " + study + " --out shared --slurm"), HasSubstr("invalid partition"));
  sbatch("echo \"$@\" >> calls; echo '42;here'");
  const Outcome submitted = call("study " + study + " --out shared --slurm --array-limit 1");
  setenv("PATH", path_before.c_str(), 1);
  EXPECT_EQ(submitted.exit_code, 0) << submitted.err;
  EXPECT_THAT(submitted.out, HasSubstr("submitted as job 42: 4 runs of 2 datasets"));
  EXPECT_THAT(content(path("calls")),
              AllOf(HasSubstr("--parsable " + fs::canonical(path("shared")).string() + "/tasks.sh"),
                    HasSubstr("--dependency=afterany:42 ")));
}

TEST_F(Cli, ASweepOfThreeLinesIsFlownAndMistakesInItAreNamedBefore) {
  const std::string study =
      "scenes: [{world: house, flight: house, seconds: 1}]\nsensors: [livox_mid360]\n"
      "algorithms: [kiss_icp]\nscore: [trajectory]\n";
  folder_.write("wrong.yaml", study + "vary: {sensor.range_nois_m: [0]}\n");
  const Outcome wrong = call("study wrong.yaml --out wrong");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("did you mean 'range_noise_m'?"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "wrong"));
  folder_.write("noise.yaml", study + "vary: {sensor.range_noise_m: [0, 0.02, 0.05]}\n");
  EXPECT_THAT(call("study noise.yaml --dry").out, HasSubstr("3 runs, about"));
  const Outcome flown = call("study noise.yaml --out noise");
  EXPECT_EQ(flown.exit_code, 0) << flown.err;
  EXPECT_THAT(flown.out, AllOf(HasSubstr("sensor.range_noise_m=0 "),
                               HasSubstr("sensor.range_noise_m=0.05"), HasSubstr("3 runs")));
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "noise/tables/sweep-cpu_load-house.csv"));
}

TEST_F(Cli, ImproveFliesEachStepThatIsBetterThanTheSensor) {
  folder_.write("steps.yaml",
                "steps:\n"
                "  - {name: less noise, source: made up, set: {sensor.range_noise_m: 0.005}}\n"
                "  - {name: more noise, source: made up, set: {sensor.range_noise_m: 0.05}}\n");
  const std::string improve =
      "improve livox_mid360 --world house --flight house --algorithm kiss_icp --seconds 1 --seeds "
      "3 "
      "--steps steps.yaml";
  const Outcome dry = call(improve + " --dry");
  EXPECT_THAT(dry.out, HasSubstr("6 runs, about")) << dry.err;
  EXPECT_THAT(dry.err, HasSubstr("as good already: more noise"));
  const Outcome flown = call(improve + " --out better");
  EXPECT_EQ(flown.exit_code, 0) << flown.err;
  EXPECT_THAT(flown.out,
              AllOf(HasSubstr("less noise"), HasSubstr("made up"), HasSubstr("helps: ")));
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "better/tables/improve.csv"));
  EXPECT_THAT(refusal("improve livox_mid306 --world house --flight house --out x"),
              HasSubstr("did you mean 'livox_mid360"));
  EXPECT_THAT(refusal("improve livox_mid360 --world house --flight hous --out x"),
              HasSubstr("did you mean 'house"));
  EXPECT_THAT(refusal("improve livox_mid360 --world house --flight house"), HasSubstr("--out DIR"));
  folder_.write("steps.yaml", "steps: [{name: magic, set: {sensor.range_noise_m: 0}}]\n");
  EXPECT_THAT(refusal(improve + " --out x"), AllOf(HasSubstr("magic"), HasSubstr("no source")));
}

TEST_F(Cli, ARunInPartsOfItsSweepsAndScoredAgainstAGivenTruth) {
  ASSERT_EQ(call("simulate --world house --flight house --seconds 2 --sensor livox_mid360 --hits "
                 "off --out data")
                .exit_code,
            0);
  ASSERT_EQ(call("run kiss_icp data/data.mcap --parts 2 --maps off --out halves").exit_code, 0);
  const auto json = [](const Outcome& outcome) { return nlohmann::json::parse(outcome.out); };
  EXPECT_EQ(json(call("info halves --json")).value("kind", ""), "run");
  const Outcome scored = call("evaluate halves --truth data/truth.tum --score trajectory --json");
  EXPECT_EQ(scored.exit_code, 0) << scored.err;
  EXPECT_EQ(json(scored)["final"]["association"]["estimates"], 40) << "20 scans in halves";
  const Outcome lever = call(
      "evaluate halves --truth data/truth.tum --lever 1,0,0,0,0,0,1 --score trajectory --json");
  EXPECT_EQ(json(lever)["frames"]["lever"], "1,0,0,0,0,0,1");
  EXPECT_EQ(call("evaluate halves --lever 1,0,0,0,0,0,1").exit_code, 2);
  EXPECT_EQ(call("run theirs data --external none.yaml --parts 2 --out x").exit_code, 2);
}

TEST_F(Cli, TwoLidarsMakeOneScan) {
  write("room.obj", room_obj());
  const std::string scene =
      "scenes: [{world: room.obj, flight: " + write("flight.yaml", kRoomFlight) +
      ", seconds: 2}]\nsensors: [livox_mid360, livox_mid360_down]\nalgorithms:\n";
  write("study.yaml", scene +
                          "  - {name: arena_lio, sensors: [livox_mid360]}\n"
                          "  - {name: arena_lio, as: two, sensors: [livox_mid360], also: "
                          "[livox_mid360_down]}\n");
  ASSERT_EQ(call("study study.yaml --out study").exit_code, 0);
  std::vector<double> bytes;  // of the registered scan
  for (const std::string name : {"arena_lio", "two"}) {
    const std::string run = "study/runs/room-flight-s1-livox_mid360-" + name;
    const auto manifest = nlohmann::json::parse(content(path(run + "/manifest.json")));
    EXPECT_EQ(manifest.at("also").size(), name == "two" ? 1U : 0U);
    EXPECT_EQ(manifest.at("summary").at("scans"), 20);
    const auto scored = nlohmann::json::parse(call("evaluate " + run + " --json").out);
    EXPECT_LT(scored["final"]["ate"]["first_pose"]["translation"]["rmse_m"], 0.01) << name;
    std::istringstream resources(content(path(run + "/resources.csv")));
    std::string row, cell;
    for (int i = 0; i < 2; ++i) std::getline(resources, row);  // the head, the first scan
    std::istringstream cells(row);
    for (int i = 0; i < 7; ++i) std::getline(cells, cell, ',');
    bytes.push_back(std::stod(cell));
  }
  EXPECT_EQ(bytes[0], 20'000 * 12.0);
  EXPECT_EQ(bytes[1], 2 * bytes[0]);
  const std::string refused = "  - {name: kiss_icp, also: [livox_mid360_down]}\n";
  write("refused.yaml", scene + refused);
  EXPECT_THAT(refusal("study refused.yaml --out x"), HasSubstr("one LiDAR alone"));
  write("twice.yaml", scene + "  - {name: arena_lio, also: [livox_mid360_down]}\n");
  EXPECT_THAT(refusal("study twice.yaml --out x"), HasSubstr("twice"));
  write("unnamed.yaml", scene + "  - {name: arena_lio, also: [ouster_os0_128]}\n");
  EXPECT_THAT(refusal("study unnamed.yaml --out x"), HasSubstr("which it does not name"));
  const std::string data = "study/datasets/room-flight-s1";
  EXPECT_THAT(refusal("run arena_lio " + data + " --sensor livox_mid360 --also livox_mid360"),
              HasSubstr("used already"));
  EXPECT_THAT(refusal("run arena_lio " + data + " --sensor livox_mid360 --also down"),
              HasSubstr("no LiDAR named 'down'"));
}

TEST_F(Cli, ACheckSaysWhatItFoundOnAPageToo) {
  ASSERT_EQ(call("simulate --world house --flight house_aggressive --seconds 8 --sensor "
                 "livox_mid360 --set imu.gyro_range=3 --hits off --out clipped")
                .exit_code,
            0);
  const Outcome check = call("check clipped --out page.html");
  EXPECT_EQ(check.exit_code, 1) << "a fault";
  EXPECT_THAT(check.out, AllOf(HasSubstr("is at 3 rad/s"), HasSubstr("remedy: ")));
  EXPECT_EQ(std::filesystem::exists(folder_.path() / "page.html"), LIDARENA_TEST_VIEWER);
  const auto json = nlohmann::json::parse(call("check clipped --json").out);
  EXPECT_EQ(json["findings"][0]["key"], "imu_saturated");
  EXPECT_FALSE(json.contains("curves"));
}

}  // namespace
}  // namespace lidarena::testing
