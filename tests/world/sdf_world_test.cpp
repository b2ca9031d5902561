// SPDX-License-Identifier: BSD-3-Clause
// The tests write SDF worlds that are small enough for results to be computed by hand.
#include "lidarena/world/sdf_world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

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
using ::testing::Not;

std::string world_with(const std::string& content) {
  return "<?xml version='1.0'?><sdf version='1.6'><world name='w'>" + content + "</world></sdf>";
}

std::string model_with(const std::string& content) {
  return "<?xml version='1.0'?><sdf version='1.6'><model name='m'><static>1</static>" + content +
         "</model></sdf>";
}

std::string visual(const std::string& geometry, const std::string& pose = "0 0 0 0 0 0") {
  return "<visual name='v'><pose>" + pose + "</pose><geometry>" + geometry + "</geometry></visual>";
}

std::string collision(const std::string& geometry) {
  return "<collision name='c'><geometry>" + geometry + "</geometry></collision>";
}

/// One model, one link, one visual.
std::string world_of(const std::string& geometry) {
  return world_with("<model name='m'><link name='l'>" + visual(geometry) + "</link></model>");
}

std::string include(const std::string& uri, const std::string& name, const std::string& pose) {
  return "<include><uri>" + uri + "</uri><name>" + name + "</name><pose>" + pose +
         "</pose></include>";
}

const char* const kUnitBox = "<box><size>1 1 1</size></box>";
const char* const kModelConfig =
    "<?xml version='1.0'?><model><name>m</name><version>1</version>"
    "<sdf version='1.6'>model.sdf</sdf></model>";

class SdfWorld : public ::testing::Test {
 protected:
  void SetUp() override {
#if !LIDARENA_TEST_SDF
    GTEST_SKIP() << "this build cannot read SDF worlds";
#endif
  }

  TriangleMesh load(const std::string& text, const SdfOptions& options = {}) {
    return load_sdf(folder_.write("worlds/test.world", text), options, log_);
  }
  void write_model(const std::string& name, const std::string& content) {
    folder_.write("models/" + name + "/model.config", kModelConfig);
    folder_.write("models/" + name + "/model.sdf", model_with(content));
  }

  TemporaryFolder folder_;
  testing::RecordingLog log_;
};

void expect_bounds(const TriangleMesh& mesh, const Vector3d& low, const Vector3d& high) {
  EXPECT_LT((mesh.bounds().min() - low).norm(), 1e-6) << mesh.bounds().min().transpose();
  EXPECT_LT((mesh.bounds().max() - high).norm(), 1e-6) << mesh.bounds().max().transpose();
}

TEST_F(SdfWorld, EveryPrimitiveHasItsSize) {
  expect_bounds(load(world_of("<box><size>1 2 3</size></box>")), {-.5, -1, -1.5}, {.5, 1, 1.5});
  expect_bounds(load(world_of("<sphere><radius>2</radius></sphere>")), {-2, -2, -2}, {2, 2, 2});
  expect_bounds(load(world_of("<cylinder><radius>1</radius><length>4</length></cylinder>")),
                {-1, -1, -2}, {1, 1, 2});
  expect_bounds(load(world_of("<capsule><radius>1</radius><length>4</length></capsule>")),
                {-1, -1, -3}, {1, 1, 3});
  expect_bounds(load(world_of("<ellipsoid><radii>1 2 3</radii></ellipsoid>")), {-1, -2, -3},
                {1, 2, 3});
  expect_bounds(load(world_of("<plane><normal>1 0 0</normal><size>4 4</size></plane>")),
                {0, -2, -2}, {0, 2, 2});
  EXPECT_EQ(log_.warnings, "");
}

