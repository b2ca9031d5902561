// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/trees.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lidarena/scenes/gradient_noise.hpp"
#include "lidarena/scenes/mesh_builder.hpp"

namespace lidarena::scenes {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kCrownBase = 4.0;    // m above the foot
constexpr double kInGround = 0.4;     // m, by which trunks and stones reach below the ground
constexpr double kKnots = 0.15;       // relative amplitude of a trunk's surface
constexpr double kGoldenAngle = 2.4;  // rad, from branch to branch
constexpr int kLeavesPerBranch = 28;

Vector3d random_unit(SequentialRandom& random) {
  const double z = random.uniform(-1.0, 1.0), angle = random.uniform(0.0, 2.0 * pi);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

/// A triangle of about `size` in a random direction.
void add_leaf(const Vector3d& at, double size, SequentialRandom& random,
              world::TriangleMesh& leaves) {
  const Vector3d along = random_unit(random);
  const Vector3d across = along.cross(random_unit(random)).normalized();
  const auto first = static_cast<std::uint32_t>(leaves.vertices.size());
  leaves.vertices.emplace_back(at + size * along);
  leaves.vertices.emplace_back(at - 0.4 * size * across);
  leaves.vertices.emplace_back(at + 0.4 * size * across);
  leaves.triangles.push_back({first, first + 1, first + 2});
}

/// Center line of a trunk, relative to its foot, at height z.
struct Bend {
  explicit Bend(SequentialRandom& random)
      : lean(random.uniform(0.0, 0.05)),
        to(random.uniform(0.0, 2.0 * pi)),
        sway(random.uniform(0.0, 0.15)),
        phase(random.uniform(0.0, 2.0 * pi)) {}
  Vector3d at(double z) const {
    const double off = lean * z + sway * (std::sin(0.5 * z + phase) - std::sin(phase));
    return {off * std::cos(to), off * std::sin(to), z};
  }
  double lean, to, sway, phase;
};

world::TriangleMesh trunk(double radius, double height, const Bend& bend, std::uint64_t seed) {
  const GradientNoise knots(seed);
  std::vector<Eigen::Vector2d> profile{
      {0.0, -kInGround}, {1.5 * radius, -kInGround}, {1.25 * radius, 0.2}};
  for (double z = 0.7; z < height - 0.5; z += 0.7)
    profile.emplace_back(radius * (1.0 - 0.9 * z / height), z);
  profile.emplace_back(0.0, height);
  world::TriangleMesh mesh = shape::lathe(profile, 9);
  for (Vector3d& p : mesh.vertices) {
    const double bump = 1.0 + kKnots * knots({4.0 * p.x() / radius, 4.0 * p.y() / radius, p.z()});
    const Vector3d middle = bend.at(p.z());
    p = {middle.x() + bump * p.x(), middle.y() + bump * p.y(), p.z()};
  }
  return mesh;
}

}  // namespace

void add_tree(const Vector3d& foot, double radius, bool is_conifer, SequentialRandom& random,
              Plants& plants) {
  const double height = 7.0 + 45.0 * radius + random.uniform(-1.0, 1.0);
  const Bend bend(random);
  const auto seed = static_cast<std::uint64_t>(random.integer(0, 1 << 30));
  plants.wood.append(shape::translated(trunk(radius, height, bend, seed), foot));
  const int branches = random.integer(9, 14);
  double turn = random.uniform(0.0, 2.0 * pi);
  for (int i = 0; i < branches; ++i, turn += kGoldenAngle) {
    const double share = (i + random.uniform()) / branches;
    const double z = kCrownBase + share * (0.95 * height - kCrownBase);
    const double reach =
        (is_conifer ? 1.0 - 0.85 * share : 2.0 * std::sqrt(share * (1.05 - share))) *
        (1.0 + 6.0 * radius);
    const Vector3d out(std::cos(turn), std::sin(turn), is_conifer ? -0.15 : 0.5);
    const Vector3d begin = foot + bend.at(z), end = begin + reach * out;
    const Vector3d middle = 0.5 * (begin + end) + 0.1 * reach * Vector3d::UnitZ();
    plants.wood.append(shape::bar({begin, middle, end}, 0.01 + 0.08 * radius, 5));
    for (int leaf = 0; leaf < kLeavesPerBranch; ++leaf) {
      const double s = random.uniform(0.25, 1.05);
      Vector3d at =
          begin + s * (end - begin) + 0.25 * reach * random.uniform() * random_unit(random);
      at.z() = std::max(at.z(), foot.z() + kCrownBase - 0.6);
      add_leaf(at, random.uniform(0.1, 0.3), random, plants.leaves);
    }
  }
}

void add_bush(const Vector3d& foot, double radius, SequentialRandom& random, Plants& plants) {
  for (int i = 0; i < 160; ++i) {
    const Vector3d at = radius * std::cbrt(random.uniform()) * random_unit(random);
    add_leaf(foot + Vector3d(at.x(), at.y(), std::abs(at.z())), random.uniform(0.05, 0.15), random,
             plants.leaves);
  }
}

void add_log(const Vector3d& a, const Vector3d& b, double radius, Plants& plants) {
  const Vector3d middle = 0.5 * (a + b) + 0.03 * Vector3d::UnitZ();
  plants.wood.append(shape::bar({a, middle, b}, radius, 10));
}

world::TriangleMesh boulder(const Vector3d& center, double radius, std::uint64_t seed) {
  const GradientNoise knobs(seed);
  world::TriangleMesh mesh = shape::ball(radius, 16);
  for (Vector3d& p : mesh.vertices) {
    p *= 1.0 + 0.4 * knobs(1.5 / radius * p);
    p.z() *= 0.7;
  }
  return shape::translated(mesh, center);
}

}  // namespace lidarena::scenes
