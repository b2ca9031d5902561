// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/observed_surface.hpp"

#include <cmath>
#include <limits>

#include "lidarena/evaluation/map/point_scores.hpp"
#include "lidarena/map/point_map.hpp"

namespace lidarena::evaluation {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

constexpr double kOnMesh_m = 1e-3;    // a true hit is stored in single precision
constexpr double kExplained_m = 0.5;  // more than range noise
constexpr double kOtherSide = 0.05;   // share of hits; with more, the free side is unknown
constexpr std::size_t kBatch = 1 << 16U;

/// Collects hits and counts from which side each triangle was hit.
class Observation {
 public:
  explicit Observation(const world::World& world)
      : world_(world),
        center_(center_of(world)),
        voxels_(ObservedSurface::kVoxel_m),
        front_(world.mesh().triangles.size(), 0),
        back_(front_) {}

  /// Whether this is the first return in its voxel; `position` in m, world frame.
  bool is_new(const Vector3d& position) {
    ++surface_.returns;
    return voxels_.insert((position - center_).cast<float>());
  }
  void add(const Vector3d& position, const Vector3f& towards_sensor, std::uint32_t triangle) {
    surface_.hits.emplace_back((position - center_).cast<float>());
    const Vector3d normal = world_.mesh().cross(triangle);
    ++(normal.dot(towards_sensor.cast<double>()) > 0.0 ? front_ : back_)[triangle];
  }
  void add_off_mesh() { ++surface_.off_mesh; }

  ObservedSurface finish() {
    surface_.free_side.resize(front_.size(), FreeSide::kUnknown);
    for (std::size_t t = 0; t < front_.size(); ++t) {
      const double front = front_[t], back = back_[t];
      if (front > 0.0 && back <= kOtherSide * (front + back)) {
        surface_.free_side[t] = FreeSide::kFront;
      } else if (back > 0.0 && front <= kOtherSide * (front + back)) {
        surface_.free_side[t] = FreeSide::kBack;
      }
    }
    return std::move(surface_);
  }

 private:
  const world::World& world_;
  Vector3d center_;
  map::PointMap voxels_;
  std::vector<std::uint32_t> front_, back_;
  ObservedSurface surface_;
};

/// Finds the triangles from the positions, because the truth's indices are those of the simulator's
/// mesh.
void add_hits(const std::vector<PointTruth>& hits, const world::World& world,
              const Parallel& parallel, Observation& observation) {
  std::vector<Vector3d> positions;
  for (const PointTruth& hit : hits) positions.push_back(hit.position.cast<double>());
  std::vector<world::ClosestPoint> nearest(hits.size());
  world.closest_points(positions, kOnMesh_m, nearest, parallel);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (nearest[i].valid()) {
      observation.add(nearest[i].point, hits[i].normal, nearest[i].triangle);
    } else {
      observation.add_off_mesh();
    }
  }
}

struct Measured {
  world::Ray ray;
  double range = 0.0;
};

void add_rays(const std::vector<Measured>& measured, const world::World& world,
              const Parallel& parallel, Observation& observation) {
  std::vector<world::Ray> rays;
  for (const Measured& m : measured) rays.push_back(m.ray);
  std::vector<world::Hit> hits(rays.size());
  constexpr std::size_t kGrain = 1024;
  parallel.for_blocks(rays.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    world.cast(std::span(rays).subspan(begin, end - begin), std::numeric_limits<double>::infinity(),
               std::span(hits).subspan(begin, end - begin));
  });
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const world::Hit& hit = hits[i];
    if (!hit.valid() || std::abs(double{hit.range} - measured[i].range) > kExplained_m) {
      observation.add_off_mesh();
      continue;
    }
    const Vector3d at = rays[i].origin + double{hit.range} * rays[i].direction.cast<double>();
    observation.add(at, hit.normal, hit.triangle);
  }
}

}  // namespace

ObservedSurface observe(ScanTruthSource& truth, const world::World& world,
                        const Parallel& parallel) {
  Observation observation(world);
  std::vector<PointTruth> batch;
  while (const std::optional<ScanTruth> scan = truth.next()) {
    for (const PointTruth& point : scan->points) {
      if (observation.is_new(point.position.cast<double>())) batch.push_back(point);
    }
    if (batch.size() < kBatch) continue;
    add_hits(batch, world, parallel, observation);
    batch.clear();
  }
  add_hits(batch, world, parallel, observation);
  return observation.finish();
}

std::vector<TimedReturn> returns_of(const dataset::Cloud& map, const BodyMotion& motion,
                                    const Pose& body_from_lidar) {
  LidarPoses poses(motion, body_from_lidar);
  std::vector<TimedReturn> returns;
  returns.reserve(map.origins.size());
  for (std::size_t i = 0; i < map.origins.size(); ++i) {
    const Time stamp = from_seconds(map.origins[i].time_s);
    const Pose* world_from_lidar = poses.at(stamp);
    if (world_from_lidar == nullptr) continue;
    returns.push_back({stamp, world_from_lidar->inverse() * map.points[i].cast<double>()});
  }
  return returns;
}

ObservedSurface observe(std::span<const TimedReturn> returns, const Pose& body_from_lidar,
                        const Trajectory& truth, const world::World& world,
                        const Parallel& parallel) {
  Observation observation(world);
  LidarPoses poses(truth, body_from_lidar);
  std::vector<Measured> batch;
  for (const TimedReturn& measured : returns) {
    const Pose* world_from_lidar = poses.at(measured.stamp);
    if (world_from_lidar == nullptr) continue;
    const Vector3d position = *world_from_lidar * measured.position;
    if (!observation.is_new(position)) continue;
    const Vector3d origin = world_from_lidar->translation();
    const Vector3d sensor_to_point = position - origin;
    batch.push_back({{origin, sensor_to_point.normalized().cast<float>()}, sensor_to_point.norm()});
    if (batch.size() < kBatch) continue;
    add_rays(batch, world, parallel, observation);
    batch.clear();
  }
  add_rays(batch, world, parallel, observation);
  return observation.finish();
}

}  // namespace lidarena::evaluation
