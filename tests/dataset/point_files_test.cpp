// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/dataset/points/lzf.hpp"
#include "lidarena/dataset/points/pcd.hpp"
#include "lidarena/dataset/points/ply.hpp"
#include "lidarena/dataset/points/point_table.hpp"
#include "tests/dataset/file_helpers.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

class PointFile : public testing::Test {
 protected:
  std::filesystem::path put(const char* name, std::string_view bytes) const {
    return folder_.write(name, bytes);
  }
  std::string error_of(const char* name, std::string_view bytes) const {
    return input_error([&] { read_cloud(put(name, bytes)); });
  }
  TemporaryFolder folder_;
};

using Ply = PointFile;
using Pcd = PointFile;

std::string ply_header(std::string_view format, std::string_view body) {
  return fmt::format("ply\nformat {} 1.0\ncomment made by hand\n{}end_header\n", format, body);
}

constexpr const char* kXyz = "property float x\nproperty float y\nproperty float z\n";

std::string pcd_header(std::string_view fields, std::string_view sizes, std::string_view types,
                       std::string_view counts, std::size_t points, std::string_view data) {
  return fmt::format(
      "# .PCD v0.7\nVERSION 0.7\nFIELDS {}\nSIZE {}\nTYPE {}\nCOUNT {}\nWIDTH {}\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA {}\n",
      fields, sizes, types, counts, points, points, data);
}

/// LZF data that consist of literals only.
std::string as_literals(std::string_view bytes) {
  std::string out;
  for (; !bytes.empty(); bytes.remove_prefix(std::min<std::size_t>(32, bytes.size()))) {
    const auto run = bytes.substr(0, 32);
    out += static_cast<char>(run.size() - 1);
    out += run;
  }
  return out;
}

bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

TEST_F(PointFile, CloudsComeBackBitForBitFromPlyAndPcd) {
  Cloud cloud;
  for (int i = 0; i < 10'000; ++i) {
    const auto f = static_cast<float>(i);
    cloud.points.emplace_back(0.1F * f, -f * f, std::sqrt(f));
    cloud.intensity.push_back(f / 3.0F);
  }
  cloud.points[17].y() = kNan;
  cloud.points[18].x() = -std::numeric_limits<float>::infinity();
  const auto ply = folder_.path() / "c.ply";
  const auto pcd = folder_.path() / "c.pcd";
  write_ply(ply, cloud);
  write_pcd(pcd, cloud);
  for (const auto& file : {ply, pcd}) {
    const Cloud back = read_cloud(file);
    ASSERT_EQ(back.points.size(), cloud.points.size());
    ASSERT_EQ(back.intensity, cloud.intensity);
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_TRUE(same_bits(back.points[i][axis], cloud.points[i][axis])) << i;
      }
    }
  }
}

TEST_F(PointFile, AnEmptyCloudIsACloud) {
  write_ply(folder_.path() / "c.ply", {});
  EXPECT_TRUE(read_cloud(folder_.path() / "c.ply").points.empty());
  write_pcd(folder_.path() / "c.pcd", {});
  EXPECT_TRUE(read_cloud(folder_.path() / "c.pcd").points.empty());
}

TEST_F(PointFile, OtherEndingsAreRefused) {
  EXPECT_THAT(error_of("c.xyz", "1 2 3\n"),
              AllOf(HasSubstr("'.xyz' is not a supported point format"),
                    HasSubstr("give a .ply or .pcd file")));
}

