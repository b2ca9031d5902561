// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <string>

#include "lidarena/base/pose.hpp"
#include "lidarena/world/shape.hpp"
#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::gazebo_plugin {

/// Pose of the plane z = 0 with this normal.
Pose facing(const Eigen::Vector3d& normal);

/// What an SDF file takes from a mesh file.
struct MeshPart {
  std::string file;
  std::string submesh;    ///< empty: all of them
  bool centered = false;  ///< the sub-mesh is moved to the origin
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
};

/// Appends the triangles of a sub-mesh of a simulator: `vertex(i)` is the position of vertex i and
/// `index(i)` the number of a vertex, three a triangle. `origin` is subtracted.
template <class Vertex, class Index>
void append_submesh(unsigned int vertices, Vertex vertex, unsigned int indices, Index index,
                    const Eigen::Vector3d& origin, world::TriangleMesh& out) {
  const auto first = static_cast<std::uint32_t>(out.vertices.size());
  for (unsigned int i = 0; i < vertices; ++i) out.vertices.push_back(vertex(i) - origin);
  for (unsigned int i = 0; i + 2 < indices; i += 3) {
    out.triangles.push_back({first + static_cast<std::uint32_t>(index(i)),
                             first + static_cast<std::uint32_t>(index(i + 1)),
                             first + static_cast<std::uint32_t>(index(i + 2))});
  }
}

/// Shapes made of mesh files; each part is loaded once.
class MeshShapes {
 public:
  /// Returns the part's triangles without its scale. Throws InputError if there is no such file.
  using Load = std::function<world::TriangleMesh(const MeshPart& part)>;

  explicit MeshShapes(Load load) : load_(std::move(load)) {}

  /// Throws InputError if the part cannot be loaded, but only the first time; then nullptr.
  world::ShapePtr get(const MeshPart& part);

 private:
  Load load_;
  std::map<std::string, world::ShapePtr> shapes_;  ///< by file, part and scale
};

}  // namespace lidarena::gazebo_plugin
