// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>

#include "lidarena/base/parallel.hpp"
#include "lidarena/world/surfaces.hpp"
#include "lidarena/world/triangle_mesh.hpp"

namespace lidarena {

/// What finds the triangles. Answers are the same but for rounding: of a ray that meets two
/// triangles at one range, or an edge, either may be the hit.
enum class RayCaster {
  kEmbree,  ///< Embree, in single precision
  kBvh      ///< our own (see bvh.hpp): needs Eigen alone, in double precision, slower
};

/// Those of this build, the default first: Embree may be left out (LIDARENA_WITH_EMBREE).
std::span<const RayCaster> ray_casters();

/// Nearest point of the surface.
struct ClosestPoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double distance = std::numeric_limits<double>::infinity();  ///< m; infinity when none in reach
  std::uint32_t triangle = Hit::kNone;
  bool valid() const { return triangle != Hit::kNone; }
};

/// A mesh and the structure that answers questions about it. Move only; all queries are const,
/// thread safe, and exact up to single precision relative to the mesh's center.
class World : public Surfaces {
 public:
  /// Takes the mesh over and cleans it (see clean_mesh), so mesh() may have fewer triangles; throws
  /// InputError (place `name`) when it has no faces, Error when the build lacks the ray caster.
  explicit World(TriangleMesh mesh, const std::string& name = "mesh",
                 RayCaster caster = ray_casters().front());
  ~World() override;
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  /// Hits name triangles of mesh().
  void cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
            RayOrder order = RayOrder::kAny) const override;
  const Material& material(std::uint32_t triangle) const override;
  /// Nearest surface point of each point within `max_distance` meters, computed in double precision
  /// from the mesh itself; of triangles equally near, the one with the lower index. Points that are
  /// not finite have none. Fast where neighbors in the list are neighbors in space.
  void closest_points(std::span<const Eigen::Vector3d> points, double max_distance,
                      std::span<ClosestPoint> out, const Parallel& parallel) const;
  ClosestPoint closest_point(const Eigen::Vector3d& point,
                             double max_distance = std::numeric_limits<double>::infinity()) const;
  /// True when nothing blocks the straight way from `a` to `b`. Surfaces within single-precision
  /// rounding (about 2e-6 of the world's size) of either end do not block.
  bool visible(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;

  const TriangleMesh& mesh() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lidarena
