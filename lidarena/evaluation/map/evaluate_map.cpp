// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/evaluate_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "lidarena/base/so3.hpp"
#include "lidarena/evaluation/map/map_json.hpp"
#include "lidarena/evaluation/metrics_json.hpp"
#include "lidarena/evaluation/trajectory/alignment.hpp"

namespace lidarena::evaluation {
namespace {

/// No more than `max_points` points of the map: every k-th point.
std::vector<Eigen::Vector3f> sample_of(std::span<const Eigen::Vector3f> map,
                                       std::size_t max_points) {
  const std::size_t stride = std::max<std::size_t>(1, (map.size() + max_points - 1) / max_points);
  std::vector<Eigen::Vector3f> sample;
  sample.reserve(map.size() / stride + 1);
  for (std::size_t i = 0; i < map.size(); i += stride) sample.push_back(map[i]);
  return sample;
}

/// Maximum number of points of a map that are scored; more take longer without changing the
/// numbers. For a failed map, far from the mesh, each search takes a hundred times as long, and the
/// numbers only show that it has failed, so fewer points are scored.
std::size_t max_scored_points(std::span<const Eigen::Vector3f> map, const Pose& mesh_from_map,
                              const world::World& world, const Parallel& parallel) {
  constexpr std::size_t kMaxPoints = 2'000'000, kMaxPointsOfFailed = 200'000,
                        kPreviewPoints = 10'000;
  constexpr double kFailed_percent = 95.0;  // beyond 20 cm
  const MapError preview =
      map_error(sample_of(map, kPreviewPoints), mesh_from_map, world, parallel);
  return preview.outliers_percent > kFailed_percent ? kMaxPointsOfFailed : kMaxPoints;
}

/// A map and what is computed once from it for all gauges.
struct Subject {
  std::vector<Eigen::Vector3f> map;
  const world::World& world;
  const Parallel& parallel;
  const SeenSurface* seen;
  const IdentifiedMap* identified;
  MortonOrder order;
  std::optional<PointGrid> grid;  ///< if completeness is computed

  Subject(std::span<const Eigen::Vector3f> points, std::size_t max_points, const world::World& mesh,
          const Parallel& workers, const SeenSurface* surface, const IdentifiedMap* with_hits)
      : map(sample_of(points, max_points)),
        world(mesh),
        parallel(workers),
        seen(surface),
        identified(with_hits),
        order(morton_order(map, workers)) {
    if (seen != nullptr) grid.emplace(completeness_grid(points, workers));
  }
};

std::vector<PointScore> score(const Subject& subject, const Pose& mesh_from_map) {
  return score_points(subject.map, subject.order, mesh_from_map, subject.world, subject.parallel);
}

/// `scores`: those of the map moved by `mesh_from_map`.
Json measure(const Subject& subject, std::span<const PointScore> scores,
             const Pose& mesh_from_map) {
  Json json = to_json(map_error(subject.order, scores, subject.map.size()));
  json["mesh_from_map_m_quaternion"] = value_to_json(mesh_from_map);
  json["per_voxel"] = to_json(voxel_error(subject.order, scores));
  json["ghosting"] = to_json(ghosting(scores, subject.world, subject.parallel));
  json["identity"] = nullptr;
  if (subject.identified != nullptr) {
    json["identity"] = to_json(identity_error(*subject.identified, mesh_from_map));
  }
  json["signed"] = nullptr;
  json["completeness"] = nullptr;
  if (subject.seen == nullptr) return json;
  json["signed"] = to_json(signed_distance(scores, subject.seen->observed.free_side));
  json["completeness"] = to_json(completeness(subject.seen->samples, *subject.grid, scores,
                                              mesh_from_map, subject.world, subject.parallel));
  return json;
}

Json measure_vertices(const Subject& subject, std::span<const PointScore> scores,
                      const Pose& mesh_from_map) {
  return to_json(vertex_distance(subject.map, subject.order, scores, mesh_from_map, subject.world,
                                 subject.parallel));
}

/// The transform from the first-pose gauge to this one is the rigid part of the drift.
Json measure_robust(const Subject& subject, const Pose& start, const Pose& first_pose) {
  const MeshAlignment alignment =
      align_to_mesh(subject.map, start, subject.world, subject.parallel);
  const Pose& moved = alignment.mesh_from_map;
  Json json = alignment.determined() ? measure(subject, score(subject, moved), moved)
                                     : Json{{"refused", alignment.refusal}};
  json["alignment"] = to_json(alignment);
  const Pose drift = moved * first_pose.inverse();
  json["alignment"]["turned_from_first_pose_rad"] = so3::angle(drift.linear());
  return json;
}

/// Diagonal (m) of the box that holds the middle 98 % of each coordinate.
double robust_diagonal(std::span<const Eigen::Vector3f> map) {
  constexpr std::size_t kPreviewPoints = 100'000;
  const std::size_t stride = std::max<std::size_t>(1, map.size() / kPreviewPoints);
  Eigen::Vector3d sizes = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (std::size_t i = 0; i < map.size(); i += stride) {
      if (map[i].allFinite()) values.push_back(double{map[i][axis]});
    }
    if (values.empty()) return 0.0;
    sizes[axis] = quantile(values, 0.99) - quantile(values, 0.01);
  }
  return sizes.norm();
}

double farthest_coordinate(std::span<const Eigen::Vector3f> map) {
  std::vector<double> values;
  for (const Eigen::Vector3f& p : map) {
    if (p.allFinite()) values.push_back(double{p.lpNorm<Eigen::Infinity>()});
  }
  return values.empty() ? 0.0 : quantile(values, 0.5);
}

}  // namespace

