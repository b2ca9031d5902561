// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/run_record.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/results/made_up_runs.hpp"

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

}  // namespace
}  // namespace lidarena::results
