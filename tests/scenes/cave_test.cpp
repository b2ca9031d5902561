// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/cave.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <complex>
#include <numbers>
#include <numeric>
#include <unordered_map>

#include "lidarena/scenes/cave_field.hpp"
#include "lidarena/scenes/cave_graph.hpp"
#include "lidarena/world/world.hpp"
#include "tests/world/mesh_topology.hpp"
#include "tests/world/shapes.hpp"

namespace lidarena::scenes {
namespace {

/// One loop of about 40 m with coarse triangles: generated in a fraction of a second.
CaveConfig small_cave() {
  CaveConfig config;
  config.loops = 1;
  config.cell_length_m = 11;
  config.cell_width_m = 9;
  config.winding_m = 0.5;
  config.relief_m = 0.5;
  config.voxel_size_m = 0.2;
  return config;
}

double route_length(const std::vector<Eigen::Vector3d>& route) {
  double sum = 0;
  for (std::size_t i = 1; i < route.size(); ++i) sum += (route[i] - route[i - 1]).norm();
  return sum;
}

TEST(Cave, SameSeedGivesTheSameCaveAndAnotherSeedAnother) {
  const world::WorldModel a = make_cave(small_cave(), 5);
  const world::WorldModel b = make_cave(small_cave(), 5);
  const world::WorldModel c = make_cave(small_cave(), 6);
  EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  EXPECT_EQ(a.routes, b.routes);
  EXPECT_NE(a.mesh.vertices, c.mesh.vertices);
}

TEST(Cave, TunnelsAreLongAndTheirLoopsOfMiddlingLength) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const CaveGraph graph = make_cave_graph(CaveConfig{}, seed);
    double total = 0;
    for (const Tunnel& tunnel : graph.tunnels) total += tunnel.length();
    EXPECT_GE(total, 300);
    EXPECT_GE(graph.loops.size(), 3U);
    for (const auto& loop : graph.loops) {
      double length = 0;
      for (const std::size_t t : loop) length += graph.tunnels[t].length();
      EXPECT_GE(length, 60);
      EXPECT_LE(length, 150);
    }
  }
}

TEST(Cave, TunnelsMeetAtJunctionsAlone) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const CaveGraph graph = make_cave_graph(CaveConfig{}, seed);
    for (std::size_t i = 0; i < graph.tunnels.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const Tunnel& a = graph.tunnels[i];
        const Tunnel& b = graph.tunnels[j];
        if (a.from == b.from || a.from == b.to || a.to == b.from || a.to == b.to) continue;
        for (const Eigen::Vector3d& p : a.points) {
          // Two maximum radii, roughness, and rock in between.
          for (const Eigen::Vector3d& q : b.points) ASSERT_GT((p - q).norm(), 5.0) << seed;
        }
      }
    }
  }
}

TEST(Cave, IsOneClosedManifoldWithAHandleForEachLoop) {
  const CaveConfig config;
  const world::WorldModel cave = make_cave(config, 1);
  EXPECT_GE(cave.mesh.triangles.size(), 500000U);
  const world::testing::Topology found = world::testing::topology(cave.mesh);
  EXPECT_EQ(found.open_edges, 0U);
  EXPECT_EQ(found.pinched_vertices, 0U);
  EXPECT_EQ(found.components, 1U);
  EXPECT_EQ(found.euler, 2 - 2 * config.loops);
}

TEST(Cave, EnclosesTheVolumeOfItsTunnelsWithNormalsInward) {
  const world::WorldModel cave = make_cave(small_cave(), 2);
  const CaveGraph graph = make_cave_graph(small_cave(), 2);
  double tubes = 0;
  for (const Tunnel& tunnel : graph.tunnels) {
    for (std::size_t i = 1; i < tunnel.points.size(); ++i) {
      tubes += std::numbers::pi * tunnel.radii[i] * tunnel.radii[i] *
               (tunnel.points[i] - tunnel.points[i - 1]).norm();
    }
  }
  // Noise of 2 m scale and the junctions' overlaps change the volume by less than a fifth.
  EXPECT_NEAR(world::testing::signed_volume(cave.mesh), -tubes, 0.2 * tubes);
}

TEST(Cave, TrianglesAreAboutAsLargeAsTheGrid) {
  const world::WorldModel cave = make_cave(small_cave(), 3);
  const double step = small_cave().voxel_size_m;
  for (const world::Triangle& t : cave.mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      // Vertices of neighboring cells are less than two steps apart along each axis; the projection
      // moves each vertex by at most one step.
      EXPECT_LT((cave.mesh.vertices[t[k]] - cave.mesh.vertices[t[(k + 1) % 3]]).norm(), 4 * step);
    }
  }
  const double mean_area = cave.mesh.area() / static_cast<double>(cave.mesh.triangles.size());
  EXPECT_GT(mean_area, 0.2 * step * step);
  EXPECT_LT(mean_area, 0.6 * step * step);
}

