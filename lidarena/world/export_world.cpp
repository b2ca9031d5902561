// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/export_world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <string_view>

#include "lidarena/base/error.hpp"
#include "lidarena/world/ply.hpp"

namespace lidarena::world {
namespace {

namespace fs = std::filesystem;

/// Writes to a temporary file and renames it, so that the file is never incomplete.
void write_whole(const fs::path& file, std::string_view text) {
  fs::path part = file;
  part += ".part";
  std::ofstream out(part, std::ios::binary | std::ios::trunc);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  std::error_code error;
  if (out) fs::rename(part, file, error);
  if (!out || error) {
    std::error_code ignored;
    fs::remove(part, ignored);
    throw Error(file.string() + ": cannot be written; check folder, permissions and free space");
  }
}

std::string model_name(const fs::path& file) {
  std::string name = file.stem().string();
  const bool plain = std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
  });
  if (name.empty() || !plain) {
    throw InputError(file.string(), "the file name is not valid as the name of an SDF model",
                     "use only letters, digits, '_', '-' and '.'");
  }
  return name;
}

/// A static model with the same mesh as visual and as collision shape.
std::string model_sdf(const std::string& name) {
  const std::string geometry =
      fmt::format("<geometry><mesh><uri>model://{0}/meshes/{0}.obj</uri></mesh></geometry>", name);
  return fmt::format(R"(<?xml version="1.0"?>
<sdf version="1.6">
  <model name="{0}">
    <static>true</static>
    <link name="link">
      <visual name="visual">{1}</visual>
      <collision name="collision">{1}</collision>
    </link>
  </model>
</sdf>
)",
                     name, geometry);
}

std::string model_config(const std::string& name) {
  return fmt::format(R"(<?xml version="1.0"?>
<model>
  <name>{}</name>
  <version>1.0</version>
  <sdf version="1.6">model.sdf</sdf>
  <description>Exported by Lidarena; meters, z up.</description>
</model>
)",
                     name);
}

std::string world_sdf(const std::string& name) {
  return fmt::format(R"(<?xml version="1.0"?>
<sdf version="1.6">
  <world name="{0}">
    <gravity>0 0 -9.80665</gravity>
    <light name="sun" type="directional">
      <pose>0 0 10 0 0 0</pose>
      <diffuse>0.8 0.8 0.8 1</diffuse>
      <specular>0.2 0.2 0.2 1</specular>
      <direction>-0.5 0.1 -0.9</direction>
    </light>
    <include><uri>model://{0}</uri></include>
  </world>
</sdf>
)",
                     name);
}

}  // namespace

void save_obj(const fs::path& file, const TriangleMesh& mesh) {
  std::string text = "# meters, z up\no " + file.stem().string() + "\n";
  text.reserve(40 * (mesh.vertices.size() + mesh.triangles.size()));
  auto out = std::back_inserter(text);
  for (const Eigen::Vector3d& v : mesh.vertices) {
    fmt::format_to(out, "v {:.9g} {:.9g} {:.9g}\n", v.x(), v.y(), v.z());
  }
  std::map<std::string, std::size_t> normals;  // numbers by what is written, from 1 on
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Eigen::Vector3d n = mesh.cross(i).normalized() + Eigen::Vector3d::Zero();  // no -0
    const auto [normal, is_new] = normals.try_emplace(
        fmt::format("vn {:.6g} {:.6g} {:.6g}\n", n.x(), n.y(), n.z()), normals.size() + 1);
    if (is_new) text += normal->first;
    const Triangle& t = mesh.triangles[i];  // OBJ indices start at 1
    fmt::format_to(out, "f {0}//{3} {1}//{3} {2}//{3}\n", t[0] + 1, t[1] + 1, t[2] + 1,
                   normal->second);
  }
  write_whole(file, text);
}

void save_sdf(const fs::path& file, const TriangleMesh& mesh) {
  const std::string name = model_name(file);
  const fs::path model = file.parent_path() / "models" / name;
  std::error_code error;
  fs::create_directories(model / "meshes", error);
  if (error) throw Error((model / "meshes").string() + ": cannot be created: " + error.message());
  save_obj(model / "meshes" / (name + ".obj"), mesh);
  write_whole(model / "model.sdf", model_sdf(name));
  write_whole(model / "model.config", model_config(name));
  write_whole(file, world_sdf(name));
}

void save_world(const fs::path& file, const TriangleMesh& mesh) {
  const std::string ending = file.extension().string();
  if (ending == ".ply") return save_ply(file, mesh);
  if (ending == ".obj") return save_obj(file, mesh);
  if (ending == ".sdf" || ending == ".world") return save_sdf(file, mesh);
  throw InputError(file.string(), "worlds cannot be written in a file with this extension",
                   "use .ply, .obj, .sdf or .world");
}

}  // namespace lidarena::world
