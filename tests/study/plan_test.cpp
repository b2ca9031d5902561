// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "lidarena/stages/scene_settings.hpp"
#include "lidarena/study/tasks.hpp"
#include "tests/study/configs.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::study {
namespace {

using ::testing::HasSubstr;

TEST(ConfigFolder, NamesResolveAndAMisspeltOneIsCorrected) {
  EXPECT_EQ(configs().resolve("studies", "quick").filename(), "quick.yaml");
  try {
    configs().resolve("studies", "quikc");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("did you mean 'quick'?"));
  }
  EXPECT_THROW(stages::ConfigFolder::find("/"), InputError);
}

TEST(ConfigFolder, AFolderOrAProgramThatHappensToBeCalledLikeAWorldOrAStudyDoesNotHideIt) {
  namespace fs = std::filesystem;
  const fs::path here = fs::current_path();
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "cave");
  folder.write("test", "#!/bin/sh\n");
  folder.write("mine", "title: Mine\n");
  const stages::ConfigFolder known = configs();
  fs::current_path(folder.path());
  const fs::path world = known.resolve("worlds", "cave");
  const fs::path study = known.resolve("studies", "test");
  const fs::path mine = known.resolve("studies", "mine");
  const fs::path path = known.resolve("studies", "./test");
  fs::current_path(here);
  EXPECT_EQ(world.filename(), "cave.yaml");
  EXPECT_EQ(study.filename(), "test.yaml");
  EXPECT_EQ(mine, "mine");
  EXPECT_EQ(path, "./test") << "a path wins";
}

StudySpec small_spec() {
  StudySpec spec;
  spec.scenes = {{"house", "house", 5.0}};
  spec.sensors = {"livox_mid360", "ouster_os0_128"};
  spec.algorithms = {"kiss_icp", "kiss_icp:published"};
  spec.seeds = {1, 2};
  return spec;
}

TEST(Plan, EveryCellOfTheMatrixIsPlannedOnceUnderANameOfItsOwn) {
  const std::vector<PlannedRun> cells = planned_cells(small_spec(), configs());
  ASSERT_EQ(cells.size(), 8U);
  EXPECT_EQ(cells[0].name, "house-house-s1-livox_mid360-kiss_icp-indoor");
  EXPECT_EQ(cells[1].preset, "published");
  std::set<std::string> names;
  std::set<std::string> datasets;
  for (const PlannedRun& cell : cells) {
    names.insert(cell.name);
    datasets.insert(cell.dataset);
  }
  EXPECT_EQ(names.size(), 8U);
  EXPECT_EQ(datasets.size(), 2U) << "one flight per seed, shared by sensors and algorithms";
}

TEST(Plan, ASceneMayHaveSeedsOfItsOwn) {
  StudySpec spec = small_spec();
  spec.sensors = {"livox_mid360"};
  spec.algorithms = {"kiss_icp"};
  spec.scenes.push_back({"cave", "cave", 5.0});
  spec.scenes.back().seeds = {7};
  std::vector<std::string> datasets;
  for (const PlannedRun& cell : planned_cells(spec, configs())) datasets.push_back(cell.dataset);
  EXPECT_EQ(datasets,
            (std::vector<std::string>{"house-house-s1", "house-house-s2", "cave-cave-s7"}));
}

TEST(Plan, AMethodIsFlownWithItsSensorsAlone) {
  StudySpec spec = small_spec();
  spec.seeds = {1};
  StudyAlgorithm near("kiss_icp"), far("kiss_icp");
  near.as = far.as = "kiss";
  near.set = {{"max_range_m", 40}};
  near.sensors = {"livox_mid360"};
  far.set = {{"max_range_m", 100}};
  far.sensors = {"ouster_os0_128"};
  spec.algorithms = {near, far, "ct_icp"};
  const std::vector<PlannedRun> cells = planned_cells(spec, configs());
  ASSERT_EQ(cells.size(), 4U);
  EXPECT_EQ(cells[0].name, "house-house-s1-livox_mid360-kiss-indoor");
  EXPECT_EQ(cells[0].settings, Json({{"max_range_m", 40}}));
  EXPECT_EQ(cells[2].name, "house-house-s1-ouster_os0_128-kiss-indoor");
  EXPECT_EQ(cells[2].settings, Json({{"max_range_m", 100}}));
  EXPECT_EQ(StudyAlgorithm::from(near.json(), "test").sensors, near.sensors);

  spec.algorithms[0].sensors = {"livox_mid306"};
  try {
    planned_cells(spec, configs());
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("flies kiss_icp with the sensor 'livox_mid306'"));
  }
}

