// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/run_record.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lidarena/dataset/json_file.hpp"
#include "tests/results/made_up_runs.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::results {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(ResultsCsv, ARowNamesItsVariationAlsoWhereSetsAloneAreVaried) {
  StudyResults results;
  results.rows = {made_up::run_of("cave", "mid", "odo", 1.0, 0.0),
                  made_up::run_of("cave", "mid", "odo", 2.0, 0.0)};
  EXPECT_THAT(results_csv(results), Not(HasSubstr("variation")));
  results.rows[1].variation = "cheap IMU";
  EXPECT_THAT(results_csv(results), HasSubstr(",variation\n"));
  EXPECT_THAT(results_csv(results), HasSubstr(",cheap IMU\n"));
}

/// A study of three runs in a folder: `first` failed for this reason, `second` for its own, `third`
/// has no files.
StudyResults study_with(const std::filesystem::path& folder, const std::string& reason_of_first) {
  Json runs = Json::array();
  for (const std::string name : {"first", "second", "third"})
    runs.push_back({{"name", name},
                    {"world", "cave"},
                    {"flight", "cave"},
                    {"sensor", "mid"},
                    {"algorithm", "odo"},
                    {"preset", ""},
                    {"seed", 1}});
  std::filesystem::create_directories(folder);
  dataset::write_json(folder / "plan.json", {{"spec", {{"title", "T"}}}, {"runs", runs}});
  dataset::RunManifest manifest;
  manifest.status = dataset::RunStatus::kFailed;
  for (const auto& [name, reason] : {std::pair{"first", reason_of_first.c_str()},
                                     std::pair{"second", "exit code 1"}}) {
    std::filesystem::create_directories(folder / "runs" / name);
    manifest.reason = reason;
    dataset::write_run_manifest(folder / "runs" / name, manifest);
  }
  return read_results(folder);
}

TEST(ReadResults, ARunThatIsMissingOrWasNotFlownIsNoRunOfItsMethod) {
  const TemporaryFolder folder;
  const StudyResults results = study_with(folder.path() / "a", "flight: no place for a start");
  ASSERT_EQ(results.rows.size(), 1U);
  EXPECT_EQ(results.rows[0].name, "second");
  ASSERT_EQ(results.without_result.size(), 2U);
  EXPECT_EQ(results.without_result[0].status, "not flown");
  EXPECT_EQ(results.without_result[1].status, "missing");
  EXPECT_THAT(results_csv(results),
              AllOf(HasSubstr("first,cave,cave,mid,odo,,,1,not flown,flight: no"),
                    HasSubstr("third,cave,cave,mid,odo,,,1,missing,the run has no results yet")));
  EXPECT_THAT(results_text(results), HasSubstr("not flown: flight: no place for a start"));
  EXPECT_EQ(merged({results, results}).without_result.size(), 2U);
  StudyResults flown_elsewhere = results;
  flown_elsewhere.rows[0].name = "first";
  ASSERT_EQ(merged({results, flown_elsewhere}).without_result.size(), 1U);
  EXPECT_EQ(merged({results, flown_elsewhere}).without_result[0].name, "third");
  EXPECT_EQ(study_with(folder.path() / "b", "exit code 1").rows.size(), 2U)
      << "the method's own failure is lost";
}

TEST(ReadResults, NotFlownIsKnownBetterThanMissing) {
  StudyResults planned, tried;
  planned.without_result = {made_up::run_of("cave", "mid", "odo", 1.0, 0.0)};
  planned.without_result[0].status = kMissing;
  tried.without_result = planned.without_result;
  tried.without_result[0].status = kNotFlown;
  const StudyResults both = merged({planned, tried});
  ASSERT_EQ(both.without_result.size(), 1U);
  EXPECT_EQ(both.without_result[0].status, kNotFlown);
}

}  // namespace
}  // namespace lidarena::results
