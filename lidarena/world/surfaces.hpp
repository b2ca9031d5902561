// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>

#include "lidarena/base/time.hpp"
#include "lidarena/world/material.hpp"

namespace lidarena::world {

/// A half-line; `direction` has unit length.
struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3f direction;
};

/// Hint about the order of the rays, for speed. The hits are the same up to rounding.
enum class RayOrder {
  kAny,
  kNeighbors  ///< rays 8k ... 8k + 7 have nearly equal origins and directions: about twice as fast
};

/// Result of a ray cast: the first surface along the ray.
struct Hit {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  float range = std::numeric_limits<float>::infinity();  ///< m; infinity when nothing was hit
  std::uint32_t triangle = kNone;                        ///< its index in the world
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();      ///< unit, points to the ray's side
  bool valid() const { return triangle != kNone; }
};

/// Interface of a scene that rays can be cast into.
class Surfaces {
 public:
  virtual ~Surfaces() = default;
  /// Computes the first hit of each ray within `max_range` meters; `hits` has the length of `rays`.
  /// Triangles are hit from both sides.
  virtual void cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
                    RayOrder order = RayOrder::kAny) const = 0;
  /// The same at `t` after the start of the flight; surfaces that do not move ignore it.
  virtual void cast_at(Time /*t*/, std::span<const Ray> rays, double max_range, std::span<Hit> hits,
                       RayOrder order = RayOrder::kAny) const {
    cast(rays, max_range, hits, order);
  }
  /// Whether cast_at() depends on the time.
  virtual bool moves() const { return false; }
  /// Whether a material has a `retro` above 0; true if not known.
  virtual bool has_retroreflectors() const { return true; }
  /// Material of the surface with the triangle index of a hit.
  virtual const Material& material(std::uint32_t triangle) const = 0;
};

}  // namespace lidarena::world
