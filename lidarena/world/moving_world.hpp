// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/world/box_tree.hpp"
#include "lidarena/world/shape.hpp"

namespace lidarena::world {

/// A shape with its pose and material in the world.
struct PlacedShape {
  ShapePtr shape;
  Pose world_from_shape = Pose::Identity();
  Material surface = materials::kDefault;
  bool moves = false;
};

/// A world of shapes, some of which move between physics steps. It consists of a tree over the
/// shapes; each mesh has its own tree in its own frame. Static meshes are merged into one mesh.
/// A hit's `triangle` is the index of the shape. Depends on Eigen only.
class MovingWorld : public Surfaces {
 public:
  explicit MovingWorld(std::vector<PlacedShape> shapes);

  /// Sets the poses of the moving shapes, in the order in which they were given to the constructor.
  void move(std::span<const Pose> world_from_shapes);

  void cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
            RayOrder order = RayOrder::kAny) const override;
  const Material& material(std::uint32_t shape) const override;

  std::size_t size() const { return materials_.size(); }

 private:
  /// A member of the tree: a moving shape, a static shape, or the merged static meshes.
  struct Body {
    ShapePtr shape;
    Pose world_from_shape, shape_from_world;
    std::vector<std::uint32_t> numbers;  ///< index of each triangle's shape, or one for all
    std::uint32_t number_of(std::uint32_t triangle) const {
      return numbers[numbers.size() == 1 ? 0 : triangle];
    }
  };

  void add(ShapePtr shape, const Pose& pose, std::vector<std::uint32_t> numbers);
  Hit first_hit(const Ray& ray, double max_range) const;

  std::vector<Material> materials_;  ///< of each shape
  std::vector<Body> bodies_;
  std::vector<std::size_t> moving_;  ///< indices of the moving bodies
  std::vector<Eigen::AlignedBox3f> boxes_;
  std::unique_ptr<BoxTree> tree_;  ///< null when there is no body
};

}  // namespace lidarena::world
