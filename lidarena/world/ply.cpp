// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/ply.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <sstream>

#include "lidarena/base/error.hpp"
#include "lidarena/base/ply_reader.hpp"
#include "lidarena/world/polygon.hpp"

namespace lidarena::world {

namespace {

/// Removes "KEY=VALUE " from the start of `text` and returns the value; 0 if it does not begin so.
double take_value(std::string& text, const std::string& key) {
  std::istringstream words(text);
  std::string word;
  words >> word >> std::ws;
  double value = 0.0;
  if (!word.starts_with(key + "=")) return value;
  std::istringstream(word.substr(key.size() + 1)) >> value;
  text.erase(0, std::min(text.size(), word.size() + 1));
  return value;
}

/// The material in a comment written by save_ply(): "material REFLECTIVITY SPECULAR NAME", before
/// the name "transmission=X " and "retro=X " where they are not 0; empty for other comments.
std::optional<Material> parse_material(const std::string& comment) {
  std::istringstream words(comment);
  std::string keyword;
  Material material;
  words >> keyword >> material.reflectivity >> material.specular >> std::ws;
  const auto is_share = [](double x) { return x >= 0.0 && x <= 1.0; };
  if (keyword != "material" || !std::getline(words, material.name)) return std::nullopt;
  material.transmission = take_value(material.name, "transmission");
  material.retro = take_value(material.name, "retro");
  if (!is_share(material.reflectivity) || !is_share(material.specular) ||
      !is_share(material.transmission) || !(material.retro >= 0.0)) {
    return std::nullopt;
  }
  return material;
}

std::string comment_of(const Material& material) {
  std::string text =
      fmt::format("comment material {} {} ", material.reflectivity, material.specular);
  if (material.transmission > 0.0) text += fmt::format("transmission={} ", material.transmission);
  if (material.retro > 0.0) text += fmt::format("retro={} ", material.retro);
  text += material.name + "\n";
  return material.object.empty() ? text : text + "comment object " + material.object + "\n";
}

/// The materials of a file that save_ply() wrote.
std::vector<Material> palette_of(const PlyReader& reader) {
  constexpr std::string_view kObject = "object ";
  std::vector<Material> palette;
  for (const std::string& comment : reader.comments()) {
    if (const auto material = parse_material(comment)) {
      palette.push_back(*material);
    } else if (comment.starts_with(kObject) && !palette.empty()) {
      palette.back().object = comment.substr(kObject.size());
    }
  }
  return palette;
}

void read_vertices(const PlyElement& element, PlyReader& reader, TriangleMesh& mesh) {
  mesh.vertices.reserve(std::min(element.count, reader.bytes_left()));
  for (std::size_t i = 0; i < element.count; ++i) {
    Eigen::Vector3d vertex = Eigen::Vector3d::Zero();
    reader.begin_row();
    for (const PlyProperty& property : element.properties) {
      std::uint32_t count = property.count_type ? reader.next_index(*property.count_type) : 1;
      for (; count > 0; --count) {
        const double value = reader.next(property.type);
        if (property.name == "x") vertex.x() = value;
        if (property.name == "y") vertex.y() = value;
        if (property.name == "z") vertex.z() = value;
      }
    }
    reader.end_row();
    mesh.vertices.push_back(vertex);
  }
}

/// Reads one row of an element; stores the corners and the material if it is a face.
void read_row(const PlyElement& element, PlyReader& reader, std::vector<std::uint32_t>& corners,
              std::uint32_t& material) {
  reader.begin_row();
  for (const PlyProperty& property : element.properties) {
    const bool holds_corners = property.count_type && (property.name == "vertex_indices" ||
                                                       property.name == "vertex_index");
    const bool holds_material = !property.count_type && property.name == "material_index";
    std::uint32_t count = property.count_type ? reader.next_index(*property.count_type) : 1;
    for (; count > 0; --count) {
      if (holds_corners) {
        corners.push_back(reader.next_index(property.type));
      } else if (holds_material) {
        material = reader.next_index(property.type);
      } else {
        reader.next(property.type);
      }
    }
  }
  reader.end_row();
}

void check_corners(const std::vector<std::uint32_t>& corners, const TriangleMesh& mesh,
                   const std::string& name) {
  for (const std::uint32_t corner : corners) {
    if (corner < mesh.vertices.size()) continue;
    throw InputError(name, fmt::format("a face has vertex index {}, number of vertices: {}", corner,
                                       mesh.vertices.size()));
  }
}

void read_faces(const PlyElement& element, PlyReader& reader, TriangleMesh& mesh,
                const std::string& name) {
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < element.count; ++i) {
    corners.clear();
    std::uint32_t material = 0;
    read_row(element, reader, corners, material);
    if (!mesh.palette.empty() && material >= mesh.palette.size()) {
      throw InputError(name, "a face has material index " + std::to_string(material) +
                                 ", number of materials: " + std::to_string(mesh.palette.size()));
    }
    check_corners(corners, mesh, name);
    for (const Triangle& triangle : triangulate(corners, mesh.vertices)) {
      mesh.triangles.push_back(triangle);
      if (!mesh.palette.empty()) mesh.material_ids.push_back(static_cast<std::uint8_t>(material));
    }
  }
}

}  // namespace

TriangleMesh read_ply(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(name, "cannot be opened", "check the path and the permissions");
  std::ostringstream buffer;
  buffer << in.rdbuf();
  const std::string bytes = std::move(buffer).str();
  PlyReader reader(bytes, name);
  TriangleMesh mesh;
  mesh.palette = palette_of(reader);
  if (mesh.palette.size() > 256) throw InputError(name, "has more than 256 materials");
  for (const PlyElement& element : reader.elements()) {
    if (element.name == "vertex" && !element.properties.empty()) {
      read_vertices(element, reader, mesh);
    } else if (element.name == "face" && !element.properties.empty()) {
      read_faces(element, reader, mesh, name);
    } else {
      reader.skip(element);
    }
  }
  return mesh;
}

void save_ply(const std::filesystem::path& file, const TriangleMesh& mesh) {
  std::filesystem::path part = file;
  part += ".part";
  std::ofstream out(part, std::ios::binary | std::ios::trunc);
  const bool has_materials = !mesh.material_ids.empty();
  out << "ply\nformat binary_little_endian 1.0\ncomment meters, z up\n";
  for (const Material& material : mesh.palette) out << comment_of(material);
  out << "element vertex " << mesh.vertices.size()
      << "\nproperty double x\nproperty double y\nproperty double z\n"
      << "element face " << mesh.triangles.size() << "\nproperty list uchar uint vertex_indices\n"
      << (has_materials ? "property uchar material_index\n" : "") << "end_header\n";
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    out.write(reinterpret_cast<const char*>(vertex.data()), 3 * sizeof(double));
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto* corners = reinterpret_cast<const char*>(mesh.triangles[i].data());
    out.put(3).write(corners, sizeof(Triangle));
    if (has_materials) out.put(static_cast<char>(mesh.material_ids[i]));
  }
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(part, file, error);
  if (!out || error) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw Error(file.string() + ": cannot be written; check folder, permissions and free space");
  }
}

}  // namespace lidarena::world
