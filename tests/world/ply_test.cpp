// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/ply.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "tests/temporary_folder.hpp"
#include "tests/world/complaints.hpp"
#include "tests/world/shapes.hpp"

namespace lidarena::world {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using testing::input_error_of;

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Ply, WhatIsSavedIsReadBackToTheLastBitEvenInMapCoordinates) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "soup.ply";
  TriangleMesh soup;
  soup.append(testing::triangle_soup(300, 5.0, 1), Pose(Eigen::Translation3d(5e5, 5.4e6, 300)));
  save_ply(file, soup);
  const TriangleMesh back = read_ply(file);
  EXPECT_EQ(back.vertices, soup.vertices);
  EXPECT_EQ(back.triangles, soup.triangles);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "soup.ply.part"));
}

TEST(Ply, AConcaveFaceHasItsArea) {
  const TemporaryFolder folder;
  const auto file = folder.write(
      "u.ply",
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n3 0 0\n3 3 0\n2 3 0\n2 1 0\n1 1 0\n1 3 0\n0 3 0\n8 3 4 5 6 7 0 1 2\n");
  EXPECT_DOUBLE_EQ(read_ply(file).area(), 7.0);
}

TEST(Ply, MaterialsAreKept) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "boxes.ply";
  TriangleMesh boxes = testing::box_mesh({0, 0, 0}, {1, 2, 3});
  TriangleMesh screen = testing::box_mesh({2, 0, 0}, {3, 1, 1});
  screen.paint({"dark screen, 1/3", 1.0 / 3.0, 0.1});
  boxes.append(screen);
  TriangleMesh pane = testing::box_mesh({4, 0, 0}, {5, 1, 1});
  pane.paint({"pane with a sign", 0.1, 0.9, 1.0 / 7.0, 812.5});
  boxes.append(pane);
  TriangleMesh washer = testing::box_mesh({6, 0, 0}, {7, 1, 1});
  washer.paint(materials::kMetal.of("washing machine"));
  boxes.append(washer);
  save_ply(file, boxes);
  const TriangleMesh back = read_ply(file);
  EXPECT_EQ(back.triangles, boxes.triangles);
  EXPECT_EQ(back.palette, boxes.palette);
  EXPECT_EQ(back.material_ids, boxes.material_ids);
  EXPECT_EQ(back.material(12).name, "dark screen, 1/3");
  EXPECT_EQ(back.material(24).object, "");
  EXPECT_EQ(back.material(36).object, "washing machine");
}

TEST(Ply, AFaceOfAnUnknownMaterialIsRefusedAndForeignMaterialsAreSkipped) {
  const TemporaryFolder folder;
  const auto face = [](const std::string& comment) {
    return "ply\nformat ascii 1.0\n" + comment +
           "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 1\nproperty uchar material_index\n"
           "property list uchar uint vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
           "7 3 0 1 2\n";
  };
  folder.write("bad.ply", face("comment material 0.5 0 paint\n"));
  EXPECT_THAT(input_error_of([&] { read_ply(folder.path() / "bad.ply"); }),
              HasSubstr("material index 7, number of materials: 1"));
  for (const char* comment :
       {"", "comment material 5 0 brighter than white\n",
        "comment material 0.5 0 transmission=1.5 too clear\n", "comment materials: none\n"}) {
    folder.write("foreign.ply", face(comment));
    EXPECT_TRUE(read_ply(folder.path() / "foreign.ply").material_ids.empty()) << comment;
  }
}

// The bytes are read here according to the format, independently of read_ply().
TEST(Ply, TheSavedBytesAreWhatTheHeaderAnnounces) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "box.ply";
  const TriangleMesh box = testing::box_mesh({0, 0, 0}, {1, 2, 3});
  save_ply(file, box);
  const std::string bytes = bytes_of(file);
  const std::size_t body = bytes.find("end_header\n") + 11;
  EXPECT_THAT(bytes.substr(0, body), HasSubstr("element vertex 8\nproperty double x\n"));
  EXPECT_THAT(bytes.substr(0, body),
              HasSubstr("element face 12\nproperty list uchar uint vertex_indices\n"));
  ASSERT_EQ(bytes.size(), body + 8 * 3 * sizeof(double) + 12 * (1 + 3 * sizeof(std::uint32_t)));
  Vector3d last_vertex;
  std::memcpy(last_vertex.data(), bytes.data() + body + 7 * 24, 24);
  EXPECT_EQ(last_vertex, Vector3d(1, 2, 3));
  EXPECT_EQ(bytes[body + 8 * 24], 3);
}

TEST(Ply, BigEndianFilesOfFloatsAreRead) {
  const TemporaryFolder folder;
  std::string text =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar ushort vertex_indices\nend_header\n";
  const auto put = [&text](auto value) {
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof(value));
    std::ranges::reverse(bytes);
    text += bytes;
  };
  for (const float x : {0.F, 0.F, 0.F, 1.5F, 0.F, 0.F, 0.F, -2.F, 0.25F}) put(x);
  put(std::uint8_t{3});
  for (std::uint16_t index = 0; index < 3; ++index) put(index);
  const TriangleMesh mesh = read_ply(folder.write("a.ply", text));
  EXPECT_EQ(mesh.vertices[1], Vector3d(1.5, 0, 0));
  EXPECT_EQ(mesh.vertices[2], Vector3d(0, -2, 0.25));
  EXPECT_EQ(mesh.triangles, std::vector<Triangle>({{0, 1, 2}}));
}

TEST(Ply, AStumpIsRefusedWhereverItWasCut) {
  const TemporaryFolder folder;
  save_ply(folder.path() / "box.ply", testing::box_mesh({0, 0, 0}, {1, 1, 1}));
  const std::string bytes = bytes_of(folder.path() / "box.ply");
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto file = folder.write("stump.ply", std::string_view(bytes).substr(0, size));
    ASSERT_THAT(input_error_of([&] { read_ply(file); }), HasSubstr("stump.ply")) << size;
  }
}

TEST(Ply, EachThingThatCanBeWrongIsNamed) {
  const TemporaryFolder folder;
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const auto error_of = [&](const std::string& text) {
    return input_error_of([&] { read_ply(folder.write("a.ply", text)); });
  };
  EXPECT_THAT(error_of(header + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), HasSubstr("vertex index 3"));
  EXPECT_THAT(error_of(header + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), HasSubstr("-1"));
  EXPECT_THAT(error_of(header + "0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n"), HasSubstr("'zero'"));
  EXPECT_THAT(error_of("ply\nformat ascii 1.0\nelement vertex many\nend_header\n"),
              HasSubstr("a.ply:3"));
  EXPECT_THAT(error_of("ply\nformat ternary 1.0\nend_header\n"), HasSubstr("a.ply:2"));
  EXPECT_THAT(error_of("ply\nformat ascii 1.0\nproperty float x\nend_header\n"),
              HasSubstr("a.ply:3"));
  EXPECT_THAT(error_of("solid\nend_header\n"), HasSubstr("first line"));
  EXPECT_THROW(read_ply(folder.path() / "none.ply"), InputError);
}

TEST(Ply, NothingIsLeftBehindWhereItCannotBeWritten) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "no_such_folder" / "box.ply";
  EXPECT_THROW(save_ply(file, testing::box_mesh({0, 0, 0}, {1, 1, 1})), Error);
  EXPECT_FALSE(std::filesystem::exists(file.parent_path()));
}

}  // namespace
}  // namespace lidarena::world