TEST_F(SdfWorld, PosesOfModelLinkAndShapeFollowOneAnother) {
  // Translated along x and rotated by 90 degrees to the left, translated along the new x and
  // rotated again, translated along the new x.
  const TriangleMesh mesh =
      load(world_with("<model name='m'><pose>10 0 0 0 0 1.5707963267948966</pose>"
                      "<link name='l'><pose>5 0 0 0 0 1.5707963267948966</pose>" +
                      visual("<box><size>2 4 6</size></box>", "3 0 1 0 0 0") + "</link></model>"));
  // (10, 0), then (0, 5), then (-3, 0): the box is at (7, 5, 1), rotated by 180 degrees.
  expect_bounds(mesh, {6, 3, -2}, {8, 7, 4});
}

TEST_F(SdfWorld, APoseRelativeToAnotherFrameIsResolved) {
  const std::string text =
      "<?xml version='1.0'?><sdf version='1.9'><world name='w'>"
      "<frame name='dock'><pose>100 0 0 0 0 0</pose></frame>"
      "<model name='m'><pose relative_to='dock'>1 0 0 0 0 0</pose><link name='base'/>"
      "<link name='arm'><pose>0 10 0 0 0 0</pose></link>"
      "<link name='hand'><pose relative_to='arm'>0 0 5 0 0 0</pose>" +
      visual(kUnitBox) + "</link></model></world></sdf>";
  expect_bounds(load(text), {100.5, 9.5, 4.5}, {101.5, 10.5, 5.5});
}

TEST_F(SdfWorld, AnIncludedModelIsPlacedByTheIncludeInsteadOfItsOwnPose) {
  write_model("post", "<pose>50 50 50 0 0 0</pose><link name='l'>" + visual(kUnitBox) + "</link>");
  const TriangleMesh mesh = load(world_with(include("model://post", "a", "1 2 3 0 0 0") +
                                            include("model://post", "b", "7 0 0 0 0 0")));
  EXPECT_EQ(mesh.triangles.size(), 24U);
  expect_bounds(mesh, {.5, -.5, -.5}, {7.5, 2.5, 3.5});
}

TEST_F(SdfWorld, ModelsWithinModelsAddTheirPoses) {
  write_model("leaf", "<link name='l'>" + visual(kUnitBox) + "</link>");
  write_model("branch", "<link name='stem'/>" + include("model://leaf", "leaf", "0 0 2 0 0 0"));
  const TriangleMesh mesh =
      load(world_with("<model name='tree'><pose>10 0 0 0 0 0</pose><link name='root'/>"
                      "<model name='limb'><pose>0 5 0 0 0 0</pose><link name='x'/>" +
                      include("model://branch", "branch", "1 0 0 0 0 0") + "</model></model>"));
  EXPECT_EQ(mesh.triangles.size(), 12U);
  expect_bounds(mesh, {10.5, 4.5, 1.5}, {11.5, 5.5, 2.5});
}

TEST_F(SdfWorld, MeshesAreScaledAndTakenAsTheyStand) {
  folder_.write("models/box/meshes/box.dae", testing::box_dae("Y_UP", 0.01));
  write_model("box", "<link name='l'>" +
                         visual("<mesh><uri>model://box/meshes/box.dae</uri>"
                                "<scale>2 1 1</scale></mesh>") +
                         "</link>");
  const TriangleMesh mesh = load(world_with(include("model://box", "a", "0 0 0 0 0 0")));
  expect_bounds(mesh, {0, 0, -2}, {2, 3, 0});  // the unit is applied, <up_axis> is not
  EXPECT_NEAR(testing::signed_volume(mesh), 12.0, 1e-5);
}

