// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/page_scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "tests/results/made_up_runs.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::report {
namespace {

using ::testing::ElementsAre;

constexpr const char* kPath = "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n";

/// Studies whose runs have files.
class PageScenes : public ::testing::Test {
 protected:
  results::RunRecord& add(const std::string& sensor, const std::string& algorithm,
                          std::uint64_t seed, std::size_t points) {
    results_.rows.push_back(results::made_up::run_of("cave", sensor, algorithm, 1.0, 0.0, seed));
    results::RunRecord& run = results_.rows.back();
    run.folder = folder_.path() / run.name;
    run.manifest.emplace().dataset = "../flight";
    run.manifest->algorithm = algorithm;
    folder_.write(run.name + "/trajectory.tum", kPath);
    folder_.write("flight/truth.tum", kPath);
    dataset::write_run_manifest(run.folder, *run.manifest);
    dataset::Cloud cloud;
    for (std::size_t i = 0; i < points; ++i)
      cloud.points.emplace_back(0.01F * static_cast<float>(i % 1000), 0.0F, 0.0F);
    cloud.distance.assign(points, 0.25F);
    dataset::write_ply(run.folder / "scored.ply", cloud);
    return run;
  }
  static std::vector<std::string> names(const Json& items) {
    std::vector<std::string> list;
    for (const Json& item : items) list.push_back(item.at("name"));
    return list;
  }
  std::vector<PackedScene> scenes() { return page_scenes(results_, Parallel(1), log_); }

  TemporaryFolder folder_;
  results::StudyResults results_;
  LogSink log_;
};

TEST_F(PageScenes, ShowTheFirstRunOfEachCellThatWentWellAndTheTruthOnce) {
  add("dear", "good", 1, 50).status = "diverged";
  add("dear", "good", 2, 50);
  add("dear", "good", 3, 50);
  add("dear", "lost", 1, 50).status = "diverged";
  const std::vector<PackedScene> packed = scenes();
  ASSERT_EQ(packed.size(), 1U);
  EXPECT_EQ(packed[0].header.at("title"), "cave");
  EXPECT_THAT(names(packed[0].header.at("clouds")),
              ElementsAre("cave-dear-good-2", "cave-dear-lost-1"));
  EXPECT_THAT(names(packed[0].header.at("paths")),
              ElementsAre("truth of flight", "cave-dear-good-2", "cave-dear-lost-1"));
}

TEST_F(PageScenes, HaveTheScanOfEachSensorAsItIsAndAsMeasured) {
  add("dear", "good", 1, 50);
  dataset::Cloud scan;
  scan.points.assign(9, Eigen::Vector3f(1, 2, 3));
  dataset::write_ply(folder_.path() / "flight" / "dear_scan.ply", scan);
  dataset::write_ply(folder_.path() / "flight" / "dear_scan_skewed.ply", scan);
  EXPECT_THAT(names(scenes().at(0).header.at("clouds")),
              ElementsAre("cave-dear-good-1", "scan dear", "skewed dear"));
}

TEST_F(PageScenes, ThinLargeMapsAndLeaveOutAStudyWithoutAny) {
  EXPECT_TRUE(scenes().empty());
  add("dear", "good", 1, 90'000);
  const Json cloud = scenes().at(0).header.at("clouds").at(0);
  EXPECT_NEAR(cloud.at("points").get<double>(), 40'000.0, 1'000.0);
  EXPECT_EQ(cloud.at("points").get<std::size_t>() + cloud.at("left_out").get<std::size_t>(),
            90'000U);
}

}  // namespace
}  // namespace lidarena::report