TEST(Cave, RouteFliesEveryTunnelClosedAndClearOfTheRock) {
  const world::WorldModel cave = make_cave(CaveConfig{}, 1);
  const CaveGraph graph = make_cave_graph(CaveConfig{}, 1);
  ASSERT_EQ(cave.routes.size(), 1U);
  const std::vector<Eigen::Vector3d>& route = cave.routes[0];
  EXPECT_EQ(route.front(), route.back());
  double tunnels = 0;
  for (const Tunnel& tunnel : graph.tunnels) {
    tunnels += tunnel.length();
    for (const Eigen::Vector3d& p : tunnel.points) {
      double nearest = 1e9;
      for (const Eigen::Vector3d& q : route) nearest = std::min(nearest, (p - q).norm());
      EXPECT_LT(nearest, 1.1);  // route points are at most 2 m apart
    }
  }
  EXPECT_GT(route_length(route), 0.97 * tunnels);
  const world::World world(cave.mesh, "cave");
  for (std::size_t i = 1; i < route.size(); ++i) {
    const double length = (route[i] - route[i - 1]).norm();
    EXPECT_GE(length, 0.7);
    EXPECT_LE(length, 2.0);
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector3d p = route[i - 1] + 0.25 * k * (route[i] - route[i - 1]);
      EXPECT_GE(world.closest_point(p).distance, 0.6) << p.transpose();
    }
  }
}

TEST(Cave, EveryRayFromTheRouteHitsRock) {
  const world::WorldModel cave = make_cave(small_cave(), 4);
  const world::World world(cave.mesh, "cave");
  SequentialRandom random(1);
  std::vector<world::Ray> rays;
  for (const Eigen::Vector3d& p : cave.routes[0]) {
    for (int k = 0; k < 2000; ++k)
      rays.push_back({p, world::testing::random_direction(random).cast<float>()});
  }
  std::vector<world::Hit> hits(rays.size());
  world.cast(rays, 1000, hits);
  for (const world::Hit& hit : hits) EXPECT_TRUE(hit.valid());
}

TEST(Cave, TunnelsAreTwoToFourMetersWide) {
  const world::WorldModel cave = make_cave(CaveConfig{}, 1);
  const CaveGraph graph = make_cave_graph(CaveConfig{}, 1);
  const world::World world(cave.mesh, "cave");
  for (const Tunnel& tunnel : graph.tunnels) {
    for (std::size_t i = 10; i + 10 < tunnel.points.size(); ++i) {  // 5 m from the junctions
      const Eigen::Vector3d along = tunnel.points[i + 1] - tunnel.points[i - 1];
      const Eigen::Vector3f side = along.cross(Eigen::Vector3d::UnitZ()).normalized().cast<float>();
      const std::array<world::Ray, 2> rays{world::Ray{tunnel.points[i], side},
                                           world::Ray{tunnel.points[i], -side}};
      std::array<world::Hit, 2> hits;
      world.cast(rays, 100, hits);
      const float width = hits[0].range + hits[1].range;
      EXPECT_GE(width, 2.0F);
      EXPECT_LE(width, 4.0F);
    }
  }
}

/// Minimum over all vertices of the maximum deviation (m) of the vertices within `radius` from
/// their best-fit plane: the relief of the flattest patch of that size.
double flattest_place(const world::TriangleMesh& mesh, double radius) {
  std::unordered_map<std::uint64_t, std::vector<Eigen::Vector3d>> cells;
  const auto cell = [&](const Eigen::Vector3d& p) -> Eigen::Vector3i {
    return (p / radius).array().floor().cast<int>();
  };
  for (const Eigen::Vector3d& v : mesh.vertices) cells[SparseField::key(cell(v))].push_back(v);
  double flattest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& center : mesh.vertices) {
    std::vector<Eigen::Vector3d> near;
    for (int i = 0; i < 27; ++i) {
      const Eigen::Vector3i offset(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      const auto found = cells.find(SparseField::key(cell(center) + offset));
      if (found == cells.end()) continue;
      for (const Eigen::Vector3d& p : found->second) {
        if ((p - center).norm() <= radius) near.push_back(p);
      }
    }
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : near) mean += p / double(near.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& p : near) scatter += (p - mean) * (p - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter);
    double deviation = 0;
    for (const Eigen::Vector3d& p : near) {
      deviation = std::max(deviation, std::abs((p - mean).dot(axes.eigenvectors().col(0))));
    }
    flattest = std::min(flattest, deviation);
  }
  return flattest;
}

/// A fraction of the sensors' range noise (2 to 3 cm).
constexpr double kFlat = 0.003;  // m

TEST(Cave, HasNoFlatFaceHalfAMeterAcross) {
  CaveConfig config = small_cave();
  config.voxel_size_m = CaveConfig{}.voxel_size_m;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    EXPECT_GT(flattest_place(make_cave(config, seed).mesh, 0.25), kFlat);
  }
}

