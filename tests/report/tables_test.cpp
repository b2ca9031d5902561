// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "lidarena/dataset/run_events.hpp"
#include "lidarena/report/change_tables.hpp"
#include "lidarena/report/contribution_tables.hpp"
#include "lidarena/report/decision.hpp"
#include "lidarena/report/figure_tables.hpp"
#include "lidarena/report/improvement_table.hpp"
#include "lidarena/report/report_data.hpp"
#include "lidarena/report/run_command.hpp"
#include "lidarena/report/simplified_mesh.hpp"
#include "lidarena/report/summary_tables.hpp"
#include "lidarena/report/web_page.hpp"
#include "lidarena/results/study_cells.hpp"
#include "lidarena/study/study_spec.hpp"
#include "tests/results/made_up_runs.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

results::RunRecord row(const std::string& world, const std::string& sensor,
                       const std::string& algorithm, double rpe, double outliers,
                       std::uint64_t seed = 1) {
  return results::made_up::run_of(world, sensor, algorithm, rpe, outliers, seed);
}

/// The paper's own figures, as if they were our runs.
results::StudyResults results_of_the_paper() {
  const stages::ConfigFolder configs(std::string(LIDARENA_SOURCE_DIR) + "/configs");
  const auto spec = study::load_study(configs.resolve("studies", "paper"));
  results::StudyResults results =
      results::made_up::runs_of_reference(study::load_reference(spec, configs));
  results.expect = spec.expect;
  return results;
}

const results::Table& table_called(const std::vector<results::Table>& tables,
                                   const std::string& id) {
  for (const results::Table& table : tables) {
    if (table.id == id) return table;
  }
  throw std::runtime_error("no table " + id);
}

TEST(FigureTables, OneRunACellHasPublishedFiguresAndNoMarks) {
  const auto tables = figure_tables(results_of_the_paper(), "indoor");
  const results::Table& drift = table_called(tables, "drift-cave-indoor");
  ASSERT_EQ(drift.head.back(), "fast_lio2");
  const results::TableCell& best = drift.rows.at(1).back();  // Os0-128, FAST-LIO2
  EXPECT_EQ(best.text, "0.49");
  EXPECT_EQ(best.spread, "1 of 1");
  EXPECT_EQ(best.reference, "0.49");
  for (const results::Table& table : tables) {
    for (const auto& row : table.rows) {
      for (const results::TableCell& cell : row) EXPECT_FALSE(cell.bold || cell.underlined);
    }
  }
  EXPECT_THAT(drift.note, HasSubstr("here: one run a cell: no claim"));
}

/// Two worlds: two sensors and two methods whose drift differs by `factor`.
results::StudyResults seeds_of(std::uint64_t seeds, double factor) {
  results::StudyResults results;
  for (const char* world : {"house", "cave"}) {
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const double drift = 1.0 + 0.01 * static_cast<double>(seed);
      for (const char* sensor : {"dear", "cheap"}) {
        results.rows.push_back(row(world, sensor, "good", drift, 0.0, seed));
        results.rows.push_back(row(world, sensor, "bad", factor * drift, 0.0, seed));
      }
    }
  }
  return results;
}

results::StudyResults eight_seeds(double factor) { return seeds_of(8, factor); }

TEST(FigureTables, EightPairsInEachWorldMarkNoCellOfOneButGiveARatio) {
  const auto tables = figure_tables(eight_seeds(1.5), "indoor");
  const results::Table& drift = table_called(tables, "drift-cave-indoor");
  for (const auto& of_sensor : drift.rows) EXPECT_FALSE(of_sensor.at(1).underlined);
  EXPECT_THAT(drift.note, HasSubstr("here: 8 pairs: too few for a claim"));
  const results::Table& ratio = table_called(tables, "ratio-drift-dear-indoor");
  ASSERT_EQ(ratio.rows.at(0).at(0).text, "good");
  EXPECT_EQ(ratio.rows[0][2].text, "0.667");
  EXPECT_EQ(ratio.rows[0][2].spread, "0.667 to 0.667");
  EXPECT_TRUE(ratio.rows[0][2].bold) << "sixteen pairs in two worlds";
  EXPECT_EQ(ratio.rows[1][1].text, "1.50");
  EXPECT_FALSE(ratio.rows[1][1].bold);
  EXPECT_EQ(table_called(tables, "ratio-drift-good-indoor").rows.at(0).at(2).text, "1");
}

