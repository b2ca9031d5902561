// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>

#include "lidarena/world/material.hpp"

namespace lidarena {

/// A half line; `direction` has unit length.
struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3f direction;
};

/// What the caster may expect of neighboring rays. Each ray's hit is the same up to rounding.
enum class RayOrder {
  kAny,
  kNeighbors  ///< rays 8k ... 8k + 7 start and point nearly alike: then about twice as fast
};

/// First surface along a ray.
struct Hit {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  float range = std::numeric_limits<float>::infinity();  ///< m; infinity when nothing was hit
  std::uint32_t triangle = kNone;                        ///< its index in the world
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();      ///< unit, turned towards the ray's origin
  bool valid() const { return triangle != kNone; }
};

/// What rays are cast at.
class Surfaces {
 public:
  virtual ~Surfaces() = default;
  /// First hit of each ray within `max_range` meters; `hits` has the length of `rays`. Faces are
  /// seen from both sides.
  virtual void cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
                    RayOrder order = RayOrder::kAny) const = 0;
  /// Of the surface that a hit names.
  virtual const Material& material(std::uint32_t triangle) const = 0;
};

}  // namespace lidarena
