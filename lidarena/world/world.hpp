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

namespace lidarena::world {

/// Implementation of the ray queries. Results are equal up to rounding: when a ray meets two
/// triangles at the same range, or an edge, either triangle may be reported.
enum class RayCaster {
  kEmbree,  ///< Embree, in single precision
  kBvh      ///< built in (see bvh.hpp): depends on Eigen only, double precision, slower
};

/// The ray casters in this build, the default first. Embree is optional (LIDARENA_WITH_EMBREE).
std::span<const RayCaster> ray_casters();

/// The point of the surface that is nearest to a query point.
struct ClosestPoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double distance = std::numeric_limits<double>::infinity();  ///< m; infinity when none in range
  std::uint32_t triangle = Hit::kNone;
  bool valid() const { return triangle != Hit::kNone; }
};

/// A mesh and its acceleration structure for ray and nearest-point queries. Move-only; all queries
/// are const, thread-safe, and accurate to single precision relative to the mesh's center.
class World : public Surfaces {
 public:
  /// Takes ownership of the mesh and cleans it (see clean_mesh): mesh() may have fewer triangles.
  /// Throws InputError (place `name`) when it has no faces, Error when this build lacks the ray
  /// caster.
  explicit World(TriangleMesh mesh, const std::string& name = "mesh",
                 RayCaster caster = ray_casters().front());
  ~World() override;
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  /// The hits' `triangle` is an index into mesh().triangles.
  void cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
            RayOrder order = RayOrder::kAny) const override;
  const Material& material(std::uint32_t triangle) const override;
  bool has_retroreflectors() const override;
  /// Nearest surface point of each point within `max_distance` meters, computed in double precision
  /// from the mesh itself; of triangles equally near, the one with the lower index. Points that are
  /// not finite have none. Fastest when consecutive points of the list are close together.
  void closest_points(std::span<const Eigen::Vector3d> points, double max_distance,
                      std::span<ClosestPoint> out, const Parallel& parallel) const;
  ClosestPoint closest_point(const Eigen::Vector3d& point,
                             double max_distance = std::numeric_limits<double>::infinity()) const;
  /// True when no surface intersects the line segment from `a` to `b`. Surfaces within
  /// single-precision rounding (about 2e-6 of the world's size) of either end are ignored.
  bool visible(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;

  const TriangleMesh& mesh() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lidarena::world
