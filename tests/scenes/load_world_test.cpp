// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/load_world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lidarena/scenes/world_config.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/world/complaints.hpp"
#include "tests/world/cube_files.hpp"
#include "tests/world/shapes.hpp"

namespace lidarena::scenes {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;

class LoadWorld : public ::testing::Test {
 protected:
  std::string error_of(const std::string& name, const std::string& text) {
    const auto file = folder_.write(name, text);
    return world::testing::input_error_of([&] { load_world(file, {}, log_); });
  }
  TemporaryFolder folder_;
  LogSink log_;
};

TEST_F(LoadWorld, WorldsBySeedNameTheObjectOfEveryTriangle) {
  for (const std::string kind : {"house", "cave", "mine", "forest", "hall", "office"}) {
    const world::TriangleMesh mesh =
        load_world(folder_.write(kind + ".yaml", "kind: " + kind + "\nseed: 3\n"), {}, log_).mesh;
    ASSERT_EQ(mesh.material_ids.size(), mesh.triangles.size()) << kind;
    for (const world::Material& material : mesh.palette) {
      EXPECT_FALSE(material.object.empty()) << kind << ": " << material.name;
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const std::string& object = mesh.material(i).object;
      for (const std::uint32_t corner : mesh.triangles[i]) {
        const double z = mesh.vertices[corner].z();
        ASSERT_TRUE(object != "floor" || z <= 0.0) << kind;
        ASSERT_TRUE((object != "ceiling" && object != "roof") || z >= 2.0) << kind;
      }
    }
  }
}

TEST_F(LoadWorld, TheEndingSaysWhatItIs) {
  const world::WorldModel model =
      load_world(folder_.write("room.obj", world::testing::box_obj()), {}, log_);
  EXPECT_EQ(model.name, "room");
  EXPECT_EQ(model.mesh.triangles.size(), 12U);
  EXPECT_TRUE(model.routes.empty());
  EXPECT_THAT(error_of("room.blend", "x"), AllOf(HasSubstr("room.blend"), HasSubstr(".yaml")));
  EXPECT_THAT(
      world::testing::input_error_of([&] { load_world(folder_.path() / "none.yaml", {}, log_); }),
      HasSubstr("no such file"));
}

TEST_F(LoadWorld, AMeshNamedInYamlLiesBesideTheYaml) {
  folder_.write("meshes/room.obj", world::testing::box_obj());
  const auto file = folder_.write("hall.yaml", "kind: mesh\nfile: meshes/room.obj\nup_axis: y\n");
  const world::WorldModel model = load_world(file, {}, log_);
  EXPECT_EQ(model.name, "hall");
  EXPECT_TRUE(model.mesh.bounds().max().isApprox(Vector3d(1, 0, 2), 1e-6));
}

TEST_F(LoadWorld, TheCallerOverridesTheFile) {
#if !LIDARENA_TEST_SDF
  GTEST_SKIP() << "this build cannot read SDF worlds";
#endif
  folder_.write("a.world",
                "<sdf version='1.6'><world name='w'><model name='m'><link name='l'>"
                "<visual name='v'><geometry><box><size>1 1 1</size></box></geometry></visual>"
                "<collision name='c'><geometry><box><size>2 2 2</size></box></geometry></collision>"
                "</link></model></world></sdf>");
  const auto file = folder_.write("a.yaml", "kind: sdf\nfile: a.world\nshapes: collision\n");
  EXPECT_DOUBLE_EQ(load_world(file, {}, log_).mesh.area(), 24.0);
  WorldOptions options;
  options.shapes = world::ShapeKind::kVisual;
  EXPECT_DOUBLE_EQ(load_world(file, options, log_).mesh.area(), 6.0);
}

TEST_F(LoadWorld, ModelFoldersInYamlAreRelativeToTheYaml) {
#if !LIDARENA_TEST_SDF
  GTEST_SKIP() << "this build cannot read SDF worlds";
#endif
  folder_.write("things/box/box.obj", world::testing::box_obj());
  folder_.write("sdf/worlds/a.world",
                "<sdf version='1.6'><world name='w'><model name='m'><link name='l'>"
                "<visual name='v'><geometry><mesh><uri>model://box/box.obj</uri></mesh></geometry>"
                "</visual></link></model></world></sdf>");
  const std::string yaml = "kind: sdf\nfile: sdf/worlds/a.world\n";
  EXPECT_THAT(error_of("a.yaml", yaml), HasSubstr("model://box/box.obj"));
  const auto file = folder_.write("b.yaml", yaml + "model_paths: [things]\n");
  EXPECT_EQ(load_world(file, {}, log_).mesh.triangles.size(), 12U);
}

TEST_F(LoadWorld, KeysOfAnotherKindAreRefused) {
  folder_.write("room.obj", world::testing::box_obj());
  EXPECT_THAT(error_of("a.yaml", "kind: mesh\nfile: room.obj\nseed: 3\n"),
              AllOf(HasSubstr("a.yaml:3"), HasSubstr("seed")));
  EXPECT_THAT(error_of("a.yaml", "kind: cave\nfile: room.obj\n"), HasSubstr("a.yaml:2"));
  EXPECT_THAT(error_of("a.yaml", "kind: hut\n"),
              HasSubstr("house, cave, mine, forest, hall, office, mesh, sdf"));
  EXPECT_THAT(error_of("a.yaml", "file: room.obj\n"), HasSubstr("kind"));
  EXPECT_THAT(error_of("a.yaml", "kind: mesh\n"), HasSubstr("the key 'file' is missing"));
  EXPECT_THAT(error_of("a.yaml", ""), HasSubstr("kind"));
  EXPECT_THAT(error_of("a.yaml", "kind: cave\ncave: {loops: -1}\n"), HasSubstr("out of range"));
}

TEST_F(LoadWorld, AnyKindHasThingsThatMove) {
  const std::string cart = "movers: [{name: cart, kind: box, path: [[1, 2, 0], [3, 2, 0]]}]\n";
  const auto file = folder_.write("busy.yaml", "kind: hall\nhall: {rows: 1}\npeople: 3\n" + cart);
  const world::WorldModel hall = load_world(file, {}, log_);
  EXPECT_EQ(hall.people, 3);
  ASSERT_EQ(hall.movers.size(), 1U);
  EXPECT_EQ(hall.movers[0].kind, world::MoverKind::kBox);
  EXPECT_EQ(hall.movers[0].path[1], Eigen::Vector3d(3, 2, 0));
  EXPECT_THAT(error_of("a.yaml", "kind: house\nmovers: [{name: ghost}]\n"), HasSubstr("ghost"));
}

TEST_F(LoadWorld, AHouseHasItsParametersAndItsRoute) {
  const auto file =
      folder_.write("home.yaml", "kind: house\nseed: 9\nhouse: {width_m: 20, detail: 0.5}\n");
  const world::WorldModel home = load_world(file, {}, log_);
  HouseConfig config;
  config.width_m = 20;
  config.detail = 0.5;
  const world::WorldModel expected = make_house(config, 9);
  EXPECT_EQ(home.name, "home");
  EXPECT_EQ(home.mesh.vertices, expected.mesh.vertices);
  EXPECT_EQ(home.routes, expected.routes);
  EXPECT_THAT(error_of("a.yaml", "kind: house\ncave: {loops: 2}\n"), HasSubstr("a.yaml:2"));
}

TEST_F(LoadWorld, TheFilesOfConfigsWorldsAreValid) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(
           std::filesystem::path(LIDARENA_SOURCE_DIR) / "configs" / "worlds")) {
    ++files;
    const world::WorldModel model = load_world(entry.path(), {}, log_);
    EXPECT_EQ(model.name, entry.path().stem());
    EXPECT_GT(model.mesh.area(), 0.0) << entry.path();
  }
  EXPECT_GE(files, 2);
}

TEST_F(LoadWorld, ACaveHasItsParametersAndTheCallersSeed) {
  const std::string yaml = "kind: cave\nseed: 5\ncave: {loops: 1, voxel_size_m: 0.3}\n";
  const auto file = folder_.write("small.yaml", yaml);
  const world::WorldModel five = load_world(file, {}, log_);
  WorldOptions options;
  options.seed = 6;
  const world::WorldModel six = load_world(file, options, log_);
  CaveConfig config;
  config.loops = 1;
  config.voxel_size_m = 0.3;
  EXPECT_EQ(five.name, "small");
  EXPECT_EQ(five.mesh.vertices, make_cave(config, 5).mesh.vertices);
  EXPECT_EQ(six.mesh.vertices, make_cave(config, 6).mesh.vertices);
  EXPECT_NE(five.mesh.vertices, six.mesh.vertices);
}

}  // namespace
}  // namespace lidarena::scenes
