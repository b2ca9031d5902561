// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/file_material.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "lidarena/world/mesh_io.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/world/complaints.hpp"
#include "tests/world/cube_files.hpp"

namespace lidarena::world {
namespace {

using ::testing::HasSubstr;
using testing::input_error_of;

std::map<std::string, Material> materials_of(const TriangleMesh& mesh) {
  std::map<std::string, Material> materials;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    materials[mesh.material(i).name] = mesh.material(i);
  return materials;
}

void expect_optics(const Material& material, double reflectivity, double specular,
                   double transmission) {
  EXPECT_NEAR(material.reflectivity, reflectivity, 1e-6) << material.name;
  EXPECT_NEAR(material.specular, specular, 1e-6) << material.name;
  EXPECT_NEAR(material.transmission, transmission, 1e-6) << material.name;
  EXPECT_EQ(material.retro, 0.0) << material.name;
}

TEST(OpticalMaterial, FollowsItsRulesAtTheirLimits) {
  expect_optics(optical_material("matt", {.diffuse = 0.3, .glossy = 0.0}), 0.3, 0.0, 0.0);
  expect_optics(optical_material("clear", {.diffuse = 0.9, .opacity = 0.0}), 0.0, 0.0, 1.0);
  const Material mirror =
      optical_material("mirror", {.diffuse = 0.0, .glossy = 0.9, .roughness = 0.0});
  expect_optics(mirror, 0.9, 1.0, 0.0);
  EXPECT_NEAR(mirrored_share(mirror, 1.0), 0.9, 1e-12);
  const Material satin =
      optical_material("satin", {.diffuse = 0.2, .glossy = 0.4, .roughness = 0.5});
  expect_optics(satin, 0.6, 0.25 * 0.4 / 0.6, 0.0);
  EXPECT_EQ(optical_material("white", {.diffuse = 0.9, .glossy = 0.9}).reflectivity, 1.0);
}

/// Two of the box's six faces for each material.
std::string painted_box_obj() {
  std::string text = "mtllib box.mtl\n" + testing::box_obj();
  const std::pair<const char*, const char*> uses[] = {
      {"f 1 5", "gray"}, {"f 1 2", "varnish"}, {"f 1 3", "window"}};
  for (const auto& [face, name] : uses)
    text.insert(text.find(face), "usemtl " + std::string(name) + "\n");
  return text;
}

TEST(FileMaterials, OfMtlAreKdKsNsAndD) {
  const TemporaryFolder folder;
  folder.write("box.mtl",
               "newmtl gray\nKd 0.3 0.3 0.3\nKs 0.5 0.5 0.5\n"  // without Ns no gloss
               "newmtl varnish\nKd 0.4 0.2 0.1\nKs 0.3 0.3 0.3\nNs 98\n"
               "newmtl window\nKd 0.5 0.5 0.5\nKs 0 0 0\nNs 10\nd 0.25\n");
  const auto file = folder.write("box.obj", painted_box_obj());
  const auto found = materials_of(load_mesh(file, UpAxis::kFile, MaterialSource::kFile));
  ASSERT_EQ(found.size(), 3U);
  expect_optics(found.at("gray"), 0.3, 0.0, 0.0);
  const double brown = 0.2126 * 0.4 + 0.7152 * 0.2 + 0.0722 * 0.1;
  const double roughness = std::sqrt(2.0 / 100.0);
  expect_optics(found.at("varnish"), brown + 0.3,
                0.3 * std::pow(1.0 - roughness, 2) / (brown + 0.3), 0.0);
  expect_optics(found.at("window"), 0.5 * 0.25, 0.0, 0.75);
}

TEST(FileMaterials, AreLeftOutUnlessAskedForAndWhereAFileHasNone) {
  const TemporaryFolder folder;
  folder.write("box.mtl", "newmtl gray\nKd 0.3 0.3 0.3\nnewmtl varnish\nnewmtl window\n");
  const TriangleMesh plain = load_mesh(folder.write("box.obj", painted_box_obj()));
  EXPECT_TRUE(plain.material_ids.empty());
  for (const auto& [name, text] :
       std::map<std::string, std::string>{{"bare.obj", testing::box_obj()},
                                          {"bare.stl", testing::box_stl()},
                                          {"bare.dae", testing::box_dae("Z_UP", 1.0)},
                                          {"bare.gltf", testing::box_gltf()}}) {
    const TriangleMesh bare =
        load_mesh(folder.write(name, text), UpAxis::kFile, MaterialSource::kFile);
    for (std::size_t i = 0; i < bare.triangles.size(); ++i)
      EXPECT_EQ(bare.material(i), Material{}) << name;
  }
}

std::string gltf_of(const std::string& material) {
  std::string text = testing::box_gltf();
  text.replace(text.find("\"indices\": 1"), 12, "\"indices\": 1, \"material\": 0");
  text.insert(text.find("\"accessors\""), "\"materials\": [" + material + "],\n");
  if (material.find("KHR_materials_transmission") != std::string::npos)
    text.insert(1, "\"extensionsUsed\": [\"KHR_materials_transmission\"], ");
  return text;
}

TEST(FileMaterials, OfGltfAreColorMetalRoughnessAlphaAndTransmission) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& material) {
    const auto file = folder.write("box.gltf", gltf_of(material));
    return load_mesh(file, UpAxis::kFile, MaterialSource::kFile).material(0);
  };
  expect_optics(read(R"({"name": "paint", "pbrMetallicRoughness":
{"baseColorFactor": [0.5, 0.5, 0.5, 0.2], "metallicFactor": 0, "roughnessFactor": 1}})"),
                0.54, 0.0, 0.0);  // opaque: alpha is ignored
  expect_optics(read(R"({"name": "chrome", "pbrMetallicRoughness":
{"baseColorFactor": [0.6, 0.6, 0.6, 1], "metallicFactor": 1, "roughnessFactor": 0.1}})"),
                0.6, 0.81, 0.0);
  expect_optics(read(R"({"name": "film", "alphaMode": "BLEND", "pbrMetallicRoughness":
{"baseColorFactor": [0.5, 0.5, 0.5, 0.2], "metallicFactor": 0, "roughnessFactor": 1}})"),
                0.5 * 0.2 + 0.04, 0.0, 0.8);
  expect_optics(read(R"({"name": "glass", "extensions": {"KHR_materials_transmission":
{"transmissionFactor": 0.9}}, "pbrMetallicRoughness":
{"baseColorFactor": [1, 1, 1, 1], "metallicFactor": 0, "roughnessFactor": 0}})"),
                0.1 + 0.04, 0.04 / 0.14, 0.9);
}