TEST(FigureTables, SixteenPairsThatPassTheTestAreMarked) {
  const auto tables = figure_tables(seeds_of(16, 1.5), "indoor");
  const results::Table& drift = table_called(tables, "drift-cave-indoor");
  for (const auto& of_sensor : drift.rows) {
    EXPECT_TRUE(of_sensor.at(1).underlined) << "good is the better method with either sensor";
    EXPECT_FALSE(of_sensor.at(2).underlined);
    EXPECT_FALSE(of_sensor.at(1).bold) << "the sensors are equal";
    EXPECT_EQ(of_sensor.at(1).spread, "1.01 to 1.16, 16 of 16");
  }
  EXPECT_THAT(drift.note, HasSubstr("here: at least 16 pairs"));
}

TEST(FigureTables, LostRunsAreInTheRangeAndTakeTheMark) {
  results::StudyResults results = seeds_of(16, 1.5);
  int lost = 0;
  for (results::RunRecord& run : results.rows) {
    if (run.sensor != "dear" || run.algorithm != "good" || run.world != "cave" || lost == 9)
      continue;
    results::made_up::lose(run);
    ++lost;
  }
  const auto tables = figure_tables(results, "indoor");
  const results::Table& drift = table_called(tables, "drift-cave-indoor");
  ASSERT_EQ(drift.rows.at(0).at(0).text, "dear");
  EXPECT_EQ(drift.rows[0][1].text, "lost") << "nine of 16";
  EXPECT_EQ(drift.rows[0][1].spread, "1.10 to lost, 7 of 16");
  EXPECT_FALSE(drift.rows[0][1].underlined);
  EXPECT_TRUE(drift.rows[1][1].underlined) << "with the cheap sensor it keeps track";
  EXPECT_EQ(table_called(tables, "increase-indoor").rows[0][1].text, "lost");
  EXPECT_EQ(table_called(tables, "increase-indoor").rows[0][1].spread, "23 of 32");
  EXPECT_EQ(table_called(tables, "increase-indoor").rows[1][1].text, "0");
  EXPECT_TRUE(table_called(tables, "drift-house-indoor").rows[0][1].underlined)
      << "what is lost in the cave says nothing of the house";
}

TEST(FigureTables, LiveTrajectoriesHaveATableWhereTheyDiffer) {
  results::StudyResults results = eight_seeds(1.5);
  const auto has_live = [&] {
    const auto tables = figure_tables(results, "indoor");
    return std::ranges::any_of(
        tables, [](const results::Table& t) { return t.id == "live-drift-cave-indoor"; });
  };
  for (results::RunRecord& run : results.rows) run.metrics->live = run.metrics->final;
  EXPECT_FALSE(has_live());
  results.rows[0].metrics->live->rpe->at_poses_1m.translation.rmse = 0.5;
  EXPECT_TRUE(has_live());
}

TEST(FigureTables, MapsOfMeansAreCalledMeans) {
  results::StudyResults results = eight_seeds(1.5);
  for (results::RunRecord& run : results.rows)
    run.manifest.emplace().own_map =
        run.algorithm == "good" ? dataset::OwnMap::kMeans : dataset::OwnMap::kReturns;
  const auto tables = figure_tables(results, "indoor");
  EXPECT_THAT(table_called(tables, "map-cave-indoor").note,
              HasSubstr("The own maps of good are means of several returns"));
  EXPECT_THAT(runs_table(results, "cave").rows.at(0).at(7).text, HasSubstr(", means"));
  EXPECT_THAT(runs_table(results, "cave").rows.at(1).at(7).text, Not(HasSubstr("means")));
  for (const Candidate& c : candidates(results, "cave"))
    EXPECT_EQ(c.own_map.text.ends_with(", means"), c.algorithm == "good") << c.own_map.text;
}

TEST(FigureTables, TheIncreaseIsDividedByTheLastWorldAsInThePaper) {
  // Only this formula gives Table 3 (3.3, 32.5, 17.9, 55.8 %) from Table 2, within its rounding.
  EXPECT_NEAR(increase_of_last(2.61, 2.70), 3.3, 0.3);
  EXPECT_NEAR(increase_of_last(1.08, 1.61), 32.5, 0.5);
  EXPECT_NEAR(increase_of_last(1.24, 1.51), 17.9, 0.4);
  EXPECT_NEAR(increase_of_last(0.49, 1.11), 55.8, 0.5);
  EXPECT_NEAR(increase(0.49, 1.11), 126.5, 0.1);
}

