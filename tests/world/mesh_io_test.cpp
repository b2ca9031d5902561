// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/mesh_io.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lidarena/world/ply.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/world/complaints.hpp"
#include "tests/world/cube_files.hpp"
#include "tests/world/shapes.hpp"

namespace lidarena::world {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::input_error_of;

// The same box of 1 x 2 x 3 m with a corner at the origin in each format, in the up axis of the
// format.
struct FormatCase {
  const char* file;
  std::string text;
};
void PrintTo(const FormatCase& c, std::ostream* out) { *out << c.file; }

class MeshFormats : public ::testing::TestWithParam<FormatCase> {};

TEST_P(MeshFormats, ABoxHasItsSurfaceVolumeAndPlaceWithZUp) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = load_mesh(folder.write(GetParam().file, GetParam().text));
  EXPECT_EQ(mesh.triangles.size(), 12U);
  EXPECT_EQ(mesh.vertices.size(), 8U);
  EXPECT_NEAR(mesh.area(), 22.0, 1e-5);
  EXPECT_NEAR(testing::signed_volume(mesh), 6.0, 1e-5);
  EXPECT_TRUE(mesh.bounds().min().isZero(1e-6)) << mesh.bounds().min().transpose();
  EXPECT_TRUE(mesh.bounds().max().isApprox(Vector3d(1, 2, 3), 1e-6))
      << mesh.bounds().max().transpose();
}

INSTANTIATE_TEST_SUITE_P(All, MeshFormats,
                         ::testing::Values(FormatCase{"box.obj", testing::box_obj()},
                                           FormatCase{"BOX.OBJ", testing::box_obj()},
                                           FormatCase{"box.stl", testing::box_stl()},
                                           FormatCase{"ascii.ply", testing::box_ply()},
                                           FormatCase{"z_up.dae", testing::box_dae("Z_UP", 1.0)},
                                           FormatCase{"y_up.dae", testing::box_dae("Y_UP", 1.0)},
                                           FormatCase{"centimeters.dae",
                                                      testing::box_dae("Z_UP", 0.01)},
                                           FormatCase{"box.gltf", testing::box_gltf()}));

TEST(MeshIo, CoordinatesStandAsTheyAreWhenZIsSaidToBeUp) {
  const TemporaryFolder folder;
  const auto file = folder.write("box.dae", testing::box_dae("Y_UP", 0.01));
  // The file is y up: 1 m along x, 3 m along y, 2 m along -z; its unit is still applied.
  const TriangleMesh mesh = load_mesh(file, UpAxis::kZ);
  EXPECT_TRUE(mesh.bounds().min().isApprox(Vector3d(0, 0, -2), 1e-6));
  EXPECT_TRUE(mesh.bounds().max().isApprox(Vector3d(1, 3, 0), 1e-6));
}

TEST(MeshIo, YUpIsTurnedWhateverTheFileSays) {
  const TemporaryFolder folder;
  for (const auto& [name, text] : {std::pair<std::string, std::string>{"a.obj", testing::box_obj()},
                                   {"a.ply", testing::box_ply()},
                                   {"a.dae", testing::box_dae("Z_UP", 1.0)}}) {
    const TriangleMesh mesh = load_mesh(folder.write(name, text), UpAxis::kY);
    EXPECT_TRUE(mesh.bounds().min().isApprox(Vector3d(0, -3, 0), 1e-6)) << name;
    EXPECT_TRUE(mesh.bounds().max().isApprox(Vector3d(1, 0, 2), 1e-6)) << name;
    EXPECT_NEAR(testing::signed_volume(mesh), 6.0, 1e-5) << name;
  }
}

TEST(MeshIo, NodeTransformsPlaceEveryInstance) {
  const TemporaryFolder folder;
  const auto file = folder.write("two.dae", testing::two_boxes_dae());
  const TriangleMesh mesh = load_mesh(file);
  EXPECT_EQ(mesh.triangles.size(), 24U);
  EXPECT_NEAR(testing::signed_volume(mesh), 6.0 + 8 * 6.0, 1e-4);  // the second twice as large
  EXPECT_TRUE(mesh.bounds().max().isApprox(Vector3d(10 + 2, 4, 6), 1e-6));
  const auto parts = load_mesh_parts(file);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].node, "first");
  EXPECT_EQ(parts[1].node, "second");
  EXPECT_TRUE(parts[1].surface.bounds().min().isApprox(Vector3d(10, 0, 0), 1e-6));
}

TEST(MeshIo, PointsAndLinesAreLeftOut) {
  const TemporaryFolder folder;
  const auto file = folder.write("mixed.obj", testing::box_obj() + "l 1 2\np 3\n");
  EXPECT_EQ(load_mesh(file).triangles.size(), 12U);
}

TEST(MeshIo, DegenerateTrianglesStayInUntilTheMeshIsCleaned) {
  const TemporaryFolder folder;
  TriangleMesh mesh = load_mesh(folder.write("a.obj", testing::box_obj() + "f 1 1 2\n"));
  EXPECT_EQ(mesh.triangles.size(), 13U);
  EXPECT_EQ(clean_mesh(mesh, "a"), 1U);
}

TEST(MeshIo, OneClearErrorForEachThingThatCanBeWrong) {
  const TemporaryFolder folder;
  const auto error_of = [](const std::filesystem::path& file) {
    return input_error_of([&] { load_mesh(file); });
  };
  EXPECT_THAT(error_of(folder.path() / "none.obj"),
              AllOf(HasSubstr("none.obj"), HasSubstr("no such file")));
  EXPECT_THAT(error_of(folder.path()), HasSubstr("extension"));
  EXPECT_THAT(error_of(folder.write("a.txt", "hello")), HasSubstr("extension"));
  for (const char* name : {"a.obj", "a.ply", "a.stl", "a.dae", "a.gltf", "a.glb"}) {
    for (const char* text : {"", "\x01\x02 no mesh at all", "v 1"}) {
      EXPECT_THAT(error_of(folder.write(name, text)), HasSubstr(name)) << text;
    }
  }
  EXPECT_THAT(error_of(folder.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1 2 3\n")),
              HasSubstr("no faces"));
  EXPECT_THAT(error_of(folder.write("points.ply",
                                    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                                    "property float y\nproperty float z\nend_header\n1 2 3\n")),
              HasSubstr("no faces"));
}

TEST(MeshIo, RefusesMapCoordinatesThatSinglePrecisionWouldRuin) {
  const TemporaryFolder folder;
  const std::string far =
      "v 500000.1 5400000.2 300\nv 500001.1 5400000.2 300\n"
      "v 500000.1 5400001.2 300\nf 1 2 3\n";
  EXPECT_THAT(input_error_of([&] { load_mesh(folder.write("utm.obj", far)); }), HasSubstr("PLY"));
}

}  // namespace
}  // namespace lidarena::world
