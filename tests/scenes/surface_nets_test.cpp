// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/surface_nets.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "lidarena/base/random.hpp"
#include "tests/world/mesh_topology.hpp"
#include "tests/world/shapes.hpp"

namespace lidarena::scenes {
namespace {

using world::testing::Topology;
using world::testing::topology;

/// Samples `value` in the blocks -blocks ... blocks - 1 along each axis.
SparseField sample(int blocks, double step,
                   const std::function<double(const Eigen::Vector3i&)>& value) {
  SparseField field(step);
  Eigen::Vector3i b;
  for (b.z() = -blocks; b.z() < blocks; ++b.z()) {
    for (b.y() = -blocks; b.y() < blocks; ++b.y()) {
      for (b.x() = -blocks; b.x() < blocks; ++b.x()) {
        SparseField::Values& values = field.add_block(b);
        Eigen::Vector3i p;
        for (p.z() = 0; p.z() < SparseField::kBlock; ++p.z()) {
          for (p.y() = 0; p.y() < SparseField::kBlock; ++p.y()) {
            for (p.x() = 0; p.x() < SparseField::kBlock; ++p.x()) {
              values[SparseField::index_in_block(p)] =
                  static_cast<float>(value(SparseField::kBlock * b + p));
            }
          }
        }
      }
    }
  }
  return field;
}

TEST(SurfaceNets, NetOfABallIsAClosedSphereOfItsRadius) {
  constexpr double kStep = 0.1;
  constexpr double kRadius = 1.03;
  SparseField field = sample(2, kStep, [&](const Eigen::Vector3i& p) {
    return (kStep * p.cast<double>()).norm() - kRadius;
  });
  EXPECT_EQ(make_well_composed(field), 0U);
  const world::TriangleMesh mesh = surface_net(field);
  const Topology found = topology(mesh);
  EXPECT_EQ(found.open_edges, 0U);
  EXPECT_EQ(found.pinched_vertices, 0U);
  EXPECT_EQ(found.components, 1U);
  EXPECT_EQ(found.euler, 2);
  // Crossings lie on chords no longer than a cell's diagonal d: the sagitta is d^2 / (8 r), and
  // their mean lies farther inside by at most the same amount.
  const double sagitta = 3 * kStep * kStep / (8 * kRadius);
  for (const Eigen::Vector3d& v : mesh.vertices) EXPECT_NEAR(v.norm(), kRadius, 2 * sagitta);
}

TEST(SurfaceNets, NormalsPointIntoFreeSpace) {
  const SparseField field =
      sample(1, 0.2, [](const Eigen::Vector3i& p) { return (0.2 * p.cast<double>()).norm() - 1; });
  // Free space is the inside of the ball, so the signed volume is negative. With cells of 0.2 m the
  // error of the volume is less than that of a shell of half a cell.
  EXPECT_NEAR(world::testing::signed_volume(surface_net(field)), -4.19, 4.19 * 0.3 * 0.2);
}

TEST(SurfaceNets, WellComposedNoiseGivesAManifold) {
  const CounterRandom random(7);
  SparseField field = sample(2, 1.0, [&](const Eigen::Vector3i& p) {
    // White noise, half free and half rock, enclosed by rock: every critical pattern occurs.
    if (p.minCoeff() < -13 || p.maxCoeff() > 12) return 1.0;
    return random.uniform(SparseField::key(p)) - 0.5;
  });
  EXPECT_GT(topology(surface_net(field)).open_edges, 1000U);
  EXPECT_GT(make_well_composed(field), 1000U);
  EXPECT_EQ(make_well_composed(field), 0U);
  const Topology found = topology(surface_net(field));
  EXPECT_EQ(found.open_edges, 0U);
  EXPECT_EQ(found.pinched_vertices, 0U);
}

}  // namespace
}  // namespace lidarena::scenes
