// SPDX-License-Identifier: BSD-3-Clause
// Properties of Bvh in addition to those of every ray caster, which world_test.cpp tests.
#include "lidarena/world/bvh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "lidarena/base/random.hpp"
#include "lidarena/world/primitives.hpp"
#include "tests/world/every_ray_caster.hpp"
#include "tests/world/shapes.hpp"

namespace lidarena::world {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Hit cast_one(const Bvh& bvh, const Ray& ray, double max_range = kInfinity) {
  Hit hit;
  bvh.cast({&ray, 1}, max_range, {&hit, 1}, RayOrder::kAny);
  return hit;
}

struct BruteHit {
  double range = kInfinity, next = kInfinity;  ///< ranges of the first two triangles hit
  std::uint32_t triangle = Hit::kNone;
};

/// Range of the hit of one triangle by Cramer's rule for origin + t d = a + u (b - a) + v (c - a),
/// where u, v and 1 - u - v are not negative (Moeller and Trumbore, 1997), in double precision.
std::optional<double> meet(const TriangleMesh& mesh, std::uint32_t triangle, const Ray& ray) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const Vector3d ab = mesh.vertices[b] - mesh.vertices[a];
  const Vector3d ac = mesh.vertices[c] - mesh.vertices[a];
  const Vector3d from_a = ray.origin - mesh.vertices[a];
  const Vector3d direction = ray.direction.cast<double>();
  const double whole = ab.dot(direction.cross(ac));
  const double u = from_a.dot(direction.cross(ac)) / whole;
  const double v = direction.dot(from_a.cross(ab)) / whole;
  const double range = ac.dot(from_a.cross(ab)) / whole;
  if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 && range >= 0.0)) return {};
  return range;
}

/// Not inlined: when it is, the ranges have errors of 1e-7 with GCC 12 at -O2 and above, but not
/// with -fno-tree-slp-vectorize.
[[gnu::noinline]] BruteHit cast_brute(const TriangleMesh& mesh, const Ray& ray) {
  BruteHit hit;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::optional<double> range = meet(mesh, t, ray);
    if (!range) continue;
    if (*range < hit.range) {
      hit.next = hit.range;
      hit.range = *range;
      hit.triangle = t;
    } else {
      hit.next = std::min(hit.next, *range);
    }
  }
  return hit;
}

class RayCasters : public testing::EveryRayCaster {};
INSTANTIATE_TEST_SUITE_P(With, RayCasters, testing::every_ray_caster(), testing::ray_caster_name);

TEST_P(RayCasters, FindTheTriangleThatABruteForceCasterFindsInASoup) {
  // Embree rounds coordinates to single precision; the error of the range grows with the incidence
  // angle. Bvh rounds only the final range.
  const TriangleMesh soup = testing::triangle_soup(2000, 5.0, 61);
  const World world = make_world(soup);
  SequentialRandom random(62);
  constexpr int kRays = 3000;
  int others = 0, hits = 0;
  for (int i = 0; i < kRays; ++i) {
    const Vector3d origin = testing::random_point(random, i % 10 == 0 ? 50.0 : 6.0);
    const Vector3d target = testing::random_point(random, 5.0);
    const Ray ray{origin, (target - origin).normalized().cast<float>()};
    const BruteHit expected = cast_brute(soup, ray);
    Hit hit;
    world.cast({&ray, 1}, kInfinity, {&hit, 1});
    hits += hit.valid() ? 1 : 0;
    if (hit.triangle != expected.triangle) {
      const bool is_tie = expected.next - expected.range < 1e-5 * expected.range;
      others += is_tie ? 0 : 1;
    } else if (hit.valid()) {
      const double reach = std::max(6.0, origin.lpNorm<Eigen::Infinity>()) + expected.range;
      const double cosine = std::abs(hit.normal.dot(ray.direction));
      const double tolerance =
          GetParam() == RayCaster::kBvh ? 1e-7 * expected.range : 1e-6 * reach / cosine;
      EXPECT_NEAR(hit.range, expected.range, tolerance) << "ray " << i;
    }
  }
  EXPECT_GT(hits, kRays / 2);
  EXPECT_LE(others, GetParam() == RayCaster::kBvh ? 0 : 2);
}

TEST(Bvh, HasDoublePrecisionFarOut) {
  // Two floors half a millimeter apart, seen from 1 km: the resolution of a float is 0.06 mm there,
  // and half a meter at 5000 km from the origin.
  const Vector3d far(5.0e6, 5.4e6, 300.0);
  TriangleMesh floors;
  for (const double z : {0.0, 5e-4}) {
    const auto first = static_cast<std::uint32_t>(floors.vertices.size());
    for (const Vector3d& v : {Vector3d(-9, -9, z), Vector3d(9, -9, z), Vector3d(0, 9, z)}) {
      floors.vertices.push_back(far + v);
    }
    floors.triangles.push_back({first, first + 1, first + 2});
  }
  const Bvh bvh(floors);
  const Hit above = cast_one(bvh, {far + Vector3d(0, 0, 1000.0), {0, 0, -1}});
  const Hit below = cast_one(bvh, {far - Vector3d(0, 0, 1000.0), {0, 0, 1}});
  EXPECT_EQ(above.triangle, 1U);
  EXPECT_EQ(below.triangle, 0U);
  EXPECT_FLOAT_EQ(above.range, 999.9995F);
}

