// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/run_record.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lidarena/dataset/json_file.hpp"
#include "tests/results/made_up_runs.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::results {
namespace {

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

/// A study of two runs in a folder, of which `first` failed for this reason.
StudyResults study_with(const std::filesystem::path& folder, const std::string& first,
                        const std::string& reason) {
  Json runs = Json::array();
  for (const std::string name : {"first", "second"})
    runs.push_back({{"name", name},
                    {"world", "cave"},
                    {"flight", "cave"},
                    {"sensor", "mid"},
                    {"algorithm", "odo"},
                    {"preset", ""},
                    {"seed", 1}});
  std::filesystem::create_directories(folder / "runs" / first);
  dataset::write_json(folder / "plan.json", {{"spec", {{"title", "T"}}}, {"runs", runs}});
  dataset::RunManifest manifest;
  manifest.status = dataset::RunStatus::kFailed;
  manifest.reason = reason;
  dataset::write_run_manifest(folder / "runs" / first, manifest);
  return read_results(folder);
}

TEST(ReadResults, ARunThatWasNotFlownIsNoRunOfItsMethod) {
  const TemporaryFolder folder;
  const StudyResults results = study_with(folder.path(), "first", "flight: no place for a start");
  ASSERT_EQ(results.rows.size(), 1U);
  EXPECT_EQ(results.rows[0].name, "second");
  ASSERT_EQ(results.not_flown.size(), 1U);
  EXPECT_EQ(results.not_flown[0].status, "not flown");
  EXPECT_THAT(results_csv(results), HasSubstr("first,cave,cave,mid,odo,,,1,not flown,flight: no"));
  EXPECT_THAT(results_text(results), HasSubstr("not flown: flight: no place for a start"));
  EXPECT_EQ(merged({results, results}).not_flown.size(), 1U);
  StudyResults flown_elsewhere = results;
  flown_elsewhere.rows[0].name = "first";
  EXPECT_TRUE(merged({results, flown_elsewhere}).not_flown.empty());
  EXPECT_EQ(study_with(folder.path(), "first", "exit code 1").rows.size(), 2U)
      << "the method's own failure is lost";
}

}  // namespace
}  // namespace lidarena::results