TEST_F(SdfWorld, LaserRetroIsTheMaterialOfItsShapeOnRequest) {
  const auto shape = [](const std::string& kind, const std::string& name,
                        const std::string& retro) {
    return "<" + kind + " name='" + name + "'>" + retro + "<geometry>" + kUnitBox +
           "</geometry></" + kind + ">";
  };
  const std::string world =
      world_with("<model name='m'><link name='l'>" + shape("visual", "plain", "") +
                 shape("visual", "dark", "<laser_retro>51</laser_retro>") +
                 shape("collision", "sign", "<laser_retro>2550</laser_retro>") + "</link></model>");
  EXPECT_TRUE(load(world).material_ids.empty());
  SdfOptions options;
  options.materials = MaterialSource::kFile;
  const TriangleMesh visuals = load(world, options);
  ASSERT_EQ(visuals.triangles.size(), 24U);
  EXPECT_EQ(visuals.material(0), Material{});
  EXPECT_DOUBLE_EQ(visuals.material(12).reflectivity, 0.2);
  options.shapes = ShapeKind::kCollision;
  EXPECT_DOUBLE_EQ(load(world, options).material(0).retro, 9.0);
}

TEST_F(SdfWorld, AMirroringScaleKeepsNormalsOutward) {
  folder_.write("worlds/box.obj", testing::box_obj());
  const TriangleMesh mesh = load(world_of("<mesh><uri>box.obj</uri><scale>-1 1 1</scale></mesh>"));
  expect_bounds(mesh, {-1, 0, 0}, {0, 2, 3});
  EXPECT_NEAR(testing::signed_volume(mesh), 6.0, 1e-6);
}

TEST_F(SdfWorld, MeshPathsAreRelativeToTheFileThatNamesThem) {
  folder_.write("models/box/box.obj", testing::box_obj());
  write_model("box", "<link name='l'>" + visual("<mesh><uri>box.obj</uri></mesh>") + "</link>");
  EXPECT_EQ(load(world_with(include("model://box", "a", "0 0 0 0 0 0"))).triangles.size(), 12U);
}

TEST_F(SdfWorld, ASubmeshIsTakenAloneAndCenteredWhenAsked) {
  folder_.write("worlds/two.dae", testing::two_boxes_dae());
  const auto submesh = [](const std::string& content) {
    return world_of("<mesh><uri>two.dae</uri><submesh>" + content + "</submesh></mesh>");
  };
  expect_bounds(load(submesh("<name>second</name>")), {10, 0, 0}, {12, 4, 6});
  expect_bounds(load(submesh("<name>second</name><center>true</center>")), {-1, -2, -3}, {1, 2, 3});
  EXPECT_THAT(input_error_of([&] { load(submesh("<name>third</name>")); }),
              AllOf(HasSubstr("third"), HasSubstr("two.dae")));
}

TEST_F(SdfWorld, VisualOrCollisionShapesAreTaken) {
  const std::string text =
      world_with("<model name='m'><link name='l'>" + visual(kUnitBox) +
                 collision("<box><size>3 3 3</size></box>") + "</link></model>");
  EXPECT_DOUBLE_EQ(load(text).area(), 6.0);
  EXPECT_DOUBLE_EQ(load(text, {ShapeKind::kCollision, {}, false}).area(), 54.0);
}

TEST_F(SdfWorld, AMissingModelIsNamedWithTheWorldAndTheFoldersSearched) {
  const std::string text =
      world_with("<model name='m'><link name='l'>" + visual(kUnitBox) + "</link></model>" +
                 include("model://cone", "a", "0 0 0 0 0 0"));
  const std::string error = input_error_of([&] { load(text); });
  EXPECT_THAT(error,
              AllOf(HasSubstr("model://cone"), HasSubstr("test.world"),
                    HasSubstr((folder_.path() / "models").string()), HasSubstr("--allow-missing")));
  EXPECT_EQ(load(text, {ShapeKind::kVisual, {}, true}).triangles.size(), 12U);
  EXPECT_THAT(log_.warnings, HasSubstr("model://cone"));
}

TEST_F(SdfWorld, AModelMissingWithinAModelIsNoSilentHole) {
  write_model("branch", "<link name='stem'>" + visual(kUnitBox) + "</link>" +
                            include("model://leaf", "leaf", "0 0 2 0 0 0"));
  const std::string text = world_with(include("model://branch", "a", "0 0 0 0 0 0"));
  EXPECT_THAT(input_error_of([&] { load(text); }), HasSubstr("model://leaf"));
  EXPECT_EQ(load(text, {ShapeKind::kVisual, {}, true}).triangles.size(), 12U);
  EXPECT_THAT(log_.warnings, HasSubstr("model://leaf"));
}

