// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "lidarena/sensor/lidar.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "lidarena/world/world.hpp"
#include "tests/world/shapes.hpp"

/// Worlds with closed-form answers, and small sensors for them.
namespace lidarena::sensor::testing {

/// The wall x = `distance`, 120 m wide and high.
inline world::TriangleMesh wall_mesh(double distance) {
  world::TriangleMesh mesh;
  mesh.vertices = {
      {distance, -60, -60}, {distance, 60, -60}, {distance, 60, 60}, {distance, -60, 60}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// A sphere of facets: an octahedron whose faces are divided into four `levels` times.
inline world::TriangleMesh sphere_mesh(double radius, int levels) {
  world::TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [place, added] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
      if (added) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
      return place->second;
    };
    std::vector<world::Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (auto& vertex : mesh.vertices) vertex *= radius;
  return mesh;
}

/// First hit by trying every triangle in double precision; infinity when there is none.
inline double brute_force_cast(const world::TriangleMesh& mesh, const Eigen::Vector3d& origin,
                               const Eigen::Vector3d& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : mesh.triangles) {
    Eigen::Matrix3d columns;
    columns << mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a], -direction;
    const Eigen::Vector3d uvt = columns.inverse() * (origin - mesh.vertices[a]);
    const bool inside = uvt[0] >= -1e-12 && uvt[1] >= -1e-12 && uvt[0] + uvt[1] <= 1 + 1e-12;
    if (inside && uvt[2] > 0) nearest = std::min(nearest, uvt[2]);
  }
  return nearest;
}

/// Distance from a point in the box [low, high] to its wall, along `direction`.
inline double range_in_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                           const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  double range = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double wall = direction[axis] > 0 ? high[axis] : low[axis];
    if (direction[axis] != 0) range = std::min(range, (wall - origin[axis]) / direction[axis]);
  }
  return range;
}

/// Distance from a point to the surface of the box [low, high].
inline double distance_to_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                              const Eigen::Vector3d& point) {
  const Eigen::Vector3d outside = (low - point).cwiseMax(point - high);
  if (outside.maxCoeff() > 0) return outside.cwiseMax(0.0).norm();
  return -outside.maxCoeff();
}

/// The built-in Mid-360, mounted with an offset and a tilt.
inline SensorConfig mid360() {
  SensorConfig config;
  config.name = "mid360";
  config.body_from_lidar =
      make_pose(Eigen::Quaterniond(0.9, 0.1, -0.3, 0.2), Eigen::Vector3d(0.3, -0.2, 0.1));
  return config;
}

inline SensorConfig ouster(int columns = 512) {
  SensorConfig config = mid360();
  config.name = "ouster";
  config.model = LidarModel::kOusterOs0128;
  config.columns = columns;
  return config;
}

inline Lidar make_lidar(const SensorConfig& config, std::uint64_t seed = 1) {
  return Lidar(config, make_pattern(config), config.name, seed, true);
}

inline bool same(const Scan& a, const Scan& b) {
  return a.stamp == b.stamp && a.timed == b.timed &&
         std::equal(a.points.begin(), a.points.end(), b.points.begin(), b.points.end(),
                    [](const Point& p, const Point& q) {
                      return p.position == q.position && p.intensity == q.intensity &&
                             p.dt_ns == q.dt_ns && p.ring == q.ring && p.echo == q.echo;
                    });
}

}  // namespace lidarena::sensor::testing
