// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/variations.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "lidarena/report/report.hpp"
#include "lidarena/results/known_row.hpp"
#include "lidarena/study/plan.hpp"
#include "lidarena/study/study.hpp"
#include "tests/study/configs.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::study {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A study of one scene, sensor and method with more lines of YAML.
StudySpec spec_of(const std::string& more) {
  StudySpec spec;
  read_config(ConfigNode::parse("scenes: [{world: house, flight: house, seconds: 1}]\n"
                                "sensors: [livox_mid360]\nalgorithms: [kiss_icp]\n",
                                "study"),
              spec);
  read_config(ConfigNode::parse(more, "study"), spec);
  return spec;
}

std::vector<std::string> variations(const std::vector<PlannedRun>& cells) {
  std::vector<std::string> names;
  for (const PlannedRun& cell : cells) names.push_back(cell.variation);
  return names;
}

std::string error_of(const std::string& more) {
  try {
    planned_cells(spec_of(more), configs());
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Variations, EachValueIsACellAndTheValueOfTheBaseIsTheBase) {
  // The Mid-360's own range noise is 0.02 m.
  const auto cells =
      planned_cells(spec_of("vary: {sensor.range_noise_m: [0, 0.01, 0.02, 0.04]}"), configs());
  EXPECT_THAT(variations(cells),
              ElementsAre("", "sensor.range_noise_m=0", "sensor.range_noise_m=0.01",
                          "sensor.range_noise_m=0.04"));
  EXPECT_EQ(cells[0].varied["sensor.range_noise_m"], 0.02);
  EXPECT_THAT(cells[0].set, IsEmpty());
  EXPECT_EQ(cells[3].varied["sensor.range_noise_m"], 0.04);
  EXPECT_THAT(cells[3].set, ElementsAre("sensor.range_noise_m=0.04"));
  EXPECT_EQ(cells[3].name, "house-house-s1-sensor.range_noise_m=0.04-livox_mid360-kiss_icp-indoor");
  EXPECT_EQ(cells[3].dataset, "house-house-s1-sensor.range_noise_m=0.04");
}

TEST(Variations, OneAtATimeAndAsAGrid) {
  const std::string vary =
      "vary: {sensor.range_noise_m: [0.01, 0.04], imu.rate_hz: [100, 400], kiss_icp.voxel_size_m: "
      "[0.2]}\n";
  EXPECT_EQ(planned_cells(spec_of(vary), configs()).size(), 1U + 2U + 2U + 1U);
  const auto grid = planned_cells(spec_of(vary + "vary_as: grid"), configs());
  EXPECT_EQ(grid.size(), 1U + 2U * 2U * 1U);
  EXPECT_THAT(grid[1].differs,
              ElementsAre("sensor.range_noise_m", "imu.rate_hz", "kiss_icp.voxel_size_m"));
  EXPECT_THAT(grid[1].set, ElementsAre("sensor.range_noise_m=0.01", "imu.rate_hz=100"));
  EXPECT_EQ(grid[1].settings["voxel_size_m"], 0.2);
  std::set<std::string> datasets;
  for (const PlannedRun& cell : grid) datasets.insert(cell.dataset);
  EXPECT_EQ(datasets.size(), 5U);
}

TEST(Variations, ASettingOfTheMethodNeedsNoFlightOfItsOwn) {
  const auto cells =
      planned_cells(spec_of("vary: {algorithm.voxel_size_m: [0.2, 0.3]}"), configs());
  ASSERT_EQ(cells.size(), 3U);
  EXPECT_EQ(cells[1].dataset, cells[0].dataset);
  EXPECT_NE(cells[1].name, cells[2].name);
}

TEST(Variations, OfOneSensorAreThoseOfItsCellsAlone) {
  StudySpec spec = spec_of("vary: {livox_mid360.range_noise_m: [0.05]}");
  spec.sensors.emplace_back("ouster_os0_128");
  const auto cells = planned_cells(spec, configs());
  ASSERT_EQ(cells.size(), 3U);
  EXPECT_EQ(cells[2].sensor, "livox_mid360");
  EXPECT_FALSE(cells[1].varied.contains("livox_mid360.range_noise_m"));
  ProgramCode code = ProgramCode::ask(LIDARENA_BINARY);
  const StudyPlan plan = make_plan(spec, configs(), code);
  for (const PlanUnit& unit : plan.units) {
    const bool is_base = plan.cells[unit.cells.front()].variation.empty();
    EXPECT_EQ(sensors_of(plan, unit).size(), is_base ? 2U : 1U) << unit.dataset;
  }
}

TEST(Variations, NamedSetsAreFlownBesideTheBase) {
  const auto cells =
      planned_cells(spec_of("sets: [{name: blind, set: {sensor.max_range_m: 5, imu.rate_hz: 100}}, "
                            "{name: as it is, set: {sensor.range_noise_m: 0.02}}]"),
                    configs());
  EXPECT_THAT(variations(cells), ElementsAre("", "blind"));
  EXPECT_THAT(cells[1].set, ElementsAre("sensor.max_range_m=5", "imu.rate_hz=100"));
}

TEST(Variations, AllCombinationsOfSetsNameTheSetsOfEach) {
  const std::string sets =
      "sets: [{name: near, set: {sensor.max_range_m: 5}}, {name: slow, set: {imu.rate_hz: 100}}, "
      "{name: loud, set: {sensor.range_noise_m: 0.1}}]\n";
  const auto cells = planned_cells(spec_of(sets + "sets_as: all"), configs());
  EXPECT_THAT(variations(cells), ElementsAre("", "near", "slow", "loud", "near + slow",
                                             "near + loud", "slow + loud", "near + slow + loud"));
  EXPECT_THAT(cells[5].differs, ElementsAre("near", "loud"));
  EXPECT_THAT(cells[7].set,
              ElementsAre("sensor.max_range_m=5", "imu.rate_hz=100", "sensor.range_noise_m=0.1"));
  EXPECT_EQ(planned_cells(spec_of(sets), configs()).size(), 4U);
  EXPECT_EQ(planned_cells(spec_of(sets + "sets_as: pairs"), configs()).size(), 7U);
  EXPECT_THAT(error_of("sets: [{name: a, set: {imu.rate_hz: 100}}, {name: b, set: {imu.rate_hz: "
                       "50}}]\nsets_as: all"),
              AllOf(HasSubstr("study: sets: b"), HasSubstr("imu.rate_hz, as a does")));
}

TEST(Variations, SettingsOfASetAreCheckedTogether) {
  // The Mid-360 measures from 0.1 to 70 m: 80 m is valid only together with 100 m, 6 and 5 m only
  // apart.
  const auto cells = planned_cells(spec_of("sets: [{name: far, set: {sensor.min_range_m: 80, "
                                           "sensor.max_range_m: 100}}]"),
                                   configs());
  EXPECT_THAT(variations(cells), ElementsAre("", "far"));
  EXPECT_THAT(cells[1].set, ElementsAre("sensor.min_range_m=80", "sensor.max_range_m=100"));
  EXPECT_THAT(error_of("sets: [{name: none, set: {sensor.min_range_m: 6, sensor.max_range_m: 5}}]"),
              HasSubstr("min_range_m is not below max_range_m"));
  EXPECT_THAT(error_of("vary: {sensor.min_range_m: [6], sensor.max_range_m: [5]}\nvary_as: grid"),
              HasSubstr("min_range_m is not below max_range_m"));
}

TEST(Variations, AFlightThatNoPlaceAllowsIsRefused) {
  const std::string racing = "scenes: [{world: house, flight: house_aggressive, seconds: 1}]\n";
  EXPECT_THAT(error_of(racing + "vary: {flight.limits.max_yaw_rate: [4, 0.6]}"),
              AllOf(HasSubstr("house_aggressive.yaml with limits.max_yaw_rate=0.6"),
                    HasSubstr("sweep needs a yaw rate of 2.78 rad/s")));
  EXPECT_EQ(error_of(racing + "sets: [{name: calm, set: {flight.limits.max_yaw_rate: 0.6, "
                              "flight.heading.amplitude: 0.06}}]"),
            "no error");
}

TEST(Variations, WhatTheSeedDrawsIsNeverTakenForTheBase) {
  StudySpec spec = spec_of("vary: {world.house.detail: [2]}\nnew_scenes: true");
  spec.scenes = {{"test_house", "house_aggressive", 1.0}};
  const Json drawn = configs().resolve("worlds", "test_house").string();
  const auto cells = planned_cells(spec, configs());
  EXPECT_EQ(cells.size(), 2U) << drawn;
}

TEST(Variations, MistakesAreNamedBeforeAnythingRuns) {
  EXPECT_THAT(error_of("vary: {sensor.range_nois_m: [0]}"),
              HasSubstr("did you mean 'range_noise_m'?"));
  EXPECT_THAT(error_of("vary: {senser.range_noise_m: [0]}"), HasSubstr("did you mean 'sensor'?"));
  EXPECT_THAT(error_of("vary: {sensor.range_noise_m: []}"), HasSubstr("is not a list of values"));
  EXPECT_THAT(error_of("vary: {sensor.range_noise_m: 0.1}"), HasSubstr("is not a list of values"));
  EXPECT_THAT(error_of("vary: {sensor.range_noise_m: [-1]}"), HasSubstr("must be at least 0"));
  EXPECT_THAT(error_of("vary: {sensor.range_noise_m: [much]}"), HasSubstr("not a finite number"));
  EXPECT_THAT(error_of("vary: {algorithm.voxel_siz_m: [1]}"), HasSubstr("did you mean"));
  EXPECT_THAT(error_of("vary: {world.house.detail: [-3]}"), HasSubstr("out of range"));
  EXPECT_THAT(error_of("sets: [{name: a, set: {sensor.max_range_m: 5}}, "
                       "{name: a, set: {sensor.max_range_m: 7}}]"),
              HasSubstr("two sets have the name 'a'"));
  EXPECT_THAT(error_of("sets: [{name: '', set: {sensor.max_range_m: 5}}]"),
              HasSubstr("without '/'"));
  EXPECT_THAT(error_of("algorithms: [{name: kiss_icp, set: {voxel_size: 1}}]"),
              HasSubstr("did you mean"));
  EXPECT_THAT(error_of("algorithms: [{name: kiss_icp, set: {voxel_size_m: []}}]"),
              HasSubstr("empty list"));
}

TEST(StudyAlgorithm, HasSettingsAndANameOfItsOwn) {
  const auto cells =
      planned_cells(spec_of("algorithms: [kiss_icp, {name: kiss_icp, as: kiss_fine, parts: 2, set: "
                            "{voxel_size_m: [0.2, 0.3], max_range_m: 30}}]"),
                    configs());
  ASSERT_EQ(cells.size(), 3U);
  EXPECT_EQ(cells[0].label(), "kiss_icp");
  EXPECT_EQ(cells[1].label(), "kiss_fine-voxel_size_m=0.2");
  EXPECT_EQ(cells[1].settings, (Json{{"voxel_size_m", 0.2}, {"max_range_m", 30}}));
  EXPECT_EQ(cells[2].settings["voxel_size_m"], 0.3);
  EXPECT_EQ(cells[2].parts, 2);
  EXPECT_THAT(error_of("algorithms: [kiss_icp, {name: kiss_icp, set: {voxel_size_m: 0.2}}]"),
              HasSubstr("plans two runs called"));
}

/// All files of a folder but those that say when something was done.
std::map<std::string, std::string> tables_of(const std::filesystem::path& study) {
  std::map<std::string, std::string> files;
  files["results.csv"] = dataset::read_bytes(study / "results.csv");
  for (const auto& entry : std::filesystem::directory_iterator(study / "tables")) {
    const std::string name = entry.path().filename().string();
    const bool is_of_flights =
        name.starts_with("sensors") || name.starts_with("commands") || name.starts_with("decision");
    if (!is_of_flights) files[name] = dataset::read_bytes(entry.path());
  }
  return files;
}

TEST(KnownRows, AStudyInTwoFoldersHasTheTablesOfTheWholeToTheByte) {
  const TemporaryFolder scratch;
  LogSink log;
  StudySpec spec = spec_of(
      "vary: {sensor.range_noise_m: [0.05]}\nseeds: [1, 2]\n"
      "algorithms: [{name: arena_lo, as: halves, parts: 2}]");
  StudyOptions options;
  options.program = LIDARENA_BINARY;
  const auto report = [&](const std::filesystem::path& out) {
    report::write_report({out}, out, Parallel(1), log);
  };
  const std::filesystem::path first = scratch.path() / "first", second = scratch.path() / "second";
  options.shard = {1, 2};
  ASSERT_GT(run_study(spec, configs(), first, options, log).runs, 0U);
  report(first);
  options.shard = {1, 1};
  options.known = {first / "results.csv"};
  const StudyOutcome rest = run_study(spec, configs(), second, options, log);
  EXPECT_EQ(rest.runs, 4U);
  EXPECT_EQ(rest.reused, 2U) << "half of the study is known";
  report(second);
  // Everything is known now: nothing is flown, and the tables are the same.
  const std::filesystem::path third = scratch.path() / "third";
  options.known = {second / "results.csv"};
  EXPECT_EQ(run_study(spec, configs(), third, options, log).reused, 4U);
  report(third);
  EXPECT_EQ(tables_of(third), tables_of(second));
  EXPECT_FALSE(std::filesystem::exists(third / "datasets"));
}

TEST(KnownRows, OfOtherSettingsAreNotUsed) {
  const TemporaryFolder scratch;
  std::ofstream(scratch.path() / "known.csv") << "run,status\nx,ok\n";
  EXPECT_THROW(results::read_known_rows(scratch.path() / "known.csv"), InputError);
  std::ofstream(scratch.path() / "known.csv")
      << "run,status,reason,zero_bounds,key\n"
         "a,ok,\"it \"\"ended\"\", early\",own_map_outliers=0.5,1234\nb,ok,,,\n";
  const auto rows = results::read_known_rows(scratch.path() / "known.csv");
  ASSERT_EQ(rows.size(), 1U) << "a row without a key is of no study";
  EXPECT_EQ(rows[0].reason, "it \"ended\", early");
  EXPECT_EQ(rows[0].zero_bounds.at("own_map_outliers"), 0.5);
}

TEST(Recordings, AreScoredAgainstTheirOwnTruth) {
  const TemporaryFolder scratch;
  LogSink log;
  StudyOptions options;
  options.program = LIDARENA_BINARY;
  // A flight of ours, its truth taken away, serves as the recording.
  ASSERT_EQ(run_study(spec_of(""), configs(), scratch.path() / "flown", options, log).runs, 1U);
  stages::Command simulate;
  const std::filesystem::path data = scratch.path() / "data";
  simulate.arguments = {LIDARENA_BINARY, "simulate",        "--world", "house",      "--flight",
                        "house",         "--seconds",       "1",       "--sensor",   "livox_mid360",
                        "--configs",     kConfigs.string(), "--out",   data.string()};
  ASSERT_EQ(stages::answer_of(simulate).end.exit_code, 0);
  StudySpec spec;
  read_config(
      ConfigNode::parse("recordings: [{name: mine, file: '" + (data / "data.mcap").string() +
                            "', truth: '" + (data / "truth.tum").string() +
                            "'}]\nalgorithms: [kiss_icp]\n"
                            "vary: {kiss_icp.voxel_size_m: [0.3], sensor.max_range_m: [5]}",
                        "study"),
      spec);
  const auto out = scratch.path() / "out";
  const StudyOutcome outcome = run_study(spec, configs(), out, options, log);
  EXPECT_EQ(outcome.runs, 2U) << "the base and the other voxels; a sensor cannot be changed";
  EXPECT_EQ(outcome.failed, 0U);
  const auto flown = results::read_results(scratch.path() / "flown").rows.at(0);
  const auto row = results::read_results(out).rows.at(0);
  EXPECT_EQ(row.world, "mine");
  ASSERT_TRUE(row.metrics);
  EXPECT_EQ(results::value_of(row, results::kAte), results::value_of(flown, results::kAte));
  spec.recordings[0].truth = "nowhere.tum";
  EXPECT_THROW(planned_cells(spec, configs()), InputError);
}

TEST(Recordings, KarlsruhesSweepsAreARowOfAStudy) {
  const std::filesystem::path shared = LIDARENA_SHARED_DATA "/lidar/karlsruhe_hdl64";
  if (!std::filesystem::exists(shared)) GTEST_SKIP() << shared << " is not there";
  const TemporaryFolder scratch;
  LogSink log;
  const std::filesystem::path sweeps = scratch.path() / "sweeps";
  stages::Command convert;
  convert.arguments = {"/usr/bin/env", "python3",
                       LIDARENA_SOURCE_DIR "/tests/system/karlsruhe_to_dataset.py", shared.string(),
                       sweeps.string()};
  ASSERT_EQ(stages::answer_of(convert).end.exit_code, 0);
  StudySpec spec;
  spec.algorithms = {"arena_lo", "ct_icp"};
  StudyRecording& recording = spec.recordings.emplace_back();
  recording.name = "karlsruhe";
  recording.file = sweeps.string();
  recording.truth = (shared / "gps_ins.tum").string();
  StudyOptions options;
  options.program = LIDARENA_BINARY;
  ASSERT_EQ(run_study(spec, configs(), scratch.path() / "out", options, log).failed, 0U);
  for (const results::RunRecord& row : results::read_results(scratch.path() / "out").rows) {
    const auto ate_cm = results::value_of(row, results::kAte);
    ASSERT_TRUE(ate_cm) << row.name;
    EXPECT_LT(*ate_cm, 15.0) << row.name << " (13.0 and 12.6 when this was written; the GPS/INS "
                             << "itself is as good as that)";
  }
}

TEST(Recordings, ShippedDescriptionsAreReadAndNameTheirSource) {
  for (const std::string& name : configs().names("recordings")) {
    const auto recording = load_config<StudyRecording>(configs().resolve("recordings", name));
    EXPECT_EQ(recording.name, name);
    EXPECT_FALSE(recording.source.empty()) << name;
    EXPECT_THAT(dataset::read_bytes(configs().resolve("recordings", name)),
                HasSubstr("Not run by us"));
  }
  EXPECT_GE(configs().names("recordings").size(), 5U);
}

TEST(VariedSimulation, WhatIsNotVariedKeepsItsNoiseToTheByte) {
  const TemporaryFolder scratch;
  const auto fly = [&](const std::string& name, std::vector<std::string> more) {
    stages::Command simulate;
    const std::filesystem::path out = scratch.path() / name;
    simulate.arguments = {LIDARENA_BINARY, "simulate",        "--world",   "house",
                          "--flight",      "house",           "--seconds", "0.5",
                          "--sensor",      "livox_mid360",    "--sensor",  "ouster_os0_32",
                          "--configs",     kConfigs.string(), "--out",     out.string()};
    simulate.arguments.insert(simulate.arguments.end(), more.begin(), more.end());
    EXPECT_EQ(stages::answer_of(simulate).end.exit_code, 0) << name;
    return dataset::open_dataset(out);
  };
  dataset::Dataset base = fly("base", {});
  dataset::Dataset near = fly("near", {"--set", "livox_mid360.max_range_m=3"});
  std::size_t fewer = 0, scans = 0;
  while (const auto a = base.events->next()) {
    const auto b = near.events->next();
    ASSERT_TRUE(b);
    ASSERT_EQ(a->sensor_id, b->sensor_id);
    if (const auto* sample = std::get_if<ImuSample>(&a->data)) {
      const auto& other = std::get<ImuSample>(b->data);
      EXPECT_EQ(sample->gyro, other.gyro);
      EXPECT_EQ(sample->accel, other.accel);
      continue;
    }
    const Scan &all = std::get<Scan>(a->data), &some = std::get<Scan>(b->data);
    ++scans;
    if (a->sensor_id == "livox_mid360") {
      fewer += some.points.size() < all.points.size() ? 1U : 0U;
      for (const Point& point : some.points) {
        const auto same = std::ranges::find(all.points, point.dt_ns, &Point::dt_ns);
        ASSERT_NE(same, all.points.end());
      }
    } else {
      ASSERT_EQ(all.points.size(), some.points.size());
      for (std::size_t i = 0; i < all.points.size(); ++i)
        ASSERT_EQ(all.points[i].position, some.points[i].position);
    }
  }
  EXPECT_GT(scans, 4U);
  EXPECT_GT(fewer, 2U);
}

}  // namespace
}  // namespace lidarena::study
