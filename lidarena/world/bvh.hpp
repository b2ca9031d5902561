// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/world/mesh_tree.hpp"
#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena {

/// A bounding volume hierarchy that needs Eigen alone: binary, split where the surface area
/// heuristic finds it cheapest among bins (Wald, "On fast construction of SAH-based bounding volume
/// hierarchies", 2007), walked with a small stack. Triangles are met in double precision by a test
/// that lets no ray slip between two that share an edge (Woop, Benthin and Wald, "Watertight
/// ray/triangle intersection", 2013). The same mesh gives the same tree; of triangles met at the
/// same range the one with the lower index is the hit.
class Bvh : public MeshTree {
 public:
  /// Refers to the mesh, which must be clean (see clean_mesh), stay where it is, and outlive it.
  explicit Bvh(const TriangleMesh& mesh);

  void cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
            RayOrder order) const override;
  bool occluded(const Ray& ray, double near, double far) const override;
  void visit_near(const Eigen::Vector3d& point, double radius,
                  TriangleVisitor& visitor) const override;

  /// A box (m, relative to the mesh's middle, a little too large so that rounding does not matter)
  /// and what is in it.
  struct Node {
    Eigen::AlignedBox3f box;
    std::uint32_t first = 0;  ///< of `count` triangles, or of two neighbouring nodes when 0
    std::uint32_t count = 0;
  };

 private:
  template <typename Meet>
  void walk(const Ray& ray, double near, double& far, const Meet& meet) const;

  const TriangleMesh& mesh_;
  Eigen::Vector3d centre_;
  std::vector<Node> nodes_;               ///< the root first
  std::vector<std::uint32_t> triangles_;  ///< in the order of the leaves
};

}  // namespace lidarena