TEST_F(SdfWorld, AModelThatCannotBeReadWithinAModelIsNoSilentHole) {
  folder_.write("models/leaf/model.config", kModelConfig);
  folder_.write("models/leaf/model.sdf", "<sdf version='1.6'><model name='m'><link");
  write_model("branch", "<link name='stem'>" + visual(kUnitBox) + "</link>" +
                            include("model://leaf", "leaf", "0 0 2 0 0 0"));
  const std::string text = world_with(include("model://branch", "a", "0 0 0 0 0 0"));
  EXPECT_THAT(input_error_of([&] { load(text); }), HasSubstr("branch"));
}

TEST_F(SdfWorld, TheSunIsNoHoleWhateverItsUri) {
  for (const char* uri :
       {"model://sun", "model://Sun/2", "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Sun",
        "https://fuel.ignitionrobotics.org/1.0/openrobotics/models/sun/tip"}) {
    const std::string text = world_with("<model name='m'><link name='l'>" + visual(kUnitBox) +
                                        "</link></model>" + include(uri, "sun", "0 0 0 0 0 0"));
    EXPECT_EQ(load(text).triangles.size(), 12U) << uri;
    EXPECT_EQ(log_.warnings, "");
  }
}

TEST_F(SdfWorld, TheGroundPlaneIsBuiltInWhateverItsUri) {
  for (const char* uri :
       {"model://ground_plane", "model://Ground Plane/model.sdf",
        "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Ground Plane",
        "https://fuel.ignitionrobotics.org/1.0/openrobotics/models/ground-plane/3",
        "http://host/models/Ground%20Plane/tip/files/model.sdf"}) {
    const std::string text = world_with(include(uri, "floor", "1 2 3 0 0 0"));
    const TriangleMesh mesh = load(text);
    EXPECT_EQ(mesh.triangles.size(), 2U) << uri;
    expect_bounds(mesh, {-49, -48, 3}, {51, 52, 3});
    EXPECT_EQ(load(text, {ShapeKind::kCollision, {}, false}).triangles.size(), 2U);
    EXPECT_EQ(log_.warnings, "");
  }
}

TEST_F(SdfWorld, TwoGroundPlanesWithinModelsHaveTheirPlaces) {
  write_model("floor", "<link name='l'/>" + include("model://ground_plane", "p", "0 0 1 0 0 0"));
  const TriangleMesh mesh = load(world_with(include("model://floor", "a", "0 0 0 0 0 0") +
                                            include("model://floor", "b", "0 0 5 0 0 0")));
  EXPECT_EQ(mesh.triangles.size(), 4U);
  expect_bounds(mesh, {-50, -50, 1}, {50, 50, 6});
}

TEST_F(SdfWorld, AGroundPlaneOfOnesOwnIsTakenInsteadOfTheOneBuiltIn) {
  write_model("ground_plane", "<link name='l'>" + visual(kUnitBox) + "</link>");
  EXPECT_EQ(load(world_with(include("model://ground_plane", "p", "0 0 0 0 0 0"))).triangles.size(),
            12U);
}

TEST_F(SdfWorld, ModelsThatAreMerelyCalledAlikeAreMissing) {
  for (const char* uri : {"model://sunflower", "model://ground_plane_asphalt", "model://sun_lamp",
                          "https://host/1.0/sun/models/Chair", "https://host/1.0/o/models/"}) {
    const std::string text = world_with(include(uri, "a", "0 0 0 0 0 0"));
    EXPECT_THAT(input_error_of([&] { load(text); }), HasSubstr(uri));
  }
}

