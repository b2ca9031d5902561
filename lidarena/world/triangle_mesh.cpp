// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/triangle_mesh.hpp"

#include <algorithm>
#include <limits>

#include "lidarena/base/error.hpp"

namespace lidarena::world {

using Eigen::Vector3d;

Eigen::AlignedBox3d TriangleMesh::bounds() const {
  Eigen::AlignedBox3d box;
  for (const Triangle& triangle : triangles) {
    for (const std::uint32_t corner : triangle) box.extend(vertices[corner]);
  }
  return box;
}

Vector3d TriangleMesh::cross(std::size_t triangle) const {
  const auto& [a, b, c] = triangles[triangle];
  return (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]);
}

double TriangleMesh::area() const {
  double twice = 0.0;
  for (std::size_t i = 0; i < triangles.size(); ++i) twice += cross(i).norm();
  return 0.5 * twice;
}

void TriangleMesh::paint(const Material& material) {
  palette = {material};
  material_ids.assign(triangles.size(), 0);
}

namespace {

/// Index of `material` in the palette of `mesh`; it is added if it is not there.
std::uint8_t material_id(TriangleMesh& mesh, const Material& material) {
  const auto found = std::ranges::find(mesh.palette, material);
  const auto id = static_cast<std::size_t>(found - mesh.palette.begin());
  if (id > std::numeric_limits<std::uint8_t>::max()) throw Error("a mesh has over 256 materials");
  if (found == mesh.palette.end()) mesh.palette.push_back(material);
  return static_cast<std::uint8_t>(id);
}

/// Assigns the materials of `other` to the triangles of `mesh` from index `first` on.
void append_materials(TriangleMesh& mesh, const TriangleMesh& other, std::size_t first) {
  if (mesh.material_ids.empty() && other.material_ids.empty()) return;  // all are the default
  if (mesh.material_ids.empty() && first > 0) {
    mesh.material_ids.assign(first, material_id(mesh, Material{}));
  }
  std::vector<std::uint8_t> ids;
  for (const Material& material : other.palette) ids.push_back(material_id(mesh, material));
  if (other.material_ids.empty()) {
    mesh.material_ids.resize(mesh.triangles.size(), material_id(mesh, Material{}));
  }
  for (const std::uint8_t id : other.material_ids) mesh.material_ids.push_back(ids[id]);
}

}  // namespace

void TriangleMesh::append(const TriangleMesh& other, const Pose& placement, const Vector3d& scale) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  const bool mirrored = scale.prod() < 0.0;
  vertices.reserve(vertices.size() + other.vertices.size());
  triangles.reserve(triangles.size() + other.triangles.size());
  for (const Vector3d& v : other.vertices) vertices.push_back(placement * scale.cwiseProduct(v));
  for (auto [a, b, c] : other.triangles) {
    if (mirrored) std::swap(b, c);
    triangles.push_back({first + a, first + b, first + c});
  }
  append_materials(*this, other, triangles.size() - other.triangles.size());
}

namespace {

/// True when the triangle's height is within the rounding of its coordinates: its normal is then
/// undefined.
bool is_degenerate(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const Vector3d &va = mesh.vertices[a], &vb = mesh.vertices[b], &vc = mesh.vertices[c];
  const double longest = std::max({(vb - va).norm(), (vc - vb).norm(), (va - vc).norm()});
  const double largest = std::max(
      {va.lpNorm<Eigen::Infinity>(), vb.lpNorm<Eigen::Infinity>(), vc.lpNorm<Eigen::Infinity>()});
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * largest;
  return !(mesh.cross(triangle).norm() > longest * rounding);
}

void check_materials(const TriangleMesh& mesh, const std::string& name) {
  if (mesh.material_ids.empty()) return;
  if (mesh.material_ids.size() != mesh.triangles.size()) {
    throw InputError(name, "has " + std::to_string(mesh.material_ids.size()) + " materials for " +
                               std::to_string(mesh.triangles.size()) + " triangles");
  }
  const std::size_t largest = *std::ranges::max_element(mesh.material_ids);
  if (largest >= mesh.palette.size()) {
    throw InputError(name, "has material index " + std::to_string(largest) +
                               ", number of materials: " + std::to_string(mesh.palette.size()));
  }
}

}  // namespace

std::size_t clean_mesh(TriangleMesh& mesh, const std::string& name) {
  if (mesh.empty()) throw InputError(name, "has no faces", "use a mesh of triangles");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!mesh.vertices[i].allFinite()) {
      throw InputError(name, "vertex " + std::to_string(i) + " is not finite");
    }
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t largest = *std::ranges::max_element(mesh.triangles[i]);
    if (largest >= mesh.vertices.size()) {
      throw InputError(name, "triangle " + std::to_string(i) + " has vertex index " +
                                 std::to_string(largest) +
                                 ", number of vertices: " + std::to_string(mesh.vertices.size()));
    }
  }
  check_materials(mesh, name);
  std::vector<Triangle> kept;
  std::vector<std::uint8_t> kept_materials;
  kept.reserve(mesh.triangles.size());
  kept_materials.reserve(mesh.material_ids.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (is_degenerate(mesh, i)) continue;
    kept.push_back(mesh.triangles[i]);
    if (!mesh.material_ids.empty()) kept_materials.push_back(mesh.material_ids[i]);
  }
  if (kept.empty()) {
    throw InputError(name, "has only degenerate faces (zero area)",
                     "use a mesh of triangles with an area");
  }
  const std::size_t dropped = mesh.triangles.size() - kept.size();
  mesh.triangles = std::move(kept);
  mesh.material_ids = std::move(kept_materials);
  return dropped;
}

namespace {

Vector3d closest_point_on_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d ab = b - a;
  const double length2 = ab.squaredNorm();
  if (length2 == 0.0) return a;
  return a + std::clamp(ab.dot(p - a) / length2, 0.0, 1.0) * ab;
}

}  // namespace

Vector3d closest_point_on_triangle(const Vector3d& p, const Vector3d& a, const Vector3d& b,
                                   const Vector3d& c) {
  const Vector3d normal = (b - a).cross(c - a);
  const auto left_of = [&](const Vector3d& from, const Vector3d& to) {
    return normal.dot((to - from).cross(p - from)) >= 0.0;
  };
  const double normal2 = normal.squaredNorm();
  if (normal2 > 0.0 && left_of(a, b) && left_of(b, c) && left_of(c, a)) {
    return p - normal * (normal.dot(p - a) / normal2);  // the projection lies inside the triangle
  }
  Vector3d best = closest_point_on_segment(p, a, b);
  for (const Vector3d& candidate :
       {closest_point_on_segment(p, b, c), closest_point_on_segment(p, c, a)}) {
    if ((candidate - p).squaredNorm() < (best - p).squaredNorm()) best = candidate;
  }
  return best;
}

}  // namespace lidarena::world