TEST(Plan, EveryStudyShippedCanBePlanned) {
  for (const std::string& name : configs().names("studies")) {
    const auto spec = load_study(configs().resolve("studies", name));
    EXPECT_FALSE(planned_cells(spec, configs()).empty()) << name;
  }
}

TEST(Plan, TheMid360WithAllFiveChangesIsTheOs0) {
  const std::vector<PlannedRun> cells =
      planned_cells(load_study(configs().resolve("studies", "mid360_to_os0")), configs());
  EXPECT_EQ(cells.size(), 32U * 2U * 8U * 2U);
  const auto all =
      std::ranges::find_if(cells, [](const PlannedRun& cell) { return cell.differs.size() == 5; });
  ASSERT_NE(all, cells.end());
  const auto file = [](const std::string& name) { return configs().resolve("sensors", name); };
  const auto shipped = configs().root() / "sensors";
  const auto set = stages::scene_settings(all->set, {file(all->sensor)}).sensors.front();
  sensor::SensorConfig changed = sensor::load_sensor(file(all->sensor), shipped, set);
  sensor::SensorConfig os0 = sensor::load_sensor(file("ouster_os0_128"), shipped);
  EXPECT_EQ(sensor::make_pattern(changed)->beams_per_scan(), 1024U * 128U);
  EXPECT_EQ(to_json(*changed.facts.fov), to_json(*os0.facts.fov));
  changed.shape = os0.shape;
  changed.facts = os0.facts;
  changed.name = os0.name;
  EXPECT_EQ(to_json(changed), to_json(os0));
}

TEST(Plan, TheTortureExperimentsCanBePlanned) {
  const auto folder = kConfigs.parent_path() / "tests/studies/torture";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto cells = planned_cells(load_study(entry.path()), configs());
    EXPECT_FALSE(cells.empty()) << entry.path();
  }
}