TEST(ExpectationsTable, HasAVerdictAndTheFiguresBehindIt) {
  results::StudyResults results = results_of_the_paper();
  const results::Table table = expectations_table(results, "indoor");
  ASSERT_EQ(table.rows.size(), 12U);
  EXPECT_EQ(table.rows[0][1].text, "holds");
  EXPECT_THAT(table.rows[0][3].text,
              HasSubstr("cave, livox_mid360_paper: 1.08 cm, against 1.78 cm of "));
  EXPECT_EQ(table.rows.back()[1].text, "cannot be judged") << "memory was not measured";
  for (results::RunRecord& run : results.rows) {
    if (run.algorithm == "ct_icp") set_metrics(run, results::made_up::metrics_of(0.1, 0.0));
  }
  const results::Table contrary = expectations_table(results, "indoor");
  EXPECT_EQ(contrary.rows[0][1].text, "falls short");
  EXPECT_THAT(contrary.rows[0][3].text, HasSubstr("Possible reason: keyframe smoothing"));
}

TEST(Timing, ModesStandBesideEachOtherAndAStudyOfOneHasNoSuchTables) {
  results::StudyResults results;
  for (const auto& [mode, rpe] : {std::pair{"rolling", 1.0}, {"frozen", 5.0}}) {
    results.rows.push_back(row("cave", "livox_mid360", "ct_icp", rpe, 2.0 * rpe));
    results.rows.back().mode = mode;
  }
  results.rows.push_back(row("cave", "livox_mid360", "kiss_icp", 9.0, 9.0));  // without a mode
  const std::vector<results::Table> tables = timing_tables(results);
  ASSERT_EQ(tables.size(), 3U);
  const results::Table& drift = table_called(tables, "modes-drift-cave-indoor");
  EXPECT_THAT(drift.head, testing::ElementsAre("sensor, algorithm", "rolling", "frozen"));
  ASSERT_EQ(drift.rows.size(), 1U);
  EXPECT_EQ(drift.rows[0][1].value, 1.0);
  EXPECT_EQ(drift.rows[0][2].value, 5.0);
  EXPECT_EQ(table_called(tables, "modes-outliers-cave-indoor").rows[0][2].value, 10.0);
  EXPECT_TRUE(timing_tables(results_of_the_paper()).empty());
}

TEST(StudyCells, MethodsWithoutPresetsAreComparedWithEveryPreset) {
  results::StudyResults results = results_of_the_paper();
  results::RunRecord ours = row("cave", "livox_mid360", "arena_lio", 0.01, 0.0);
  ours.preset = "";
  results.rows.push_back(ours);
  EXPECT_EQ(results::variants_of(results), std::vector<std::string>{"indoor"});
  EXPECT_EQ(results::StudyCells(results, "indoor").rows("cave", "livox_mid360", "arena_lio").size(),
            1U);
}

TEST(SummaryTables, AFailedRunIsARowWithItsReasonAndEveryRunHasItsCommand) {
  results::StudyResults results = results_of_the_paper();
  results.rows[2].status = "diverged";
  results.rows[2].reason = "estimate left the world";
  results.rows[2].metrics->resources.scans = 1;
  results.rows[2].metrics->resources.own.peak_bytes = 12.5e6;
  dataset::SimulationRecord& made = results.rows[0].simulation.emplace();
  made.seed = 7;
  made.new_scene = true;
  made.seconds = 20.0;
  results.rows[0].sources = {"/my worlds/cave.ply", "cave", {"livox_mid360", "ouster_os0_128"}};
  results.without_result.push_back(results.rows[0]);
  results.without_result[0].status = results::kNotFlown;
  results.without_result[0].reason = "flight: no room";
  const results::Table failures = failures_table(results);
  ASSERT_EQ(failures.rows.size(), 2U) << "a run whose map lies mostly elsewhere is not lost";
  EXPECT_EQ(failures.rows[0][2].text, "estimate left the world");
  EXPECT_EQ(failures.rows[1][1].text, "not flown");
  EXPECT_EQ(failures.rows[1][2].text, "flight: no room");
  const results::Table runs = runs_table(results, "cave");
  ASSERT_EQ(runs.rows.at(2).size(), runs.head.size());
  EXPECT_EQ(runs.rows[2][1].text, "diverged: estimate left the world");
  EXPECT_EQ(runs.rows[2].back().value, 12.5);
  EXPECT_THAT(
      commands_table(results).rows.at(0).at(1).text,
      HasSubstr(
          "lidarena simulate --world '/my worlds/cave.ply' --flight cave --sensor "
          "livox_mid360 --sensor ouster_os0_128 --seed 7 --new-scene --seconds 20.0 "
          "--no-data --hits on --out data && lidarena run ct_icp data --preset indoor --sensor "
          "livox_mid360_paper --out run && lidarena evaluate run"));
}

