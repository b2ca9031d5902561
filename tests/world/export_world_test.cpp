// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/export_world.hpp"
#include "lidarena/world/mesh_io.hpp"
#include "lidarena/world/sdf_world.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/world/primitives.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::world {
namespace {

namespace fs = std::filesystem;

/// A box and a sphere far enough apart that a mixed-up index shows in the area.
TriangleMesh two_bodies() {
  TriangleMesh mesh = box_shape({4.0, 3.0, 2.5});
  mesh.append(sphere_shape(0.7), make_pose(Eigen::Matrix3d::Identity(), {9.0, -3.0, 1.25}));
  return mesh;
}

void expect_same(const TriangleMesh& a, const TriangleMesh& b) {
  EXPECT_EQ(a.triangles.size(), b.triangles.size());
  EXPECT_NEAR(a.area(), b.area(), 1e-5 * b.area());
  EXPECT_LT((a.bounds().min() - b.bounds().min()).norm(), 1e-6);
  EXPECT_LT((a.bounds().max() - b.bounds().max()).norm(), 1e-6);
}

TEST(ExportWorld, ComesBackAsItWas) {
  const TemporaryFolder folder;
  LogSink log;
  for (const char* name : {"bodies.ply", "bodies.obj", "bodies.sdf", "other.world"}) {
    SCOPED_TRACE(name);
    const fs::path file = folder.path() / name;
    save_world(file, two_bodies());
    const bool is_sdf = file.extension() == ".sdf" || file.extension() == ".world";
    if (is_sdf && !LIDARENA_TEST_SDF) continue;
    expect_same((is_sdf ? load_sdf(file, {}, log) : load_mesh(file)), two_bodies());
  }
}

TEST(ExportWorld, AnObjHasTheNormalOfEachTriangleOnce) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "box.obj";
  save_obj(file, box_shape({4.0, 3.0, 2.5}));
  std::ifstream in(file);
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3d> normals;
  std::size_t triangles = 0;
  for (std::string line; std::getline(in, line);) {
    Eigen::Vector3d v;
    std::array<std::array<std::size_t, 2>, 3> corner{};
    if (std::sscanf(line.c_str(), "v %lf %lf %lf", &v[0], &v[1], &v[2]) == 3) vertices.push_back(v);
    if (std::sscanf(line.c_str(), "vn %lf %lf %lf", &v[0], &v[1], &v[2]) == 3) normals.push_back(v);
    if (std::sscanf(line.c_str(), "f %zu//%zu %zu//%zu %zu//%zu", &corner[0][0], &corner[0][1],
                    &corner[1][0], &corner[1][1], &corner[2][0], &corner[2][1]) != 6)
      continue;
    ++triangles;
    const Eigen::Vector3d center = (vertices.at(corner[0][0] - 1) + vertices.at(corner[1][0] - 1) +
                                    vertices.at(corner[2][0] - 1)) /
                                   3.0;
    const Eigen::Vector3d& normal = normals.at(corner[0][1] - 1);
    EXPECT_NEAR(normal.norm(), 1.0, 1e-6);
    EXPECT_GT(normal.dot(center), 1.2) << "outward: the faces are 1.25 m and more from the center";
    EXPECT_EQ(corner[0][1], corner[1][1]);
    EXPECT_EQ(corner[0][1], corner[2][1]);
  }
  EXPECT_EQ(triangles, 12U);
  EXPECT_EQ(normals.size(), 6U);
}

TEST(ExportWorld, NamesTheFileAndTheRemedy) {
  const TemporaryFolder folder;
  EXPECT_THROW(save_world(folder.path() / "world.stl", two_bodies()), InputError);
  EXPECT_THROW(save_world(folder.path() / "my world.sdf", two_bodies()), InputError);
  EXPECT_THROW(save_world(folder.path() / "missing" / "world.obj", two_bodies()), Error);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace lidarena::world
