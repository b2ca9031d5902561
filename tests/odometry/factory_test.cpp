// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/factory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "lidarena/base/error.hpp"
#include "lidarena/odometry/arena_lio/config.hpp"
#include "lidarena/odometry/arena_lo/config.hpp"
#include "lidarena/odometry/ct_icp/config.hpp"
#include "lidarena/odometry/fast_lio2/config.hpp"
#include "lidarena/odometry/kiss_icp/config.hpp"
#include "lidarena/odometry/lio_sam/config.hpp"
#include "tests/odometry/synthetic_room.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::odometry {
namespace {

using testing::AllOf;
using testing::HasSubstr;

MadeOdometry make(const OdometryRequest& request, const std::string& lidar = "lidar") {
  return make_odometry(request, synthetic::rig_of({}), lidar, Parallel(1));
}

std::string refusal(const OdometryRequest& request, const std::string& lidar = "lidar") {
  try {
    make(request, lidar);
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

TEST(OdometryFactory, MakesEveryPresetOfEveryAlgorithmAndTheConfigurationMakesItAgain) {
  const TemporaryFolder folder;
  for (const AlgorithmInfo& info : list_algorithms()) {
    EXPECT_FALSE(info.summary.empty());
    // Our own have none, nor has the KISS-ICP of 2025, which is as its program ships it.
    const bool single = info.name.starts_with("arena") || info.name.starts_with("kiss_icp_head");
    EXPECT_EQ(info.presets.empty(), single) << info.name;
    if (!single && !info.presets.empty()) {
      EXPECT_EQ(info.presets.front(), "indoor") << info.name;
    }
    std::vector<std::string> presets = info.presets;
    presets.push_back("");
    for (const std::string& preset : presets) {
      const MadeOdometry made = make({info.name, preset, "", {}});
      ASSERT_NE(made.odometry, nullptr);
      EXPECT_EQ(made.odometry->traits().needs_imu, info.needs_imu);
      const auto file = folder.write(preset + ".yaml", made.config.dump(2));
      EXPECT_EQ(make({info.name, "", file.string(), {}}).config, made.config);
    }
  }
}

TEST(OdometryFactory, OverridesWinOverTheFileAndTheFileOverThePreset) {
  const TemporaryFolder folder;
  const auto file = folder.write("kiss.yaml", "voxel_size_m: 0.4\nmax_iterations: 7\n");
  const Json config =
      make({"kiss_icp", "published", file.string(), {"max_iterations=9", "deskew=false"}}).config;
  EXPECT_EQ(config.at("voxel_size_m"), 0.4);
  EXPECT_EQ(config.at("max_iterations"), 9);
  EXPECT_EQ(config.at("deskew"), false);
  EXPECT_EQ(config.at("max_range_m"), 100.0);
}

TEST(OdometryFactory, TheSchemasDefaultsAreThoseOfTheDefaultPreset) {
  const Json kiss = algorithm_schema("kiss_icp").at("properties");
  EXPECT_EQ(kiss.at("max_range_m").at("default"), 50.0);
  const auto expect_defaults = [](const std::string& algorithm, const Json& preset) {
    const Json properties = algorithm_schema(algorithm).at("properties");
    for (const auto& [key, value] : preset.items())
      EXPECT_EQ(properties.at(key).at("default"), value) << algorithm << " " << key;
  };
  const LidarInfo unknown;
  expect_defaults("kiss_icp", to_json(kiss_icp::indoor(unknown)));
  expect_defaults("ct_icp", to_json(ct_icp::indoor(unknown)));
  expect_defaults("fast_lio2", to_json(fast_lio2::indoor(unknown)));
  expect_defaults("lio_sam", to_json(lio_sam::indoor(unknown)));
  expect_defaults("arena_lo", to_json(arena_lo::settings_for(unknown)));
  expect_defaults("arena_lio", to_json(arena_lio::settings_for(unknown)));
}

TEST(OdometryFactory, RefusalsNameTheNearestWord) {
  EXPECT_THAT(refusal({"kis_icp", "indoor", "", {}}), HasSubstr("did you mean 'kiss_icp'"));
  EXPECT_THAT(refusal({"orb_slam", "indoor", "", {}}),
              AllOf(HasSubstr("orb_slam"), HasSubstr("use one of")));
  EXPECT_THAT(refusal({"kiss_icp", "publised", "", {}}), HasSubstr("use one of indoor, published"));
  EXPECT_THAT(refusal({"kiss_icp", "published", "", {"voxel_size=1"}}),
              HasSubstr("did you mean 'voxel_size_m'"));
  EXPECT_THAT(refusal({"kiss_icp", "published", "", {"voxel_size_m=-1"}}), HasSubstr("above 0"));
  EXPECT_THAT(refusal({"kiss_icp", "published", "/no/such.yaml", {}}), HasSubstr("/no/such.yaml"));
  EXPECT_THAT(refusal({"kiss_icp", "published", "", {}}, "os0"),
              AllOf(HasSubstr("os0"), HasSubstr("use one of lidar")));
}

TEST(OdometryFactory, AFormerPresetIsRefusedWithItsSuccessor) {
  EXPECT_THAT(refusal({"kiss_icp", "original", "", {}}), HasSubstr("the preset published"));
  EXPECT_THAT(refusal({"kiss_icp", "improved", "", {}}), HasSubstr("arena_lo"));
  EXPECT_THAT(refusal({"kiss_icp", "head", "", {}}), HasSubstr("the method kiss_icp_head"));
  EXPECT_THAT(refusal({"arena_lio", "improved", "", {}}), HasSubstr("leave it out"));
}

TEST(OdometryFactory, TheDefaultPresetIsNamedWhereThereIsOne) {
  EXPECT_EQ(with_default_preset({.algorithm = "kiss_icp"}).preset, "indoor");
  EXPECT_EQ(with_default_preset({.algorithm = "kiss_icp", .preset = "published"}).preset,
            "published");
  EXPECT_EQ(with_default_preset({.algorithm = "arena_lo"}).preset, "");
  EXPECT_EQ(with_default_preset({.algorithm = "not_ours"}).preset, "");
}

TEST(OdometryFactory, TheOnlyLidarNeedsNoNameAndAmongSeveralOneMustBeChosen) {
  Rig rig = synthetic::rig_of({});
  EXPECT_NE(make_odometry({.algorithm = "kiss_icp"}, rig, "", Parallel(1)).odometry, nullptr);
  rig.lidars.push_back(rig.lidars.front());
  rig.lidars.back().id = "second";
  EXPECT_THROW(make_odometry({.algorithm = "kiss_icp"}, rig, "", Parallel(1)), InputError);
  EXPECT_NE(make_odometry({.algorithm = "kiss_icp"}, rig, "second", Parallel(1)).odometry, nullptr);
  EXPECT_THROW(make_odometry({.algorithm = "kiss_icp"}, Rig{}, "", Parallel(1)), InputError);
}

TEST(OdometryFactory, EveryConfigurationFileOfTheRepositoryFitsTheAlgorithmItIsNamedAfter) {
  const std::filesystem::path folder =
      std::filesystem::path(LIDARENA_SOURCE_DIR) / "configs/odometry";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    const std::string stem = entry.path().stem().string();
    std::string algorithm;  // the longest algorithm name with which the file name begins
    for (const AlgorithmInfo& info : list_algorithms()) {
      if (stem.starts_with(info.name) && info.name.size() > algorithm.size()) algorithm = info.name;
    }
    ASSERT_FALSE(algorithm.empty()) << stem;
    EXPECT_NO_THROW(make({algorithm, "", entry.path().string(), {}})) << stem;
  }
}

/// The presets `tuned` are the winners of the search that docs/results/tuning tells.
TEST(Factory, TunedPresetsAreTheSettingsThatWonTheSearch) {
  std::ifstream file(std::string(LIDARENA_SOURCE_DIR) + "/docs/results/tuning/plan.json");
  const Json plan = Json::parse(file);
  const std::map<std::string, std::string> winners{{"ct_icp", "ct_icp-16"},
                                                   {"kiss_icp", "kiss_icp-27"},
                                                   {"lio_sam", "lio_sam-08"},
                                                   {"fast_lio2", "fast_lio2-19"}};
  for (const auto& [name, winner] : winners) {
    const auto found = std::ranges::find_if(
        plan.at("settings"), [&](const Json& setting) { return setting.at("as") == winner; });
    ASSERT_NE(found, plan.at("settings").end());
    const std::string method = found->at("name");
    OdometryRequest request{name, method.substr(method.find(':') + 1)};
    const Json set = found->value("set", Json::object());
    for (const auto& [key, value] : set.items())
      request.overrides.push_back(key + "=" +
                                  (value.is_string() ? value.get<std::string>() : value.dump()));
    for (const char* kind : {"rosette", "spinning"}) {
      LidarInfo lidar;
      lidar.kind = kind;
      EXPECT_EQ(configuration_of({name, "tuned"}, lidar), configuration_of(request, lidar)) << name;
    }
    EXPECT_EQ(parts_of({name, "tuned"}), found->value("parts", 1)) << name;
  }
  EXPECT_EQ(parts_of({"lio_sam_lc", "tuned"}), 2);
  EXPECT_EQ(parts_of({"kiss_icp", ""}), 1);
}

}  // namespace
}  // namespace lidarena::odometry