TEST(SummaryTables, ACommandHasAllSettingsOfItsRunAndRecordedDataStayWhereTheyAre) {
  results::RunRecord run = row("cave", "lidar", "fast_lio2", 1.0, 0.0);
  run.folder = "study/runs/one";
  dataset::RunManifest& manifest = run.manifest.emplace();
  manifest.dataset = "../../my data.bag";
  manifest.paced = true;
  manifest.config_file = "mine.yaml";
  manifest.overrides = {"map_voxel_size_m=0.3"};
  EXPECT_EQ(command_of(run),
            "lidarena run fast_lio2 'study/my data.bag' --preset indoor --config mine.yaml --set "
            "map_voxel_size_m=0.3 --paced --sensor lidar --out run && lidarena evaluate run");
  run.preset = "external";
  EXPECT_THAT(command_of(run), HasSubstr(" --external fast_lio2.yaml --sensor lidar"));
}

TEST(SummaryTables, ACommandOfALiveRunListensBesideAPlayer) {
  results::RunRecord run = row("cave", "lidar", "fast_lio2", 1.0, 0.0);
  run.folder = "runs/one";
  run.manifest.emplace().dataset = "../../data";
  run.manifest->live = true;
  EXPECT_EQ(command_of(run),
            "{ lidarena run fast_lio2 data --live --preset indoor --sensor lidar --out run & "
            "lidarena play data && wait; } && lidarena evaluate run");
  run.algorithm = "my_slam";
  run.preset = "live";
  EXPECT_EQ(command_of(run),
            "{ lidarena record --truth data --name my_slam --sensor lidar --out run & "
            "lidarena play data && wait; } && lidarena evaluate run");
}

TEST(Results, PartsOfAStudyBecomeOneAndWhatWasScoredCounts) {
  results::StudyResults one, other;
  one.title = "the study";
  one.rows = {row("cave", "s", "a", 1.0, 0.0), row("cave", "s", "b", 0.0, 0.0)};
  other.rows = {row("cave", "s", "a", 7.0, 0.0), row("cave", "s", "b", 2.0, 0.0)};
  one.without_result = {one.rows.back()};
  one.without_result[0].metrics.reset();
  one.without_result[0].status = results::kMissing;
  one.rows.pop_back();
  const results::StudyResults all = results::merged({one, other});
  EXPECT_EQ(all.title, "the study");
  ASSERT_EQ(all.rows.size(), 2U);
  EXPECT_EQ(results::value_of(all.rows[0], results::kDrift), 1.0);
  EXPECT_EQ(results::value_of(all.rows[1], results::kDrift), 2.0);
  EXPECT_TRUE(all.without_result.empty());
}

TEST(ReportData, HasTheFiguresOfEveryRunUnderTheirKeysAndTheRankingOfWhatWasTried) {
  results::StudyResults results = results_of_the_paper();
  results.rows[1].status = "diverged";
  results.rows[1].reason = "lost";
  results.rows[1].metrics.reset();
  const Json data = to_json(report_data(results, {decision_table(results, "cave")}, "."));
  ASSERT_EQ(data.at("runs").size(), results.rows.size());
  const Json& figures = data.at("figures");
  for (std::size_t i = 0; i < results.rows.size(); ++i) {
    const Json& run = data.at("runs").at(i);
    EXPECT_EQ(run.at("name"), results.rows[i].name);
    EXPECT_EQ(run.at("status"), results.rows[i].status);
    ASSERT_EQ(run.at("values").size(), figures.size());
    for (std::size_t f = 0; f < figures.size(); ++f) {
      const auto value =
          results::value_of(results.rows[i], results::figure_of(figures.at(f).at("key"), ""));
      ASSERT_EQ(run.at("values").at(f).is_null(), !value) << figures.at(f).at("key");
      if (!value) continue;
      EXPECT_NEAR(run.at("values").at(f).get<double>(), *value, 1e-5 * *value);
    }
  }
  EXPECT_EQ(data.at("tables").at(0).at("id"), "decision-cave");
  EXPECT_EQ(data.at("runs").at(1).at("lost"), "diverged: lost");
  EXPECT_EQ(data.at("decision").at("candidates").size(), results.rows.size())
      << "every cell has one run";
  EXPECT_EQ(data.at("claims").at("better").at(results::kDrift.key).size(), 0U)
      << "two pairs a cell";
  EXPECT_EQ(data.at("reference").size(), results.reference.size());
}

