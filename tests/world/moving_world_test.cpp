// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/moving_world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "lidarena/world/primitives.hpp"
#include "lidarena/world/world.hpp"
#include "tests/world/shapes.hpp"

namespace lidarena::world {
namespace {

using Eigen::Vector3d;
using testing::random_direction;
using testing::random_point;

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

Pose random_pose(SequentialRandom& random, double half_size) {
  const Vector3d axis = random_direction(random);
  return make_pose(Eigen::Quaterniond(Eigen::AngleAxisd(random.uniform(-3.0, 3.0), axis)),
                   random_point(random, half_size));
}

/// A shape and a function for the distance from a point to its surface.
struct SlowShape {
  ShapePtr shape;
  std::function<double(const Vector3d&)> distance;  ///< to the surface, in the shape's frame
};

SlowShape slow_sphere(double radius) {
  return {make_sphere(radius), [=](const Vector3d& p) { return std::abs(p.norm() - radius); }};
}

SlowShape slow_cylinder(double radius, double length) {
  return {make_cylinder(radius, length), [=](const Vector3d& p) {
            const double aside = p.head<2>().norm() - radius;
            const double beyond = std::abs(p.z()) - 0.5 * length;
            if (aside <= 0.0 && beyond <= 0.0) return -std::max(aside, beyond);
            return std::hypot(std::max(aside, 0.0), std::max(beyond, 0.0));
          }};
}

SlowShape slow_plane() {
  return {make_plane(), [](const Vector3d& p) { return std::abs(p.z()); }};
}

SlowShape slow_mesh(TriangleMesh mesh) {
  clean_mesh(mesh, "test");
  return {make_mesh(mesh), [mesh](const Vector3d& p) {
            double nearest = kNoLimit;
            for (const auto& [a, b, c] : mesh.triangles) {
              const Vector3d q = closest_point_on_triangle(p, mesh.vertices[a], mesh.vertices[b],
                                                           mesh.vertices[c]);
              nearest = std::min(nearest, (q - p).norm());
            }
            return nearest;
          }};
}

struct SlowHit {
  double range = kNoLimit;
  std::uint32_t shape = Hit::kNone;
  bool is_sure = true;  ///< false when the ray grazes a surface, so that rounding decides
};

/// Sphere tracing: each step is as long as the distance to the nearest surface, so that no surface
/// is passed.
SlowHit march(const std::vector<SlowShape>& shapes, const std::vector<Pose>& poses, const Ray& ray,
              double max_range) {
  constexpr double kThere = 1e-9, kGrazing = 1e-4;
  SlowHit hit;
  double range = 0.0, before = kNoLimit;
  const Vector3d direction = ray.direction.cast<double>();
  for (int i = 0; i < 4000 && range <= max_range; ++i) {
    const Vector3d point = ray.origin + range * direction;
    double nearest = kNoLimit;
    std::uint32_t which = Hit::kNone;
    for (std::uint32_t k = 0; k < shapes.size(); ++k) {
      const double distance = shapes[k].distance(poses[k].inverse() * point);
      if (distance < nearest) {
        nearest = distance;
        which = k;
      }
    }
    if (nearest < kThere) return {range, which, hit.is_sure};
    if (nearest < kGrazing && nearest > 0.999 * before) hit.is_sure = false;
    before = nearest;
    range += nearest;
  }
  hit.is_sure = hit.is_sure && range > max_range;  // otherwise it stayed close to a surface
  return hit;
}

/// At least one shape of every kind, to be placed in a space of about 12 m.
std::vector<SlowShape> one_of_each() {
  return {slow_sphere(1.3),
          slow_cylinder(0.7, 2.5),
          slow_mesh(box_shape({1.0, 2.0, 3.0})),
          slow_mesh(testing::triangle_soup(20, 1.5, 3)),
          slow_plane(),
          slow_sphere(0.2),
          slow_mesh(testing::triangle_soup(12, 2.0, 4)),
          slow_cylinder(2.0, 0.1)};
}

TEST(MovingWorld, FindsWhatASlowWalkAlongTheRayFindsWhileShapesMove) {
  SequentialRandom random(5);
  const std::vector<SlowShape> shapes = one_of_each();
  std::vector<Pose> poses;
  std::vector<PlacedShape> placed;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    poses.push_back(random_pose(random, 5.0));
    placed.push_back({shapes[i].shape, poses.back(), {}, i % 2 == 1 || i == 2});
  }
  MovingWorld world(placed);
  int hits = 0, unsure = 0;
  for (int step = 0; step < 8; ++step) {
    std::vector<Pose> moved;
    for (std::size_t i = 0; i < placed.size(); ++i) {
      if (!placed[i].moves) continue;
      poses[i] = random_pose(random, 5.0);
      moved.push_back(poses[i]);
    }
    world.move(moved);
    for (int i = 0; i < 100; ++i) {
      const Ray ray{random_point(random, 6.0), random_direction(random).cast<float>()};
      Hit hit;
      world.cast({&ray, 1}, 30.0, {&hit, 1});
      const SlowHit slow = march(shapes, poses, ray, 30.0);
      if (!slow.is_sure) {
        ++unsure;
        continue;
      }
      ASSERT_EQ(hit.triangle, slow.shape) << step << " " << i;
      if (!hit.valid()) continue;
      ++hits;
      EXPECT_NEAR(hit.range, slow.range, 1e-5);
      EXPECT_LT(hit.normal.dot(ray.direction), 0.0F);
      EXPECT_NEAR(hit.normal.norm(), 1.0F, 1e-5F);
    }
  }
  EXPECT_GT(hits, 300);
  EXPECT_LT(unsure, 80);
}

TEST(MovingWorld, StillMeshesAreSeenAsTheSameMeshesInAWorldAre) {
  SequentialRandom random(6);
  std::vector<PlacedShape> placed;
  TriangleMesh all;
  for (std::uint64_t i = 0; i < 30; ++i) {
    TriangleMesh mesh = testing::triangle_soup(40, 2.0, 10 + i);
    clean_mesh(mesh, "test");
    placed.push_back({make_mesh(mesh), random_pose(random, 8.0), {}, false});
    all.append(mesh, placed.back().world_from_shape);
  }
  const MovingWorld moving(placed);
  const World world(all, "all", RayCaster::kBvh);
  std::vector<Ray> rays(2000);
  for (Ray& ray : rays) ray = {random_point(random, 10.0), random_direction(random).cast<float>()};
  std::vector<Hit> hits(rays.size()), expected(rays.size());
  moving.cast(rays, 20.0, hits);
  world.cast(rays, 20.0, expected);
  int found = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(hits[i].valid(), expected[i].valid());
    if (!hits[i].valid()) continue;
    ++found;
    // not bit-identical: a World is re-centered, and the directions were rotated
    EXPECT_FLOAT_EQ(hits[i].range, expected[i].range);
    EXPECT_EQ(hits[i].triangle, expected[i].triangle / 40);
  }
  EXPECT_GT(found, 300);
}