TEST(Plan, AnUnknownNameIsRefusedBeforeAnyWorkStarts) {
  const auto error = [](auto change) {
    StudySpec spec = small_spec();
    change(spec);
    try {
      planned_cells(spec, configs());
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(error([](StudySpec& s) { s.algorithms = {"kis_icp"}; }),
              HasSubstr("did you mean 'kiss_icp'?"));
  EXPECT_THAT(error([](StudySpec& s) { s.algorithms = {"kiss_icp:heda"}; }),
              HasSubstr("no preset 'heda'"));
  EXPECT_THAT(error([](StudySpec& s) { s.sensors = {"livox_mid306"}; }),
              HasSubstr("did you mean 'livox_mid360"));
  EXPECT_THAT(error([](StudySpec& s) { s.scenes[0].world = "hous"; }),
              HasSubstr("did you mean 'house'?"));
  EXPECT_THAT(error([](StudySpec& s) { s.seeds.clear(); }), HasSubstr("names no seeds"));
  EXPECT_THAT(error([](StudySpec& s) { s.seeds = {1, 1}; }), HasSubstr("plans two runs called"));
  EXPECT_THAT(error([](StudySpec& s) { s.external = {{.name = "kiss_icp", .command = "true"}}; }),
              HasSubstr("which is a built-in algorithm"));
  EXPECT_THAT(error([](StudySpec& s) { s.external.emplace_back().name = "theirs"; }),
              HasSubstr("without a name or a command"));
}

TEST(LoadStudy, TakesTheValuesOfItsBaseWhereItHasNone) {
  const TemporaryFolder folder;
  const auto write = [&](const char* name, const char* text) {
    std::ofstream(folder.path() / name) << text;
    return folder.path() / name;
  };
  write("base.yaml", "title: Base\nsensors: [a, b]\nseeds: [1, 2]\nlimits: {minutes: 7}\n");
  const auto file = write("own.yaml", "base: base.yaml\ntitle: Own\nseeds: [5]\n");
  const StudySpec spec = load_study(file);
  EXPECT_EQ(spec.title, "Own");
  EXPECT_EQ(spec.sensors, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(spec.seeds, std::vector<std::uint64_t>{5});
  EXPECT_EQ(spec.limits.minutes, 7.0);
  EXPECT_THROW(load_study(write("third.yaml", "base: own.yaml\n")), InputError);
  EXPECT_THROW(load_study(write("none.yaml", "base: missing.yaml\n")), InputError);
}

TEST(Plan, ModesMakeDatasetsOfTheirOwnAndExternalProgramsAreCells) {
  StudySpec spec = small_spec();
  spec.seeds = {1};
  spec.sensors = {"livox_mid360"};
  spec.modes = {sensor::ScanMode::kRolling, sensor::ScanMode::kFrozen};
  spec.external = {{.name = "theirs", .command = "true"}};
  spec.algorithms = {"kiss_icp", "theirs"};
  const std::vector<PlannedRun> cells = planned_cells(spec, configs());
  ASSERT_EQ(cells.size(), 4U);
  EXPECT_EQ(cells[0].dataset, "house-house-s1-rolling");
  EXPECT_EQ(cells[3].dataset, "house-house-s1-frozen");
  EXPECT_EQ(cells[3].name, "house-house-s1-frozen-livox_mid360-theirs-external");
}

TEST(Plan, EachUnitIsADatasetWithItsCellsAndShardsShareTheUnitsEvenly) {
  StudySpec spec = small_spec();
  spec.seeds = {1, 2, 3, 4, 5, 6, 7};
  const StudyPlan plan =
      make_plan(spec, configs(), ProgramCode::ask(find_program(LIDARENA_BINARY)), 3);
  ASSERT_EQ(plan.units.size(), 7U);
  std::set<std::size_t> cells;
  std::vector<double> seconds(3, 0.0);
  for (const PlanUnit& unit : plan.units) {
    for (const std::size_t cell : unit.cells) {
      EXPECT_TRUE(cells.insert(cell).second);
      EXPECT_EQ(plan.cells[cell].dataset, unit.dataset);
    }
    seconds.at(static_cast<std::size_t>(unit.shard) - 1) += unit.seconds;
  }
  EXPECT_EQ(cells.size(), plan.cells.size());
  EXPECT_LE(std::ranges::max(seconds) - std::ranges::min(seconds), plan.units[0].seconds + 1e-9);
  std::size_t units = 0;
  for (const int part : {1, 2, 3}) units += units_of(plan, {part, 3}).size();
  EXPECT_EQ(units, 7U);
  for (const char* wrong : {"", "1", "0/3", "4/3", "1/0", "-1/3", "1/3x", "a/b"}) {
    EXPECT_THROW(parse_shard(wrong), InputError) << wrong;
  }
}

TEST(Plan, TheLongestUnitsComeFirstAndAPlanIsReadAsItWasWritten) {
  StudySpec spec = small_spec();
  spec.scenes.push_back({"cave", "cave", 60.0});
  const StudyPlan plan =
      make_plan(spec, configs(), ProgramCode::ask(find_program(LIDARENA_BINARY)));
  EXPECT_EQ(plan.units[0].dataset, "cave-cave-s1");
  EXPECT_TRUE(std::ranges::is_sorted(plan.units, std::ranges::greater{}, &PlanUnit::seconds));
  const TemporaryFolder scratch;
  write_plan(scratch.path(), plan);
  EXPECT_EQ(to_json(read_plan(scratch.path())), to_json(plan));
}

TEST(Plan, AnotherBaseOfASensorMakesAnotherFlight) {
  const TemporaryFolder folder;
  folder.write("base.yaml", "base: livox_mid360\nmax_range_m: 40\n");
  StudySpec spec;
  spec.scenes = {{.world = "house", .flight = "house", .seconds = 1.0}};
  spec.sensors = {folder.write("variant.yaml", "base: base.yaml\nrate_hz: 20\n").string()};
  spec.algorithms = {"kiss_icp"};
  const StudyPlan plan =
      make_plan(spec, configs(), ProgramCode::ask(find_program(LIDARENA_BINARY)));
  const PlanUnit& unit = plan.units.front();
  EXPECT_EQ(flight_key(plan, unit, configs()), unit.flight);
  folder.write("base.yaml", "base: livox_mid360\nmax_range_m: 30\n");
  EXPECT_NE(flight_key(plan, unit, configs()), unit.flight);
}

/// A study whose world and flight are files of `folder` that name others.
StudySpec spec_in(const TemporaryFolder& folder) {
  folder.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("path.tum", "0 0 0 1 0 0 0 1\n1 0 0 1 0 0 0 1\n2 0 0 1 0 0 0 1\n");
  StudySpec spec;
  spec.scenes = {{.world = folder.write("place.yaml", "kind: mesh\nfile: mesh.obj\n").string(),
                  .flight = folder.write("path.yaml", "kind: replay\nreplay: path.tum\n").string(),
                  .seconds = 1.0}};
  spec.sensors = {folder.write("near.yaml", "base: livox_mid360\nmax_range_m: 40\n").string()};
  spec.algorithms = {"kiss_icp"};
  return spec;
}

TEST(Plan, AnotherMeshOrRecordedPathMakesAnotherFlight) {
  const TemporaryFolder folder;
  const StudyPlan plan =
      make_plan(spec_in(folder), configs(), ProgramCode::ask(find_program(LIDARENA_BINARY)));
  const PlanUnit& unit = plan.units.front();
  EXPECT_EQ(flight_key(plan, unit, configs()), unit.flight);
  folder.write("mesh.obj", "v 0 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\n");
  const Json other_mesh = flight_key(plan, unit, configs());
  EXPECT_NE(other_mesh, unit.flight);
  folder.write("path.tum", "0 0 0 1 0 0 0 1\n1 0 0 2 0 0 0 1\n2 0 0 1 0 0 0 1\n");
  EXPECT_NE(flight_key(plan, unit, configs()), other_mesh);
}

TEST(Plan, ARunIsTheSameInAnyFolder) {
  const TemporaryFolder here, there;
  const auto key_of_run = [](const TemporaryFolder& folder) {
    const StudyPlan plan =
        make_plan(spec_in(folder), configs(), ProgramCode::ask(find_program(LIDARENA_BINARY)));
    return Tasks(plan, "out").run(plan.units.front(), 0).key();
  };
  EXPECT_EQ(key_of_run(here), key_of_run(there));
}

TEST(Plan, ARunIsTheSameInAStudyThatVariesMore) {
  const TemporaryFolder folder;
  const auto key_of_first_run = [&](const Json& vary) {
    StudySpec spec = spec_in(folder);
    spec.vary = vary;
    const StudyPlan plan =
        make_plan(spec, configs(), ProgramCode::ask(find_program(LIDARENA_BINARY)));
    const auto unit =
        std::ranges::find_if(plan.units, [](const PlanUnit& u) { return u.cells.front() == 0; });
    return Tasks(plan, "out").run(*unit, 0).key();
  };
  EXPECT_EQ(key_of_first_run({{"sensor.rate_hz", {20}}}),
            key_of_first_run({{"sensor.rate_hz", {5, 20}}, {"imu.rate_hz", {100}}}));
}

TEST(Plan, ADenserSensorAndALongerFlightAreExpectedToTakeMore) {
  StudySpec spec = small_spec();
  const std::vector<PlannedRun> cells = planned_cells(spec, configs());
  PlannedRun longer = cells[0];
  longer.seconds *= 2;
  const CellEstimate mid360 = estimate(spec, cells[0], configs());
  ASSERT_EQ(cells[2].sensor, "ouster_os0_128");
  EXPECT_GT(estimate(spec, cells[2], configs()).seconds, mid360.seconds);
  EXPECT_GT(estimate(spec, longer, configs()).seconds, mid360.seconds);
  EXPECT_GT(estimate(spec, longer, configs()).maps_mb, mid360.maps_mb);
  longer.seconds = 0.0;  // the whole flight, a minute
  EXPECT_GT(estimate(spec, longer, configs()).seconds, mid360.seconds);
  spec.score = {stages::ScorePart::kTrajectory};
  EXPECT_LT(estimate(spec, cells[0], configs()).seconds, mid360.seconds);
}

}  // namespace
}  // namespace lidarena::study