TEST(ReportData, SaysWhichCellsAreBetterThanWhichAndTheBoundsOfZeroShares) {
  const Json data = to_json(report_data(eight_seeds(1.5), {}, "."));
  const Json& cells = data.at("claims").at("cells");
  std::set<std::string> better;
  for (const Json& pair : data.at("claims").at("better").at(results::kDrift.key)) {
    better.insert(cells.at(pair.at(0).get<std::size_t>()).get<std::string>() + " > " +
                  cells.at(pair.at(1).get<std::size_t>()).get<std::string>());
  }
  EXPECT_THAT(better, testing::UnorderedElementsAre("cheap|good (indoor) > cheap|bad (indoor)",
                                                    "cheap|good (indoor) > dear|bad (indoor)",
                                                    "dear|good (indoor) > cheap|bad (indoor)",
                                                    "dear|good (indoor) > dear|bad (indoor)"));
  EXPECT_EQ(data.at("runs").at(0).at("zero_bounds").at("own_map_outliers"), 3.0);
}

TEST(ReportData, ACurveKeepsItsPeakAndALongStudyHasNone) {
  results::StudyResults results = results_of_the_paper();
  results.rows.resize(1);
  results::ErrorsOverTime& errors =
      results.rows[0].metrics->final->errors_over_time.emplace().ate_se3;
  for (int i = 0; i < 3000; ++i) {
    errors.t_s.push_back(0.1 * i);
    errors.translation_m.push_back(i == 1234 ? 7.5 : 0.25);
    errors.rotation_rad.push_back(0.0);
  }
  const Json curve = to_json(report_data(results, {}, ".")).at("runs").at(0).at("error");
  const auto values = curve.at("translation_m").get<std::vector<double>>();
  EXPECT_LE(values.size(), 400U);
  EXPECT_EQ(curve.at("t_s").size(), values.size());
  EXPECT_EQ(curve.at("largest_of"), 8);
  EXPECT_EQ(*std::max_element(values.begin(), values.end()), 7.5);
  results.rows.resize(6000, results.rows[0]);
  EXPECT_TRUE(to_json(report_data(results, {}, ".")).at("runs").at(0).at("error").is_null());
}

TEST(ReportData, EventsAreThoseOfTheirFileInstantsAndTheLongestFirst) {
  const TemporaryFolder folder;
  results::StudyResults results = results_of_the_paper();
  results.rows.resize(1);
  results.rows[0].folder = folder.path();
  const auto events = [&] {
    return to_json(report_data(results, {}, ".")).at("runs").at(0).at("events");
  };
  EXPECT_TRUE(events().is_null()) << "not known";
  using dataset::RunEventKind;
  dataset::write_events(folder.path() / "events.csv", {{0.5, 0.25, RunEventKind::kFastTurn, 80.0}});
  EXPECT_EQ(events(), Json::parse("[[0, 0.5, 0.25, 80.0]]"));
  std::vector<dataset::RunEvent> many;
  for (int i = 0; i < 1000; ++i)
    many.push_back(
        {1.0 * i, i % 2 == 0 ? 0.001 * (i + 1) : 0.0001, RunEventKind::kDegenerate, 1.0});
  many.push_back({2000.0, 0.0, RunEventKind::kLoop, 1.0});
  dataset::write_events(folder.path() / "events.csv", many);
  const Json kept = events();
  ASSERT_EQ(kept.size(), 400U);
  EXPECT_EQ(kept.front().at(1), 202.0) << "the 399 longest";
  EXPECT_EQ(kept.back(), Json::parse("[4, 2000.0, 0.0, 1.0]"));
  std::ofstream(folder.path() / "events.csv") << "broken";
  EXPECT_THROW(events(), InputError);
}