TEST(FileMaterials, MoreThanAMeshCanHaveAreAnErrorWithARemedy) {
  const TemporaryFolder folder;
  std::string mtl, obj = "mtllib many.mtl\n" + testing::box_obj();
  for (int i = 0; i < 300; ++i) {
    mtl += "newmtl m" + std::to_string(i) + "\nKd 0.1 0.1 0.1\n";
    obj += "usemtl m" + std::to_string(i) + "\nf 1 2 4\n";
  }
  folder.write("many.mtl", mtl);
  const auto file = folder.write("many.obj", obj);
  EXPECT_THAT(input_error_of([&] { load_mesh(file, UpAxis::kFile, MaterialSource::kFile); }),
              HasSubstr("materials: default"));
  EXPECT_EQ(load_mesh(file).triangles.size(), 312U);
}

TEST(LaserRetro, IsAnIntensityOf255ForWhiteAndMoreForAReflector) {
  EXPECT_EQ(laser_retro_material(0.0).name, "");
  EXPECT_DOUBLE_EQ(backscatter(laser_retro_material(51.0), 1.0), 0.2);
  EXPECT_DOUBLE_EQ(backscatter(laser_retro_material(255.0), 1.0), 1.0);
  EXPECT_DOUBLE_EQ(backscatter(laser_retro_material(25500.0), 1.0), 100.0);
  EXPECT_DOUBLE_EQ(laser_retro_material(25500.0).retro, 99.0);
}

}  // namespace
}  // namespace lidarena::world
