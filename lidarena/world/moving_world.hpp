// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/world/box_tree.hpp"
#include "lidarena/world/shape.hpp"

namespace lidarena {

/// A shape somewhere in the world.
struct PlacedShape {
  ShapePtr shape;
  Pose world_from_shape = Pose::Identity();
  Material surface = materials::kDefault;
  bool moves = false;
};

/// A world of shapes some of which move from one physics step to the next: a tree over shapes, each
/// mesh with a tree of its own that moves with it. Meshes that stand still become one mesh.
/// A hit's `triangle` is the number of the shape. Needs Eigen alone.
class MovingWorld : public Surfaces {
 public:
  explicit MovingWorld(std::vector<PlacedShape> shapes);

  /// Puts the shapes that move, in the order in which they were given, where they are now.
  void move(std::span<const Pose> world_from_shapes);

  void cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
            RayOrder order = RayOrder::kAny) const override;
  const Material& material(std::uint32_t shape) const override;

  std::size_t size() const { return materials_.size(); }

 private:
  /// What the tree is over.
  struct Body {
    ShapePtr shape;
    Pose world_from_shape, shape_from_world;
    std::vector<std::uint32_t> numbers;  ///< of the shape that each triangle is of; or one for all
    std::uint32_t number_of(std::uint32_t triangle) const {
      return numbers[numbers.size() == 1 ? 0 : triangle];
    }
  };

  void add(ShapePtr shape, const Pose& pose, std::vector<std::uint32_t> numbers);
  Hit first_hit(const Ray& ray, double max_range) const;

  std::vector<Material> materials_;  ///< of the shapes
  std::vector<Body> bodies_;
  std::vector<std::size_t> moving_;  ///< bodies
  std::vector<Eigen::AlignedBox3f> boxes_;
  std::unique_ptr<BoxTree> tree_;  ///< none when there is no body
};

}  // namespace lidarena