TEST_F(Ply, AsciiReadsAnyPropertiesInAnyOrderAndIgnoresFaces) {
  const auto file =
      put("a.ply", ply_header("ascii",
                              "element vertex 2\nproperty uchar red\n"
                              "property double z\nproperty float x\n"
                              "property float32 y\nproperty float Intensity\n"
                              "element face 1\nproperty list uchar int vertex_index\n") +
                       "255 3 1 2 0.5\n0 nan -1e2 +2 7\n3 0 1 0\n");
  const Cloud cloud = read_cloud(file);
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_EQ(cloud.points[0], Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(cloud.points[1].x(), -100.0F);
  EXPECT_TRUE(std::isnan(cloud.points[1].z()));
  EXPECT_EQ(cloud.intensity, (std::vector<float>{0.5F, 7.0F}));
}

TEST_F(Ply, BigEndianVerticesAreTheSame) {
  std::string little = ply_header(
      "binary_little_endian", std::string("element vertex 2\n") + kXyz + "property ushort ring\n");
  std::string big = ply_header("binary_big_endian",
                               std::string("element vertex 2\n") + kXyz + "property ushort ring\n");
  const auto add = [&](auto value) {
    std::string bytes = packed(value);
    little += bytes;
    std::ranges::reverse(bytes);
    big += bytes;
  };
  for (const float first : {1.0F, -7.5F}) {
    for (const float x : {first, 2.0F, 3.25F}) add(x);
    add(std::uint16_t{258});
  }
  EXPECT_EQ(read_ply_table(put("big.ply", big)).bytes, read_ply_table(put("l.ply", little)).bytes);
}

TEST_F(Ply, BinaryPassesOverElementsBeforeTheVertices) {
  std::string bytes = ply_header(
      "binary_little_endian", std::string("element face 2\nproperty list uchar int vertex_index\n"
                                          "property ushort mark\nelement vertex 1\n") +
                                  kXyz + "property int16 extra\n");
  bytes += packed(std::uint8_t{3}, 0, 1, 2, std::uint16_t{9}, std::uint8_t{0}, std::uint16_t{9});
  bytes += packed(1.0F, 2.0F, 3.0F, std::int16_t{-1});
  const Cloud cloud = read_cloud(put("a.ply", bytes));
  ASSERT_EQ(cloud.points.size(), 1U);
  EXPECT_EQ(cloud.points[0], Eigen::Vector3f(1, 2, 3));
}

TEST_F(Ply, BrokenFilesAreNamedByLineOrByte) {
  const std::string vertex = std::string("element vertex 2\n") + kXyz;
  EXPECT_THAT(error_of("a.ply", "solid\n"), HasSubstr("a.ply:1: is not a PLY file"));
  EXPECT_THAT(error_of("a.ply", ply_header("binary_middle_endian", vertex)),
              AllOf(HasSubstr("a.ply:2: PLY format 'binary_middle_endian' is not supported"),
                    HasSubstr("save it as ascii or binary_little_endian")));
  EXPECT_THAT(error_of("a.ply", ply_header("ascii", "element vertex -1\n")),
              HasSubstr("a.ply:4: '-1' is not a count"));
  EXPECT_THAT(error_of("a.ply", ply_header("ascii", "element vertex 1\nproperty half x\n")),
              HasSubstr("a.ply:5: 'half' is not a PLY type"));
  EXPECT_THAT(error_of("a.ply", ply_header("ascii", "property float x\n")),
              HasSubstr("a.ply:4: a property precedes the first element"));
  EXPECT_THAT(error_of("a.ply", ply_header("ascii", "elements\n")),
              HasSubstr("'elements' is not a PLY keyword"));
  EXPECT_THAT(error_of("a.ply", ply_header("ascii", "element face 0\n")),
              HasSubstr("has no element 'vertex'"));
  EXPECT_THAT(error_of("a.ply", ply_header("ascii", "element vertex 0\nproperty float x\n")),
              AllOf(HasSubstr("has no field 'y'"), HasSubstr("it has: x")));
  EXPECT_THAT(
      error_of("a.ply", ply_header("ascii", "element vertex 1\nproperty list uchar float x\n")),
      HasSubstr("vertices have a list property 'x'"));
  EXPECT_THAT(error_of("a.ply", ply_header("ascii", vertex) + "1 2 3\n1 2\n"),
              HasSubstr("a.ply:10: holds 2 values, not 3"));
  EXPECT_THAT(error_of("a.ply", ply_header("ascii", vertex) + "1 2 3\n1 2 z\n"),
              HasSubstr("a.ply:10: 'z' is not a value of its property's type"));
  EXPECT_THAT(error_of("a.ply", ply_header("ascii", vertex) + "1 2 3\n"),
              AllOf(HasSubstr("ends after line 9"), HasSubstr("cut short")));
  EXPECT_THAT(error_of("a.ply", ply_header("binary_little_endian", vertex) + packed(1.0F)),
              AllOf(HasSubstr("a.ply: byte 136"),
                    HasSubstr("2 times 12 bytes are announced, but 4 bytes are left")));
}

TEST_F(Ply, CountsThatNoMemoryCouldHoldAreRefusedAtOnce) {
  const std::string huge = std::string("element vertex 18446744073709551615\n");
  EXPECT_THAT(error_of("a.ply", ply_header("binary_little_endian", huge + kXyz)),
              HasSubstr("are announced"));
  EXPECT_THAT(error_of("a.ply", ply_header("ascii", huge + kXyz)), HasSubstr("ends after line"));
  EXPECT_THAT(error_of("a.ply", ply_header("binary_little_endian", huge)),
              HasSubstr("has no properties"));
  EXPECT_THAT(error_of("a.ply", ply_header("binary_little_endian",
                                           "element face 18446744073709551615\n" + huge + kXyz)),
              HasSubstr("are announced"));
}

TEST_F(Pcd, AsciiReadsFieldsOfEveryType) {
  const std::string text = pcd_header("x y z a b c d e rgb t", "4 4 8 1 1 2 2 4 4 8",
                                      "F F F I U I U I U U", "1 1 1 1 1 1 1 1 2 1", 1, "ascii") +
                           "1 2.5 -3 -128 255 -32768 65535 -2147483648 7 8 18446744073709551615\n";
  const PointTable table = read_point_table(put("a.pcd", text));
  ASSERT_EQ(table.size, 1U);
  const auto value = [&](const char* name) { return table.number(table.require(name), 0); };
  EXPECT_EQ(value("y"), 2.5);
  EXPECT_EQ(value("z"), -3.0);
  EXPECT_EQ(value("a"), -128.0);
  EXPECT_EQ(value("b"), 255.0);
  EXPECT_EQ(value("c"), -32768.0);
  EXPECT_EQ(value("d"), 65535.0);
  EXPECT_EQ(value("e"), -2147483648.0);
  EXPECT_EQ(value("rgb"), 7.0);
  EXPECT_EQ(value("t"), 18446744073709551616.0);
}

TEST_F(Pcd, ValuesOutsideTheirTypeAreRefused) {
  const auto error = [&](const char* size, const char* type, const char* value) {
    return error_of("a.pcd", pcd_header("x y z r", std::string("4 4 4 ") + size,
                                        std::string("F F F ") + type, "1 1 1 1", 1, "ascii") +
                                 "1 2 3 " + value + "\n");
  };
  for (const char* value : {"256", "-1", "1.5", "nan", "x"}) {
    EXPECT_THAT(error("1", "U", value), HasSubstr("is not a value of its field's type")) << value;
  }
  EXPECT_THAT(error("8", "I", "9223372036854775808"), HasSubstr("is not a value"));
}

TEST_F(Pcd, BinaryIgnoresPaddingAfterThePoints) {
  const std::string bytes =
      pcd_header("x y z intensity", "4 4 4 4", "F F F F", "1 1 1 1", 2, "binary") +
      packed(1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F, 7.0F, 8.0F) + std::string(3900, '\0');
  const Cloud cloud = read_cloud(put("a.pcd", bytes));
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_EQ(cloud.points[1], Eigen::Vector3f(5, 6, 7));
  EXPECT_EQ(cloud.intensity[1], 8.0F);
}

TEST_F(Pcd, FieldsOfSeveralValuesShiftThoseAfterThem) {
  const std::string bytes = pcd_header("_ x y z", "1 4 4 4", "U F F F", "5 1 1 1", 1, "binary") +
                            std::string(5, 'p') + packed(1.0F, 2.0F, 3.0F);
  EXPECT_EQ(read_cloud(put("a.pcd", bytes)).points[0], Eigen::Vector3f(1, 2, 3));
}

TEST_F(Pcd, CompressedPointsAreStoredFieldByField) {
  const std::string columns =
      packed(1.0F, 2.0F, 3.0F) + packed(4.0F, 5.0F, 6.0F) + packed(7.0F, 8.0F, 9.0F);
  const std::string lzf = as_literals(columns);
  const std::string bytes =
      pcd_header("x y z", "4 4 4", "F F F", "1 1 1", 3, "binary_compressed") +
      packed(static_cast<std::uint32_t>(lzf.size()), static_cast<std::uint32_t>(columns.size())) +
      lzf;
  const Cloud cloud = read_cloud(put("a.pcd", bytes));
  ASSERT_EQ(cloud.points.size(), 3U);
  EXPECT_EQ(cloud.points[1], Eigen::Vector3f(2, 5, 8));
}

TEST_F(Pcd, PointsCountWhereWidthAndHeightAreNotGiven) {
  // as written by one sensor driver
  const std::string text =
      "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 0\nHEIGHT 0\nPOINTS 1\nDATA ascii\n1 2 3\n";
  EXPECT_EQ(read_cloud(put("a.pcd", text)).points.size(), 1U);
  const std::string without =
      "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2 3\n";
  EXPECT_EQ(read_cloud(put("a.pcd", without)).points.size(), 1U);
}

TEST_F(Pcd, BrokenHeadersAreNamedByLine) {
  EXPECT_THAT(error_of("a.pcd", "FIELDS x\nTYPES F\n"), HasSubstr("a.pcd:2: 'TYPES' is not a PCD"));
  EXPECT_THAT(error_of("a.pcd", "FIELDS x\nSIZE 4\nPOINTS 1\nDATA ascii\n"),
              HasSubstr("the PCD header has no line TYPE"));
  EXPECT_THAT(error_of("a.pcd", "FIELDS x\nSIZE 4\nTYPE F\nDATA ascii\n"),
              HasSubstr("has no line POINTS"));
  EXPECT_THAT(error_of("a.pcd", "FIELDS x y\nSIZE 4\nTYPE F\nPOINTS 1\nDATA ascii\n"),
              HasSubstr("a.pcd:1: FIELDS, SIZE, TYPE and COUNT differ in length"));
  EXPECT_THAT(error_of("a.pcd", "FIELDS x\nSIZE 3\nTYPE F\nPOINTS 1\nDATA ascii\n"),
              HasSubstr("a.pcd:3: TYPE F with SIZE 3 is not a PCD type"));
  EXPECT_THAT(error_of("a.pcd", "FIELDS x\nSIZE 4\nTYPE F\nCOUNT 0\nPOINTS 1\nDATA ascii\n"),
              HasSubstr("a.pcd:4: COUNT 0 is out of range"));
  EXPECT_THAT(error_of("a.pcd", "FIELDS x\nSIZE 4\nTYPE F\nPOINTS 1\nDATA zip\n"),
              HasSubstr("a.pcd:5: DATA 'zip' is not supported"));
  EXPECT_THAT(
      error_of("a.pcd", "FIELDS x\nSIZE 4\nTYPE F\nWIDTH 2\nHEIGHT 2\nPOINTS 5\nDATA ascii\n"),
      HasSubstr("WIDTH 2 x HEIGHT 2 is not POINTS 5"));
  EXPECT_THAT(error_of("a.pcd",
                       "FIELDS x\nSIZE 4\nTYPE F\nWIDTH 18446744073709551615\nHEIGHT 3\n"
                       "DATA binary\n"),
              HasSubstr("WIDTH 18446744073709551615 x HEIGHT 3"));
}

/// A small file of each binary format: three points, in PLY preceded by a face.
std::vector<std::pair<bool, std::string>> small_binary_files() {
  const std::string three = packed(1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F, 7.0F, 8.0F, 9.0F);
  const std::string lzf = as_literals(three);
  const std::string elements = "element face 1\nproperty list uchar int i\nelement vertex 3\n";
  return {{true, ply_header("binary_little_endian", elements + kXyz) + packed(std::uint8_t{1}, 7) +
                     three},
          {false, pcd_header("x y z", "4 4 4", "F F F", "1 1 1", 3, "binary") + three},
          {false, pcd_header("x y z", "4 4 4", "F F F", "1 1 1", 3, "binary_compressed") +
                      packed(static_cast<std::uint32_t>(lzf.size()), std::uint32_t{36}) + lzf}};
}

PointTable parse(bool is_ply, const std::string& bytes) {
  // a copy of exactly this size, so that a sanitizer detects any read past its end
  const std::vector<char> exact(bytes.begin(), bytes.end());
  const std::string_view view(exact.data(), exact.size());
  return is_ply ? parse_ply_table(view, "file") : parse_pcd_table(view, "file");
}

TEST(BrokenPointFiles, CutAnywhereABinaryFileIsRefused) {
  for (const auto& [is_ply, bytes] : small_binary_files()) {
    EXPECT_EQ(parse(is_ply, bytes).size, 3U);
    for (std::size_t n = 0; n < bytes.size(); ++n) {
      EXPECT_THROW(parse(is_ply, bytes.substr(0, n)), InputError) << "cut to " << n << " bytes";
    }
  }
}

TEST(BrokenPointFiles, CutAnywhereATextFileIsRefusedButInItsLastNumber) {
  const std::pair<bool, std::string> files[] = {
      {true, ply_header("ascii", std::string("element vertex 2\n") + kXyz) + "1 2 3\n4 5 66\n"},
      {false, pcd_header("x y z", "4 4 4", "F F F", "1 1 1", 2, "ascii") + "1 2 3\n4 5 66\n"}};
  for (const auto& [is_ply, bytes] : files) {
    for (std::size_t n = 0; n < bytes.size(); ++n) {
      if (n + 2 < bytes.size()) {
        EXPECT_THROW(parse(is_ply, bytes.substr(0, n)), InputError) << "cut to " << n << " bytes";
      } else {
        EXPECT_EQ(parse(is_ply, bytes.substr(0, n)).size, 2U);
      }
    }
  }
}

TEST(BrokenPointFiles, WithAnyOneByteChangedAreReadOrRefusedButDoNoHarm) {
  std::size_t read = 0;
  std::size_t refused = 0;
  for (const auto& [is_ply, bytes] : small_binary_files()) {
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      for (int value = 0; value < 256; value += 5) {
        std::string broken = bytes;
        broken[at] = static_cast<char>(value);
        try {
          const PointTable table = parse(is_ply, broken);
          // every announced value can be read
          for (const Column& column : table.columns) {
            if (table.size > 0) table.number(column, table.size - 1);
          }
          ++read;
        } catch (const InputError&) {
          ++refused;
        }
      }
    }
  }
  EXPECT_GT(read, 1000U);  // changes of coordinates and comments cannot be detected
  EXPECT_GT(refused, 1000U);
}

