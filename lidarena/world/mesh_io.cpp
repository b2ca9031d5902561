// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/mesh_io.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <limits>

#include "lidarena/base/error.hpp"
#include "lidarena/world/ply.hpp"

namespace lidarena::world {

namespace {

std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

Eigen::Affine3d to_eigen(const aiMatrix4x4& m) {
  Eigen::Matrix4d matrix;
  matrix << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2,
      m.d3, m.d4;
  return Eigen::Affine3d(matrix);
}

Eigen::Affine3d z_up_from_y_up() {
  Eigen::Matrix3d turn;  // keeps x and maps y to z
  turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return Eigen::Affine3d(turn);
}

/// Rotation to z up that remains to be applied to the importer's output. When the importer honors a
/// DAE's <up_axis>, its output is always y up.
Eigen::Affine3d upright_from_file(const std::string& ending, UpAxis up) {
  const bool is_y_up =
      up == UpAxis::kY ||
      (up == UpAxis::kFile && (ending == ".dae" || ending == ".gltf" || ending == ".glb"));
  return is_y_up ? z_up_from_y_up() : Eigen::Affine3d::Identity();
}

TriangleMesh to_mesh(const aiMesh& source, const Eigen::Affine3d& placement) {
  TriangleMesh mesh;
  mesh.vertices.reserve(source.mNumVertices);
  for (unsigned i = 0; i < source.mNumVertices; ++i) {
    const aiVector3D& v = source.mVertices[i];
    mesh.vertices.push_back(placement * Eigen::Vector3d(v.x, v.y, v.z));
  }
  const bool mirrored = placement.linear().determinant() < 0.0;
  for (unsigned i = 0; i < source.mNumFaces; ++i) {
    const aiFace& face = source.mFaces[i];
    if (face.mNumIndices != 3) continue;  // skip points and lines
    Triangle triangle{face.mIndices[0], face.mIndices[1], face.mIndices[2]};
    if (mirrored) std::swap(triangle[1], triangle[2]);
    mesh.triangles.push_back(triangle);
  }
  merge_vertices(mesh);
  return mesh;
}

/// Throws InputError when the importer's single precision is too coarse for the coordinates, as it
/// is for meshes in map coordinates.
void check_precision(const aiMesh& source, const Eigen::Affine3d& placement,
                     const std::string& name) {
  constexpr double kLargestRounding = 5e-3;  // m, a tenth of a good LiDAR's noise
  double largest = 0.0;
  for (unsigned i = 0; i < source.mNumVertices; ++i) {
    const aiVector3D& v = source.mVertices[i];
    largest =
        std::max({largest, std::abs(double{v.x}), std::abs(double{v.y}), std::abs(double{v.z})});
  }
  const double scale = placement.linear().colwise().norm().maxCoeff();
  const double rounding = 0.5 * std::numeric_limits<float>::epsilon() * largest * scale;
  if (rounding <= kLargestRounding) return;
  throw InputError(name,
                   "its coordinates reach " + std::to_string(largest * scale) +
                       " m, which the reader of this format would round by up to " +
                       std::to_string(rounding) + " m",
                   "move the mesh near its origin, or save it as PLY with double coordinates");
}

void collect(const aiScene& scene, const aiNode& node, const Eigen::Affine3d& world_from_parent,
             const std::string& name, MaterialSource materials, std::vector<MeshPart>& parts) {
  const Eigen::Affine3d world_from_node = world_from_parent * to_eigen(node.mTransformation);
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const aiMesh& source = *scene.mMeshes[node.mMeshes[i]];
    check_precision(source, world_from_node, name);
    TriangleMesh surface = to_mesh(source, world_from_node);
    if (surface.empty()) continue;
    if (materials == MaterialSource::kFile)
      surface.paint(file_material(*scene.mMaterials[source.mMaterialIndex]));
    parts.push_back({node.mName.C_Str(), source.mName.C_Str(), std::move(surface)});
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) {
    collect(scene, *node.mChildren[i], world_from_node, name, materials, parts);
  }
}

void check_number(const aiScene& scene, const std::string& name) {
  constexpr unsigned kMost = 255;  // of a mesh, beside Material{}
  if (scene.mNumMaterials <= kMost) return;
  throw InputError(name,
                   "has " + std::to_string(scene.mNumMaterials) + " materials, " +
                       std::to_string(kMost) + " are possible",
                   "merge some, or load it without them: materials: default");
}

std::vector<MeshPart> import_parts(const std::filesystem::path& file, UpAxis up,
                                   MaterialSource materials) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, up != UpAxis::kFile);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    throw InputError(file.string(),
                     std::string("cannot be read as a mesh: ") + importer.GetErrorString());
  }
  if (materials == MaterialSource::kFile) check_number(*scene, file.string());
  std::vector<MeshPart> parts;
  collect(*scene, *scene->mRootNode, upright_from_file(ending_of(file), up), file.string(),
          materials, parts);
  return parts;
}

std::vector<MeshPart> ply_parts(const std::filesystem::path& file, UpAxis up) {
  TriangleMesh mesh = read_ply(file);
  if (mesh.empty()) return {};
  if (up == UpAxis::kY) {
    for (Eigen::Vector3d& vertex : mesh.vertices) vertex = z_up_from_y_up() * vertex;
  }
  std::vector<MeshPart> parts;
  parts.push_back({"", file.stem().string(), std::move(mesh)});
  return parts;
}

}  // namespace

bool is_mesh_file(const std::filesystem::path& file) {
  static constexpr std::array<std::string_view, 6> kEndings{".obj", ".ply",  ".stl",
                                                            ".dae", ".gltf", ".glb"};
  return std::ranges::find(kEndings, ending_of(file)) != kEndings.end();
}

std::vector<MeshPart> load_mesh_parts(const std::filesystem::path& file, UpAxis up,
                                      MaterialSource materials) {
  if (!is_mesh_file(file)) {
    throw InputError(file.string(), "this file extension is not that of a supported mesh format",
                     "use .obj, .ply, .stl, .dae, .gltf or .glb");
  }
  if (!std::filesystem::is_regular_file(file)) {
    throw InputError(file.string(), "there is no such file", "check the path");
  }
  std::vector<MeshPart> parts =
      ending_of(file) == ".ply" ? ply_parts(file, up) : import_parts(file, up, materials);
  if (parts.empty()) {
    throw InputError(file.string(), "has no faces", "use a mesh of faces, not of points or lines");
  }
  return parts;
}

TriangleMesh load_mesh(const std::filesystem::path& file, UpAxis up, MaterialSource materials) {
  std::vector<MeshPart> parts = load_mesh_parts(file, up, materials);
  if (parts.size() == 1) return std::move(parts.front().surface);
  TriangleMesh mesh;
  for (const MeshPart& part : parts) mesh.append(part.surface);
  return mesh;
}

}  // namespace lidarena::world