TEST(Bvh, OfTrianglesMetAtOneRangeTheLowerIndexIsTheHit) {
  TriangleMesh mesh = testing::box_mesh({-1, -1, -1}, {1, 1, 1});
  const TriangleMesh once = mesh;
  for (int copy = 0; copy < 40; ++copy) mesh.append(once);  // more than a leaf can hold
  const Bvh bvh(mesh);
  SequentialRandom random(63);
  for (int i = 0; i < 500; ++i) {
    const Hit hit =
        cast_one(bvh, {Vector3d::Zero(), testing::random_direction(random).cast<float>()});
    ASSERT_TRUE(hit.valid());
    EXPECT_LT(hit.triangle, once.triangles.size());
  }
  // through the diagonal of a wall, which both its triangles share
  EXPECT_EQ(cast_one(bvh, {Vector3d::Zero(), {0, 0, 1}}).triangle, 10U);
}

TEST(Bvh, NoRaySlipsThroughWhatItMeetsToTheLastBit) {
  // The origin is computed back from corners and edges along the ray, so that only rounding decides
  // on which side of them the ray passes.
  const TriangleMesh sphere = sphere_shape(2.0);
  const Bvh bvh(sphere);
  SequentialRandom random(64);
  for (const auto& [ia, ib, ic] : sphere.triangles) {
    const Vector3d &a = sphere.vertices[ia], &b = sphere.vertices[ib];
    for (const Vector3d& target : {a, b, Vector3d(0.5 * (a + b)), Vector3d(0.25 * a + 0.75 * b)}) {
      const Vector3d inside = testing::random_point(random, 1.0);
      const Eigen::Vector3f direction = (target - inside).normalized().cast<float>();
      const Ray ray{target - direction.cast<double>(), direction};
      const Hit hit = cast_one(bvh, ray);
      ASSERT_TRUE(hit.valid());
      EXPECT_FLOAT_EQ(hit.range, 1.0F);
    }
  }
}

TEST(Bvh, ARayAlongBoxesSidesAndEdgesIsNotLost) {
  const TriangleMesh box = testing::box_mesh({-1, -1, -1}, {1, 1, 1});
  const Bvh bvh(box);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      for (const double other : {-1.0, 0.3, 1.0}) {
        // in the plane of a wall, or along an edge: the hit is at the first point of the box
        Vector3d origin = Vector3d::Constant(side);
        origin[(axis + 1) % 3] = other;
        origin[axis] = -5.0;
        const Hit hit = cast_one(bvh, {origin, Vector3d::Unit(axis).cast<float>()});
        ASSERT_TRUE(hit.valid()) << origin.transpose();
        EXPECT_EQ(hit.range, 4.0F);
      }
    }
  }
}

TEST(Bvh, RaysThatAreNoneHitNothing) {
  const Bvh bvh(testing::box_mesh({-1, -1, -1}, {1, 1, 1}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(cast_one(bvh, {{nan, 0, 0}, {1, 0, 0}}).valid());
  EXPECT_FALSE(cast_one(bvh, {{kInfinity, 0, 0}, {-1, 0, 0}}).valid());
  EXPECT_FALSE(cast_one(bvh, {{0, 0, 0}, {static_cast<float>(nan), 0, 0}}).valid());
  EXPECT_FALSE(cast_one(bvh, {{0, 0, 0}, {0, 0, 0}}).valid());
}

TEST(Bvh, StaysShallowWhereTheCheapestCutsPeelOffOneTriangleAtATime) {
  // Sizes and positions are halved from one triangle to the next, and many have the same position.
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const double size = std::ldexp(1.0, -static_cast<int>(std::min(i, 100U)));
    const Vector3d corner(size, size, size);
    for (int axis = 0; axis < 3; ++axis) {
      mesh.vertices.push_back(corner + 0.1 * size * Vector3d::Unit(axis));
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const Bvh bvh(mesh);
  for (std::uint32_t i = 0; i < 100; ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    const Vector3d middle = (mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3.0;
    const Vector3d aside =
        middle + Vector3d(1, -1, 0).normalized() * 0.01 * std::ldexp(1.0, -int(i));
    const Hit hit = cast_one(bvh, {aside + Vector3d(0, 0, 5.0), {0, 0, -1}});
    EXPECT_TRUE(hit.valid()) << i;
  }
}

}  // namespace
}  // namespace lidarena::world