TEST(Lzf, CopiesMayOverlapWhatTheyWrite) {
  // "ab", then 9 bytes from 2 back: control 7 << 5, one more length byte 0
  const std::string input{
      "\x01"
      "ab\xE0\x00\x01",
      6};
  EXPECT_EQ(expand_lzf(input, 11), "abababababa");
  // 3 bytes from 1 back: control 1 << 5
  EXPECT_EQ(expand_lzf(std::string{"\x00x\x20\x00", 4}, 4), "xxxx");
}

TEST(Lzf, WhatReachesOutsideIsRefused) {
  EXPECT_EQ(expand_lzf(std::string{"\x00x\x20\x01", 4}, 4), std::nullopt);   // before the start
  EXPECT_EQ(expand_lzf(std::string{"\x00x\x20\x00", 4}, 3), std::nullopt);   // past the end
  EXPECT_EQ(expand_lzf(std::string{"\x00x\x20\x00", 4}, 5), std::nullopt);   // too little
  EXPECT_EQ(expand_lzf(std::string{"\x05xy", 3}, 6), std::nullopt);          // literals cut off
  EXPECT_EQ(expand_lzf(std::string{"\x00x\x20", 3}, 4), std::nullopt);       // copy cut off
  EXPECT_EQ(expand_lzf(std::string{"\x00x\xE0\x01", 4}, 11), std::nullopt);  // long copy cut off
  EXPECT_EQ(expand_lzf("", 4'000'000'000U), std::nullopt);                   // false size
  EXPECT_EQ(expand_lzf("", 0), "");
}

TEST(RealClouds, HaveThePointsTheirHeadersCount) {
  const std::pair<const char*, std::size_t> files[] = {
      {"lidar/livox_mid40_map/corner.pcd", 63'381},
      {"lidar/livox_mid40_map/surf.pcd", 91'531},
      {"lidar/pjlab_lidar2imu/2021-10-26-16-21-29-468.pcd", 80'787},
      {"lidar/small_gicp_pair/source.ply", 69'792},
      {"lidar/kitti_drive/0000000040.pcd", 122'692}};
  for (const auto& [name, points] : files) {
    const auto file = shared_data(name);
    LIDARENA_NEEDS(file);
    const Cloud cloud = read_cloud(file);
    EXPECT_EQ(cloud.points.size(), points) << name;
    EXPECT_EQ(cloud.intensity.size(), points) << name;
  }
}

TEST(RealClouds, ACompressedSweepHasItsValues) {
  const auto file = shared_data("lidar/pjlab_lidar2imu/2021-10-26-16-21-29-468.pcd");
  LIDARENA_NEEDS(file);
  const PointTable table = read_point_table(file);
  // extreme values according to an independent decoder
  double low = 1e9;
  double high = -1e9;
  double ring = 0;
  for (std::size_t i = 0; i < table.size; ++i) {
    low = std::min(low, table.number(table.require("x"), i));
    high = std::max(high, table.number(table.require("x"), i));
    ring = std::max(ring, table.number(table.require("ring"), i));
  }
  EXPECT_FLOAT_EQ(static_cast<float>(low), -118.95113372802734F);
  EXPECT_FLOAT_EQ(static_cast<float>(high), 126.76788330078125F);
  EXPECT_EQ(ring, 60.0);
  EXPECT_EQ(table.number(table.require("timestamp"), 0), 1635236489.369082);
}

}  // namespace
}  // namespace lidarena::dataset