TEST_F(SdfWorld, AMissingMeshIsNamedWithItsShape) {
  const std::string text = world_of("<mesh><uri>model://box/none.obj</uri></mesh>");
  EXPECT_THAT(input_error_of([&] { load(text); }),
              AllOf(HasSubstr("model://box/none.obj"), HasSubstr("m/l/v")));
}

TEST_F(SdfWorld, AMeshWithoutFacesIsAnErrorOfThatFile) {
  folder_.write("worlds/points.obj", "v 0 0 0\nv 1 0 0\np 1 2\n");
  const std::string text = world_of("<mesh><uri>points.obj</uri></mesh>");
  EXPECT_THAT(input_error_of([&] { load(text); }), HasSubstr("points.obj"));
}

TEST_F(SdfWorld, AShapeThatIsNotSupportedIsNoSilentHole) {
  const std::string text = world_with(
      "<model name='m'><link name='l'>" + visual(kUnitBox) +
      "</link></model>"
      "<model name='hill'><link name='l'>" +
      visual("<heightmap><uri>hill.png</uri><size>9 9 1</size></heightmap>") + "</link></model>");
  EXPECT_THAT(input_error_of([&] { load(text); }),
              AllOf(HasSubstr("heightmap"), HasSubstr("hill")));
  EXPECT_EQ(load(text, {ShapeKind::kVisual, {}, true}).triangles.size(), 12U);
  EXPECT_THAT(log_.warnings, HasSubstr("heightmap"));
  EXPECT_THAT(input_error_of([&] { load(text); }), Not(HasSubstr("GAZEBO_MODEL_PATH")));
}

TEST_F(SdfWorld, APolylineIsAPrism) {
  const TriangleMesh prism = load(
      world_of("<polyline><point>0 0</point><point>3 0</point><point>3 3</point><point>2 3</point>"
               "<point>2 1</point><point>1 1</point><point>1 3</point><point>0 3</point>"
               "<height>2</height></polyline>"));
  expect_bounds(prism, {0, 0, 0}, {3, 3, 2});
  EXPECT_NEAR(prism.area(), 2 * 7 + 2 * 16, 1e-12);
  EXPECT_NEAR(testing::signed_volume(prism), 14.0, 1e-12);
}

TEST_F(SdfWorld, ModelsAreWhereTheSavedStateHasThem) {
  const std::string text = world_with(
      "<model name='box'><pose>0 0 0.5 0 0 0</pose><link name='l'>" + visual(kUnitBox) +
      "</link></model>"
      "<state world_name='w'><sim_time>12 0</sim_time><model name='box'>"
      "<pose>5 3 0.5 0 0 0</pose><scale>1 1 1</scale>"
      "<link name='l'><pose>5 3 0.5 0 0 0</pose><velocity>0 0 0 0 0 0</velocity></link></model>"
      "</state>");
  expect_bounds(load(text), {4.5, 2.5, 0}, {5.5, 3.5, 1});
  EXPECT_EQ(log_.warnings, "");
}

TEST_F(SdfWorld, ASavedStateMovesLinksAndNestedModels) {
  const std::string text = world_with(
      "<model name='door'><link name='frame'>" + visual(kUnitBox) + "</link><link name='leaf'>" +
      visual(kUnitBox) +
      "</link></model>"
      "<state world_name='w'><model name='door'><pose>10 0 0 0 0 0</pose>"
      "<link name='leaf'><pose>12 0 0 0 0 1.5707963267948966</pose></link></model></state>");
  expect_bounds(load(text), {9.5, -0.5, -0.5}, {12.5, 0.5, 0.5});
}

TEST_F(SdfWorld, ThePlacementFrameOfAModelFileIsPlaced) {
  const std::string text =
      "<?xml version='1.0'?><sdf version='1.9'><model name='m' placement_frame='l'>"
      "<pose>10 0 0 0 0 0</pose><link name='l'><pose>1 0 0 0 0 0</pose>" +
      visual(kUnitBox) + "</link></model></sdf>";
  expect_bounds(load(text), {9.5, -0.5, -0.5}, {10.5, 0.5, 0.5});
}

