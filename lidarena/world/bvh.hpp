// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <utility>

#include "lidarena/world/box_tree.hpp"
#include "lidarena/world/mesh_tree.hpp"
#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena::world {

/// A bounding volume hierarchy (see box_tree.hpp) that depends on Eigen only. Ray-triangle tests
/// use double precision and are watertight: no ray passes between two triangles that share an edge
/// (Woop, Benthin and Wald, "Watertight ray/triangle intersection", 2013). The same mesh gives the
/// same tree; of triangles hit at the same range the one with the lower index is reported.
class Bvh : public MeshTree {
 public:
  /// Keeps a reference to the mesh, which must be clean (see clean_mesh), must not be moved in
  /// memory, and must outlive this object.
  explicit Bvh(const TriangleMesh& mesh);

  void cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
            RayOrder order) const override;
  bool occluded(const Ray& ray, double near, double far) const override;
  void visit_near(const Eigen::Vector3d& point, double radius,
                  TriangleVisitor& visitor) const override;
  /// Range (m) and triangle of the first hit within `max_range`; Hit::kNone when there is none.
  std::pair<double, std::uint32_t> first_hit(const Ray& ray, double max_range) const;

 private:
  template <typename OnHit>
  void walk(const Ray& ray, double near, double& far, const OnHit& on_hit) const;

  const TriangleMesh& mesh_;
  Eigen::Vector3d center_;
  BoxTree tree_;  ///< boxes relative to `center_`, enlarged by a margin that covers rounding
};

}  // namespace lidarena::world
