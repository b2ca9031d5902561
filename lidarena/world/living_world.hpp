// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "lidarena/world/mover_config.hpp"
#include "lidarena/world/shape.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::world {

/// A still world and bodies that move in it as functions of time (MovingWorld is one whose bodies
/// are set from outside). A hit's `triangle` is that of the still world's mesh, or the number of
/// its triangles plus the index of the mover. Const, thread-safe.
class LivingWorld : public Surfaces {
 public:
  /// Keeps a reference to `still`.
  LivingWorld(const World& still, const std::vector<MoverConfig>& movers);

  /// At the start of the flight.
  void cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
            RayOrder order = RayOrder::kAny) const override;
  void cast_at(Time t, std::span<const Ray> rays, double max_range, std::span<Hit> hits,
               RayOrder order = RayOrder::kAny) const override;
  bool moves() const override { return !movers_.empty(); }
  bool has_retroreflectors() const override { return still_.has_retroreflectors(); }
  const Material& material(std::uint32_t triangle) const override;

 private:
  struct Mover {
    MoverConfig config;
    ShapePtr shape;
    Material surface;
    Eigen::Vector3d center;  ///< of a ball around the shape, in its frame
    double radius;           ///< m
  };

  const World& still_;
  std::uint32_t still_triangles_;
  std::vector<Mover> movers_;
};

}  // namespace lidarena::world