TEST_F(SdfWorld, WhatIsNotPlacedIsNamed) {
  load(world_with(
      "<model name='m'><link name='l'>" + visual(kUnitBox) +
      "</link></model><!-- <road/> --><road name='r'><width>3</width><point>0 0 0</point></road>"
      "<population name='p'><model_count>4</model_count></population>"
      "<actor name='a'><skin><filename>walk.dae</filename></skin></actor>"));
  EXPECT_THAT(log_.warnings, HasSubstr("left out: 1 <actor>, 1 <population>, 1 <road>"));
}

TEST_F(SdfWorld, AColorOutOfRangeOrAMasslessLinkDoesNotMatter) {
  const TriangleMesh mesh = load(
      world_with("<scene><ambient>150 150 150 255 </ambient></scene><model name='m'><link name='l'>"
                 "<inertial><mass>-1</mass></inertial>" +
                 visual(kUnitBox) + "</link></model>"));
  EXPECT_EQ(mesh.triangles.size(), 12U);
}

TEST_F(SdfWorld, FurtherFoldersAndTheEnvironmentAreSearched) {
  folder_.write("elsewhere/box/box.obj", testing::box_obj());
  const std::string text = world_of("<mesh><uri>model://box/box.obj</uri></mesh>");
  EXPECT_THROW(load(text), InputError);
  const auto elsewhere = folder_.path() / "elsewhere";
  EXPECT_EQ(load(text, {ShapeKind::kVisual, {elsewhere}, false}).triangles.size(), 12U);
  setenv("GAZEBO_MODEL_PATH", ("/nowhere:" + elsewhere.string()).c_str(), 1);
  EXPECT_EQ(load(text).triangles.size(), 12U);
  unsetenv("GAZEBO_MODEL_PATH");
}

TEST_F(SdfWorld, EscapesInUrisAreResolved) {
  write_model("my house", "<link name='l'>" + visual(kUnitBox) + "</link>");
  write_model("100%", "<link name='l'>" + visual(kUnitBox) + "</link>");
  const TriangleMesh mesh = load(world_with(include("model://my%20house", "a", "1 2 3 0 0 0") +
                                            include("model://100%", "b", "5 0 0 0 0 0")));
  EXPECT_EQ(mesh.triangles.size(), 24U);
}

TEST_F(SdfWorld, AModelFileAloneIsAWorldToo) {
  folder_.write("models/box/meshes/box.obj", testing::box_obj());
  write_model("box", "<pose>1 0 0 0 0 0</pose><link name='l'><pose>0 1 0 0 0 0</pose>" +
                         visual("<mesh><uri>model://box/meshes/box.obj</uri></mesh>") + "</link>");
  expect_bounds(load_sdf(folder_.path() / "models/box/model.sdf", {}, log_), {1, 1, 0}, {2, 3, 3});
}

TEST_F(SdfWorld, OneClearErrorForEachThingThatCanBeWrong) {
  EXPECT_THAT(input_error_of([&] { load_sdf(folder_.path() / "none.world", {}, log_); }),
              AllOf(HasSubstr("none.world"), HasSubstr("cannot be opened")));
  for (const std::string& text :
       {std::string("no XML"), std::string("<sdf version='1.6'><world>"), std::string("<robot/>"),
        std::string("<sdf version='1.6'/>"), world_with(""),
        world_with("<model name='m'><link name='l'/></model>")}) {
    EXPECT_THAT(input_error_of([&] { load(text); }), HasSubstr("test.world")) << text;
  }
  EXPECT_THAT(input_error_of([&] {
                load(world_with("<model name='m'><link name='l'>" + collision(kUnitBox) +
                                "</link></model>"));
              }),
              HasSubstr("shapes: collision"));
}

}  // namespace
}  // namespace lidarena::world
