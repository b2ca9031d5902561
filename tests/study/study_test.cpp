// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <set>

#include "lidarena/study/isolate.hpp"

namespace lidarena {
namespace {

using ::testing::HasSubstr;

ConfigFolder configs() { return ConfigFolder(std::string(LIDARENA_SOURCE_DIR) + "/configs"); }

TEST(Isolate, WorkThatSucceedsLeavesNoReason) {
  const IsolatedOutcome outcome = run_isolated([] {});
  EXPECT_TRUE(outcome.ok);
  EXPECT_EQ(outcome.reason, "");
}

TEST(Isolate, AnExceptionACrashAndAnExitAreReasonsNotTheEnd) {
  const IsolatedOutcome thrown = run_isolated([] { throw InputError("file", "is broken"); });
  EXPECT_FALSE(thrown.ok);
  EXPECT_EQ(thrown.reason, "file: is broken");
  const IsolatedOutcome killed = run_isolated([] { std::raise(SIGKILL); });
  EXPECT_FALSE(killed.ok);
  EXPECT_THAT(killed.reason, HasSubstr("signal 9"));
  EXPECT_THAT(killed.reason, HasSubstr("out of memory"));
  EXPECT_THAT(run_isolated([] { _Exit(7); }).reason, HasSubstr("exit code 7"));
}

TEST(ConfigFolder, NamesResolveAndAMisspeltOneIsCorrected) {
  EXPECT_EQ(configs().resolve("studies", "quick").filename(), "quick.yaml");
  try {
    configs().resolve("studies", "quikc");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("did you mean 'quick'?"));
  }
  EXPECT_THROW(ConfigFolder::find("/"), InputError);
}

StudySpec small_spec() {
  StudySpec spec;
  spec.scenes = {{"house", "house", 5.0}};
  spec.sensors = {"livox_mid360", "ouster_os0_128"};
  spec.algorithms = {"kiss_icp", "kiss_icp:head"};
  spec.seeds = {1, 2};
  return spec;
}

TEST(Plan, EveryCellOfTheMatrixIsPlannedOnceUnderANameOfItsOwn) {
  const std::vector<PlannedRun> cells = plan(small_spec(), configs());
  ASSERT_EQ(cells.size(), 8U);
  EXPECT_EQ(cells[0].name, "house-house-s1-livox_mid360-kiss_icp-improved");
  EXPECT_EQ(cells[1].preset, "head");
  std::set<std::string> names;
  std::set<std::string> datasets;
  for (const PlannedRun& cell : cells) {
    names.insert(cell.name);
    datasets.insert(cell.dataset);
  }
  EXPECT_EQ(names.size(), 8U);
  EXPECT_EQ(datasets.size(), 2U) << "one flight per seed, shared by sensors and algorithms";
}

TEST(Plan, AnUnknownNameIsRefusedBeforeAnyWorkStarts) {
  const auto error = [](auto change) {
    StudySpec spec = small_spec();
    change(spec);
    try {
      plan(spec, configs());
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
}

}  // namespace
}  // namespace lidarena