TEST(WebPage, NeedsNoNetworkAndTheDataCannotBreakOutOfIt) {
  if (!has_viewer()) GTEST_SKIP() << "skipped: built without the viewer (LIDARENA_WITH_VIEWER)";
  results::StudyResults results = results_of_the_paper();
  results.title = "</title><script>alert(1)</script>";
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "page.html";
  write_page(file, {results.title, "report", to_json(report_data(results, {}, folder.path())), {}});
  std::ifstream in(file);
  const std::string page((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  EXPECT_LT(page.size(), 5'000'000U) << "with hardly any run it is the page's own weight";
  EXPECT_THAT(page, HasSubstr("kiss_icp"));
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  for (const char* reach : {"src='http", "src=\"http", "href='http", "href=\"http", "@import"}) {
    EXPECT_THAT(page, Not(HasSubstr(reach)));
  }
}

TEST(SimplifiedMesh, AFinePlaneBecomesCoarseAndStaysWhereItIs) {
  world::TriangleMesh plane;
  constexpr std::uint32_t kSide = 200;
  for (std::uint32_t j = 0; j <= kSide; ++j) {
    for (std::uint32_t i = 0; i <= kSide; ++i) plane.vertices.emplace_back(0.05 * i, 0.05 * j, 1.0);
  }
  for (std::uint32_t j = 0; j < kSide; ++j) {
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const std::uint32_t a = j * (kSide + 1) + i;
      plane.triangles.push_back({a, a + 1, a + kSide + 2});
      plane.triangles.push_back({a, a + kSide + 2, a + kSide + 1});
    }
  }
  const world::TriangleMesh coarse = simplified(plane, 3000);
  EXPECT_LE(coarse.triangles.size(), 3000U);
  EXPECT_GT(coarse.triangles.size(), 300U) << "doubling the cell size leaves about a quarter";
  // vertices move by less than a cell; 3000 triangles of a 10 m square are 0.26 m wide or less than
  // twice that
  EXPECT_NEAR(coarse.area(), plane.area(), 0.15 * plane.area());
  for (const Eigen::Vector3d& v : coarse.vertices) EXPECT_DOUBLE_EQ(v.z(), 1.0);
  EXPECT_EQ(simplified(coarse, 3000).triangles, coarse.triangles);
}

TEST(ContributionTables, SayOfEachChangeWhatItsIntervalCarries) {
  results::StudyResults results;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    for (const unsigned c : {0U, 1U, 2U, 3U}) {
      const double noise = seed % 2 == 0 ? 0.4 : -0.4;  // of the second change alone
      results.rows.push_back(row("house", "mid360", "arena_lio",
                                 5.0 - 2.0 * (c & 1U) + ((c & 2U) != 0 ? noise : 0.0), 1.0, seed));
      results::RunRecord& run = results.rows.back();
      if ((c & 1U) != 0) run.differs.emplace_back("field");
      if ((c & 2U) != 0) run.differs.emplace_back("IMU");
      for (const std::string& name : run.differs)
        run.variation += (run.variation.empty() ? "" : " + ") + name;
    }
  }
  const auto tables = contribution_tables(shown_contributions(results));
  ASSERT_FALSE(tables.empty());
  const results::Table& drift = tables.front();
  EXPECT_EQ(drift.id, "contributions-rpe_1m_at_poses_translation-house");
  ASSERT_EQ(drift.rows.size(), 4U);
  EXPECT_EQ(drift.rows[0][1].text, "5");
  EXPECT_EQ(drift.rows[1][0].text, "field");
  EXPECT_EQ(drift.rows[1][1].text, "-2");
  EXPECT_TRUE(drift.rows[1][1].bold);
  EXPECT_FALSE(drift.rows[2][1].bold);
  EXPECT_EQ(drift.rows[3][1].text, "3");
  EXPECT_THAT(drift.note, HasSubstr("8 flights; better with field; worse with none; open: IMU."));

  const ReportData data = report_data(results, tables, ".");
  ASSERT_FALSE(data.contributions.empty());
  EXPECT_EQ(data.contributions.front().parts.front().name, "field");
  EXPECT_NEAR(data.contributions.front().parts.front().value, -2.0, 1e-9);
}