SeenSurface make_seen_surface(RayTruth truth, const world::World& world, const Parallel& parallel) {
  SeenSurface seen{std::move(truth.observed), {}, std::move(truth.identified)};
  seen.samples = seen_samples(world, seen.observed, parallel);
  return seen;
}

Json evaluate_map(std::span<const Eigen::Vector3f> map, const Trajectory& estimate,
                  const Trajectory& truth, const world::World& world, const Parallel& parallel,
                  const SeenSurface* seen, const IdentifiedMap* identified) {
  const Alignment rigid = align(estimate, truth, Gauge::kSe3);
  const Subject subject(map, max_scored_points(map, rigid.truth_from_estimate, world, parallel),
                        world, parallel, seen, identified);
  Json json = Json::object();
  std::optional<Pose> first_pose, start;
  for (const Gauge gauge : {Gauge::kFirstPose, Gauge::kSe3}) {
    const Alignment alignment = align(estimate, truth, gauge);
    if (!alignment.determined()) {
      json[to_string(gauge)] = {{"refused", alignment.refusal}};
      continue;
    }
    start = alignment.truth_from_estimate;
    if (gauge == Gauge::kFirstPose) first_pose = start;
    const std::vector<PointScore> scores = score(subject, *start);
    Json& measured = json[to_string(gauge)] = measure(subject, scores, *start);
    if (gauge == Gauge::kSe3) measured["point_vertex"] = measure_vertices(subject, scores, *start);
  }
  json["robust"] = start && first_pose
                       ? measure_robust(subject, *start, *first_pose)
                       : Json{{"refused", "neither first_pose nor se3 gives a pose to start from"}};
  return json;
}

std::vector<std::string> map_warnings(std::span<const Eigen::Vector3f> map,
                                      const world::World& world) {
  constexpr double kSuspicious = 100.0;  // a flight rarely sees less than 1 % of a world
  constexpr double kCoarse_m = 0.0005;
  std::vector<std::string> warnings;
  const auto invalid = std::count_if(map.begin(), map.end(),
                                     [](const Eigen::Vector3f& p) { return !p.allFinite(); });
  if (invalid > 0) {
    warnings.push_back(fmt::format("{} of {} points are not finite", invalid, map.size()));
  }
  const double map_m = robust_diagonal(map);
  const double mesh_m = world.mesh().bounds().diagonal().norm();
  if (map_m > 0.0 && mesh_m > kSuspicious * map_m) {
    warnings.push_back(fmt::format(
        "the mesh is {:.0f} times as large as the map: is it in millimeters?", mesh_m / map_m));
  }
  if (map_m > kSuspicious * mesh_m) {
    warnings.push_back(fmt::format(
        "the map is {:.0f} times as large as the mesh: is it in millimeters?", map_m / mesh_m));
  }
  const double far = farthest_coordinate(map);
  const double step = far * std::numeric_limits<float>::epsilon();
  if (step > kCoarse_m && map_m <= kSuspicious * mesh_m) {
    warnings.push_back(
        fmt::format("the map lies {:.0f} km from its origin, where single precision "
                    "resolves only {:.3g} mm",
                    far / 1000.0, 1000.0 * step));
  }
  return warnings;
}

}  // namespace lidarena::evaluation
