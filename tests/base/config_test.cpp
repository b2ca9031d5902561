// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/rig.hpp"

namespace lidarena {

enum class Color { kRed, kBlue };
constexpr auto enum_names(Color) {
  return std::array{std::pair{"red", Color::kRed}, std::pair{"blue", Color::kBlue}};
}

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct Inner {
  double voxel_size_m = 0.5;
  int count = 3;
  static constexpr RenamedKey renamed_keys[] = {{"leaf_m", "voxel_size_m"}};
  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("voxel_size_m", self.voxel_size_m, "m", "edge of a cell", above(0));
    v("count", self.count, "", "how many", between(1, 10));
  }
};

struct Outer {
  bool deskew = true;
  Color color = Color::kRed;
  std::string name = "x";
  std::vector<double> list{1, 2};
  Eigen::Vector3d offset{0, 0, 0};
  std::optional<double> threshold;
  Inner inner;
  Pose pose = Pose::Identity();
  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("deskew", self.deskew, "", "");
    v("color", self.color, "", "");
    v("name", self.name, "", "");
    v("list", self.list, "", "");
    v("offset", self.offset, "m", "");
    v("threshold", self.threshold, "m", "");
    v("inner", self.inner, "", "");
    v("pose", self.pose, "", "");
  }
};

Outer parse(const std::string& yaml) {
  Outer config;
  read_config(ConfigNode::parse(yaml, "test.yaml"), config);
  return config;
}

std::string error_of(const std::string& yaml) {
  try {
    parse(yaml);
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

TEST(Config, NamedKeysReplaceDefaultsAndTheRestStays) {
  const Outer c = parse(
      "deskew: false\ncolor: blue\nlist: [3, 4, 5]\noffset: [1, 2, 3]\nthreshold: 0.25\n"
      "inner: {count: 7}\npose: [1, 2, 3, 0, 0, 1, 0]\n");
  EXPECT_FALSE(c.deskew);
  EXPECT_EQ(c.color, Color::kBlue);
  EXPECT_EQ(c.name, "x");
  EXPECT_EQ(c.list.size(), 3U);
  EXPECT_EQ(c.offset, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(c.threshold, 0.25);
  EXPECT_EQ(c.inner.count, 7);
  EXPECT_EQ(c.inner.voxel_size_m, 0.5);
  EXPECT_NEAR(c.pose.linear()(0, 0), -1.0, 1e-12);  // half a turn about z
  EXPECT_EQ(parse("").name, "x");
}

TEST(Config, AnUnknownKeyNamesFileLineAndTheNearestValidKey) {
  EXPECT_THAT(error_of("deskew: true\ninner:\n  voxel_sise_m: 1\n"),
              AllOf(HasSubstr("test.yaml:3"), HasSubstr("unknown key 'voxel_sise_m'"),
                    HasSubstr("did you mean 'voxel_size_m'?")));
  EXPECT_THAT(error_of("wholly_else: 1\n"), HasSubstr("valid keys: deskew, color"));
}

TEST(Config, WrongTypesRangesChoicesAndDuplicatesAreErrorsWithTheirPlace) {
  EXPECT_THAT(error_of("inner: {count: 11}"),
              AllOf(HasSubstr("test.yaml:1: inner.count"), HasSubstr("11 is out of range"),
                    HasSubstr("at least 1 and at most 10")));
  EXPECT_THAT(error_of("inner: {voxel_size_m: 0}"), HasSubstr("above 0"));
  EXPECT_THAT(error_of("inner: {count: 2.5}"), HasSubstr("not an integer"));
  EXPECT_THAT(error_of("inner: 5"), HasSubstr("a map"));
  EXPECT_THAT(error_of("threshold: .nan"), HasSubstr("not a finite number"));
  EXPECT_THAT(error_of("deskew: maybe"), HasSubstr("not a boolean"));
  EXPECT_THAT(error_of("color: green"), HasSubstr("use one of red, blue"));
  EXPECT_THAT(error_of("offset: [1, 2]"), HasSubstr("2 numbers"));
  EXPECT_THAT(error_of("pose: [0,0,0, 0,0,0,2]"), HasSubstr("norm 2"));
  EXPECT_THAT(error_of("name: a\nname: b\n"), HasSubstr("second time"));
  EXPECT_THAT(error_of("name: [a\n"), HasSubstr("not valid YAML"));
}

TEST(Config, WhatIsSavedAsJsonIsReadBackTheSame) {
  Outer c = parse("offset: [0.1, 0.2, 0.30000000000000004]\ncolor: blue\nthreshold: 1.5\n");
  const std::string text = to_json(c).dump();
  const Outer back = parse(text);
  EXPECT_EQ(to_json(back).dump(), text);
  EXPECT_EQ(back.offset, c.offset);
}

TEST(Config, AnAssignmentSetsANestedField) {
  Outer c;
  set_field(c, "inner.count=9");
  set_field(c, "name=hello");
  EXPECT_EQ(c.inner.count, 9);
  EXPECT_EQ(c.name, "hello");
  EXPECT_THROW(set_field(c, "inner.cuont=9"), InputError);
  EXPECT_THROW(set_field(c, "nothing"), InputError);
}

TEST(Config, AMissingFileIsNamed) {
  try {
    load_config<Outer>("no/such.yaml");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("no/such.yaml: cannot be opened"));
  }
}

TEST(Config, ARigSurvivesItsJson) {
  Rig rig;
  rig.lidars.push_back({.id = "mid360",
                        .model = "livox_mid360",
                        .kind = "rosette",
                        .rows = 4,
                        .pixel_shifts = {12, 4, -4, -12}});
  rig.lidars[0].body_from_lidar.translation() = Eigen::Vector3d(0, 0, 0.1);
  rig.imus.push_back({.id = "mid360_imu", .model = "", .rate_hz = 200});
  Rig back;
  read_config(ConfigNode::parse(to_json(rig).dump(), "manifest"), back);
  ASSERT_NE(back.find_lidar("mid360"), nullptr);
  EXPECT_EQ(back.find_lidar("")->rows, 4);
  EXPECT_EQ(back.find_lidar("")->pixel_shifts, rig.lidars[0].pixel_shifts);
  EXPECT_EQ(back.find_lidar("")->body_from_lidar.translation().z(), 0.1);
  EXPECT_EQ(back.imus.at(0).rate_hz, 200);
  EXPECT_EQ(back.find_lidar("os0"), nullptr);
}

TEST(Config, AFormerKeyIsRefusedWithTheNewOne) {
  EXPECT_THAT(error_of("inner:\n  leaf_m: 0.3\n"),
              AllOf(HasSubstr("test.yaml:2"), HasSubstr("'leaf_m'"), HasSubstr("'voxel_size_m'")));
}

}  // namespace
}  // namespace lidarena