TEST(MovingWorld, MaterialsAreTheShapesOwn) {
  const Material wood = materials::kWood, metal = materials::kMetal;
  const Pose ahead = make_pose(Eigen::Quaterniond::Identity(), {5, 0, 0});
  const Pose behind = make_pose(Eigen::Quaterniond::Identity(), {-5, 0, 0});
  const MovingWorld world({{make_sphere(1.0), ahead, wood, false},
                           {make_mesh(box_shape({1, 1, 1})), behind, metal, false}});
  const std::vector<Ray> rays{{Vector3d::Zero(), Eigen::Vector3f::UnitX()},
                              {Vector3d::Zero(), -Eigen::Vector3f::UnitX()}};
  std::vector<Hit> hits(2);
  world.cast(rays, 100.0, hits);
  EXPECT_FLOAT_EQ(hits[0].range, 4.0F);
  EXPECT_FLOAT_EQ(hits[1].range, 4.5F);
  EXPECT_EQ(world.material(hits[0].triangle), wood);
  EXPECT_EQ(world.material(hits[1].triangle), metal);
}

TEST(MovingWorld, WithoutShapesNothingIsHit) {
  MovingWorld world({});
  world.move({});
  const Ray ray{Vector3d::Zero(), Eigen::Vector3f::UnitX()};
  Hit hit;
  world.cast({&ray, 1}, 100.0, {&hit, 1});
  EXPECT_FALSE(hit.valid());
}

TEST(Shape, FromWithinAndFarAwayRangesAreExact) {
  const auto range = [](const ShapePtr& shape, const Vector3d& origin, const Vector3d& direction) {
    Shape::Intersection intersection;
    return shape->intersect({origin, direction.cast<float>()}, 1e9, intersection)
               ? intersection.range
               : -1.0;
  };
  EXPECT_DOUBLE_EQ(range(make_sphere(2.0), {0.5, 0, 0}, {1, 0, 0}), 1.5);
  EXPECT_DOUBLE_EQ(range(make_sphere(2.0), {3, 0, 0}, {1, 0, 0}), -1.0);
  EXPECT_DOUBLE_EQ(range(make_sphere(0.5), {-1e6, 0, 0}, {1, 0, 0}), 1e6 - 0.5);
  EXPECT_DOUBLE_EQ(range(make_cylinder(1.0, 4.0), {0, 0, 0.5}, {0, 0, -1}), 2.5);
  EXPECT_DOUBLE_EQ(range(make_cylinder(1.0, 4.0), {0, 0, 5.0}, {0, 0, -1}), 3.0);
  EXPECT_DOUBLE_EQ(range(make_cylinder(1.0, 4.0), {0.25, 0, 0}, {1, 0, 0}), 0.75);
  EXPECT_DOUBLE_EQ(range(make_cylinder(1.0, 4.0), {-1e6, 0, 2.5}, {1, 0, 0}), -1.0);
  EXPECT_DOUBLE_EQ(range(make_plane(), {1e6, 3, 7}, {0, 0, -1}), 7.0);
  EXPECT_DOUBLE_EQ(range(make_plane(), {0, 0, 7}, {1, 0, 0}), -1.0);
}

}  // namespace
}  // namespace lidarena::world