TEST(Cave, WithoutRoughnessItsTunnelsWouldBeFlatAtThatScale) {
  CaveConfig config = small_cave();
  config.voxel_size_m = CaveConfig{}.voxel_size_m;
  config.roughness_2m_m = config.roughness_03m_m = config.roughness_005m_m = 0;
  EXPECT_LT(flattest_place(make_cave(config, 1).mesh, 0.25), kFlat);
}

/// Power of `profile` (one sample per `spacing` meters, Hann window, mean removed) at wavelengths
/// from `low` to `high` meters; the sum over all wavelengths is the variance.
double band_power(const std::vector<double>& profile, double spacing, double low, double high) {
  const auto n = profile.size();
  const double mean = std::accumulate(profile.begin(), profile.end(), 0.0) / double(n);
  double power = 0;
  for (std::size_t k = 1; k <= n / 2; ++k) {
    const double wavelength = double(n) * spacing / double(k);
    if (wavelength < low || wavelength >= high) continue;
    std::complex<double> sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double turn = 2 * std::numbers::pi * double(i) / double(n);
      sum += (1 - std::cos(turn)) * (profile[i] - mean) * std::polar(1.0, -turn * double(k));
    }
    power += 2 * std::norm(sum) / double(n * n) / 1.5;  // 1.5 is the window's mean square
  }
  return power;
}

/// A straight tunnel of 1.5 m radius along x.
CaveGraph straight_tunnel(double length) {
  const Eigen::Vector3d end = length * Eigen::Vector3d::UnitX();
  CaveGraph graph;
  graph.junctions = {Eigen::Vector3d::Zero(), end};
  graph.tunnels = {{0, 1, {Eigen::Vector3d::Zero(), end}, {1.5, 1.5}}};
  return graph;
}

/// Distance from the tunnel's axis to its wall at x, in direction `angle` about the axis: the zero
/// crossing of the field, by bisection.
double wall_distance(const CaveField& rock, double x, double angle) {
  double inside = 0.8;
  double outside = 2.2;
  while (outside - inside > 1e-5) {
    const double r = 0.5 * (inside + outside);
    const bool free = rock({x, r * std::cos(angle), r * std::sin(angle)}) < 0;
    (free ? inside : outside) = r;
  }
  return inside;
}

/// Mean power of the wall's profiles along the tunnel at wavelengths near `scale` meters.
double power_at_scale(const CaveConfig& config, double scale) {
  constexpr int kSamples = 200;
  constexpr int kLines = 12;
  const double spacing = 0.2 * scale;
  const CaveField rock(straight_tunnel(kSamples * spacing), config, 1);
  double power = 0;
  for (int line = 0; line < kLines; ++line) {
    std::vector<double> profile;
    for (int i = 0; i < kSamples; ++i) {
      profile.push_back(wall_distance(rock, i * spacing, line * 2 * std::numbers::pi / kLines));
    }
    power += band_power(profile, spacing, 0.6 * scale, 4 * scale) / kLines;
  }
  return power;
}

TEST(Cave, WallsAreRoughAtAllThreeScales) {
  for (const auto& [scale, height] :
       {std::pair{2.0, &CaveConfig::roughness_2m_m}, std::pair{0.3, &CaveConfig::roughness_03m_m},
        std::pair{0.05, &CaveConfig::roughness_005m_m}}) {
    CaveConfig config;
    // variance of the noise, see GradientNoise
    const double variance = std::pow(0.27 * config.*height, 2);
    const double with = power_at_scale(config, scale);
    config.*height = 0;
    const double without = power_at_scale(config, scale);
    // Gradient noise has most of its power at wavelengths from one half to four lattice steps. The
    // other scales contribute slightly to the band, and slopes of the wall change the wavelengths.
    EXPECT_GT(with, 0.5 * variance) << scale;
    EXPECT_LT(with, 1.5 * variance) << scale;
    EXPECT_LT(without, 0.2 * variance) << scale;
  }
}

TEST(Cave, VerticesLieOnTheRoughSurfaceItself) {
  const CaveConfig config = small_cave();
  const CaveField rock(make_cave_graph(config, 5), config, 5);
  const world::WorldModel cave = make_cave(config, 5);
  std::vector<double> off;
  for (const Eigen::Vector3d& v : cave.mesh.vertices) off.push_back(std::abs(rock(v)));
  std::ranges::sort(off);
  // Two Newton steps with one gradient: the remaining distance is far below the finest roughness
  // nearly everywhere, and below its amplitude where they have not converged.
  EXPECT_LT(off[off.size() / 2], 0.1 * config.roughness_005m_m);
  EXPECT_LT(off[off.size() * 99 / 100], config.roughness_005m_m);
}

TEST(Cave, WidthsThatLeaveNoRoomForTheRoughnessAreRefused) {
  CaveConfig config = small_cave();
  config.width_min_m = 3;
  config.width_max_m = 2;
  EXPECT_THROW(make_cave(config, 1), InputError);
}

}  // namespace
}  // namespace lidarena::scenes