TEST(ChangeTables, RankVariationsAndSayWhatTheirIntervalsCarry) {
  results::StudyResults results;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const double noise = seed % 2 == 0 ? 0.4 : -0.4;
    const std::vector<std::pair<std::string, double>> drifts{
        {"", 5.0}, {"cheap IMU", 6.0}, {"paint", 5.0 + noise}, {"shots", 3.0}};
    for (const auto& [variation, drift] : drifts) {
      results.rows.push_back(row("house", "mid360", "arena_lio", drift, 1.0, seed));
      results.rows.back().variation = variation;
      if (!variation.empty()) results.rows.back().differs = {variation};
    }
  }
  const auto tables = change_tables(shown_changes(results));
  ASSERT_FALSE(tables.empty());
  const results::Table& drift = tables.front();
  EXPECT_EQ(drift.id, "ranking-rpe_1m_at_poses_translation-house");
  ASSERT_EQ(drift.rows.size(), 3U);
  EXPECT_EQ(drift.rows[0][0].text, "shots");
  EXPECT_EQ(drift.rows[0][1].text, "-2");
  EXPECT_TRUE(drift.rows[0][1].bold);
  EXPECT_EQ(drift.rows[1][0].text, "paint");
  EXPECT_FALSE(drift.rows[1][1].bold);
  EXPECT_EQ(drift.rows[2][1].text, "+1");
  EXPECT_THAT(drift.note, HasSubstr("better: shots; worse: cheap IMU; neither is shown: paint."));

  const ReportData data = report_data(results, tables, ".");
  ASSERT_FALSE(data.changes.empty());
  EXPECT_EQ(data.changes.front().flights, 8U);
  EXPECT_LT(data.changes.front().low.value(), data.changes.front().high.value() + 1e-9);
}

TEST(ImprovementTable, SaysWhichStepsHelpAndWhichHelpOnlyTogether) {
  results::StudyResults results;
  const auto add = [&](const std::vector<std::string>& steps, std::uint64_t seed, double drift) {
    results.rows.push_back(row("house", "mid360", "arena_lio", drift, 1.0, seed));
    results::RunRecord& run = results.rows.back();
    run.differs = steps;
    for (const std::string& name : steps)
      run.variation += (run.variation.empty() ? "" : " + ") + name;
  };
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const double base = 4.0 + 0.1 * static_cast<double>(seed);
    const double noise = seed % 2 == 0 ? 0.05 : -0.05;
    add({}, seed, base);
    add({"cheap"}, seed, base + noise);
    add({"IMU"}, seed, base - noise);
    add({"field"}, seed, base - 1.0 + noise);
    add({"worse"}, seed, base + 0.5);
    add({"cheap", "IMU"}, seed, base - 0.7 + noise);
  }
  const Improvement made = improvement_of(
      results, {{"cheap", "A"}, {"IMU", "B"}, {"field", "data sheet"}, {"worse", "D"}});
  ASSERT_EQ(made.table.rows.size(), 6U);
  EXPECT_EQ(made.table.rows[3][0].text, "field");
  // The columns are live drift (not known here), drift, map, result, source.
  EXPECT_NEAR(*made.table.rows[3][2].value, -1.0, 1e-9);
  EXPECT_TRUE(made.table.rows[3][2].bold);
  EXPECT_FALSE(made.table.rows[1][2].bold);
  EXPECT_EQ(made.table.rows[3][5].text, "data sheet");
  EXPECT_THAT(made.words,
              ::testing::IsSupersetOf(
                  {std::string("helps: field"), std::string("cheapest step that helps: field"),
                   std::string("no gain seen: cheap, IMU"), std::string("harms some figure: worse"),
                   std::string("helps only together: cheap + IMU")}));
}

TEST(ImprovementTable, ClaimsNothingFromTwoFlights) {
  results::StudyResults results;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    results.rows.push_back(row("house", "mid360", "arena_lio", 4.0, 1.0, seed));
    results.rows.push_back(row("house", "mid360", "arena_lio", 1.0, 1.0, seed));
    results.rows.back().variation = "field";
    results.rows.back().differs = {"field"};
  }
  const Improvement made = improvement_of(results, {{"field", "data sheet"}});
  EXPECT_NEAR(*made.table.rows[1][2].value, -3.0, 1e-9);
  EXPECT_EQ(made.table.rows[1][2].spread, "");
  EXPECT_EQ(made.words.front(), "helps: none");
}

}  // namespace
}  // namespace lidarena::report
