// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/evaluate_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "lidarena/base/so3.hpp"
#include "lidarena/evaluation/map/ghosting.hpp"
#include "lidarena/evaluation/map/map_error.hpp"
#include "lidarena/evaluation/map/mesh_alignment.hpp"
#include "lidarena/evaluation/map/point_classes.hpp"
#include "lidarena/evaluation/map/signed_distance.hpp"
#include "lidarena/evaluation/map/voxel_error.hpp"
#include "lidarena/evaluation/trajectory/alignment.hpp"
#include "lidarena/results/summary.hpp"

namespace lidarena::evaluation {
namespace {

constexpr std::size_t kMaxPoints = 2'000'000;       // in the alignment that tables show
constexpr std::size_t kMaxPointsOfOther = 250'000;  // in the other alignments

std::size_t stride_of(std::size_t points, std::size_t max_points) {
  return std::max<std::size_t>(1, (points + max_points - 1) / max_points);
}

/// No more than `max_count` of the values, one per point of a map: every k-th.
template <class T>
std::vector<T> sample_of(std::span<const T> all, std::size_t max_count) {
  const std::size_t stride = stride_of(all.size(), max_count);
  std::vector<T> sample;
  sample.reserve(all.size() / stride + 1);
  for (std::size_t i = 0; i < all.size(); i += stride) sample.push_back(all[i]);
  return sample;
}

/// Maximum number of points of a map that are scored; more take longer without changing the
/// numbers. For a failed map, far from the mesh, each search takes a hundred times as long, and the
/// numbers only show that it has failed, so fewer points are scored.
std::size_t max_scored_points(std::span<const Eigen::Vector3f> map, const Pose& mesh_from_map,
                              const world::World& world, const Parallel& parallel) {
  constexpr std::size_t kMaxPointsOfFailed = 200'000, kPreviewPoints = 10'000;
  constexpr double kFailed_percent = 95.0;  // beyond 20 cm
  const MapError preview =
      map_error(sample_of(map, kPreviewPoints), mesh_from_map, world, parallel);
  return preview.outliers_percent > kFailed_percent ? kMaxPointsOfFailed : kMaxPoints;
}

/// The points of a map that are scored, and what is computed once from them for several alignments.
struct Subject {
  std::vector<Eigen::Vector3f> map;  ///< the points that are scored
  std::size_t map_points;            ///< of the whole map
  const MapReference& reference;
  const Parallel& parallel;
  const IdentifiedMap* identified;
  std::vector<PointClass> classes;  ///< of the scored points; empty: not known
  MortonOrder order;
  const PointGrid* grid;  ///< of all points; null if completeness is not computed

  Subject(std::span<const Eigen::Vector3f> points, std::size_t max_points,
          const MapReference& scored_against, const Parallel& workers,
          const IdentifiedMap* with_hits, const PointGrid* of_all)
      : map(sample_of(points, max_points)),
        map_points(points.size()),
        reference(scored_against),
        parallel(workers),
        identified(with_hits),
        classes(with_hits == nullptr ? std::vector<PointClass>{}
                                     : sample_of(std::span(with_hits->classes), max_points)),
        order(morton_order(map, workers)),
        grid(of_all) {}
};

std::vector<PointScore> score(const Subject& subject, const Pose& mesh_from_map) {
  return score_points(subject.map, subject.order, mesh_from_map, subject.reference.world,
                      subject.parallel);
}

/// `scores`: those of the map moved by `mesh_from_map`.
results::MapScores measure(const Subject& subject, std::span<const PointScore> scores,
                           const Pose& mesh_from_map, std::vector<float>* distances = nullptr) {
  results::MapScores measured;
  static_cast<MapError&>(measured) =
      map_error(subject.order, scores, subject.map.size(), distances);
  measured.map_points = subject.map_points;
  measured.mesh_from_map = mesh_from_map;
  measured.per_voxel = voxel_error(subject.order, scores);
  measured.ghosting = ghosting(scores, subject.reference.world, subject.parallel);
  if (subject.identified != nullptr) {
    measured.identity = identity_error(*subject.identified, mesh_from_map);
    measured.classes = point_classes(subject.classes, subject.order, scores);
  }
  if (subject.grid == nullptr) return measured;
  measured.signed_distance = signed_distance(scores, subject.reference.seen->observed.free_side);
  measured.completeness = completeness(subject.reference.seen->samples, *subject.grid, scores,
                                       mesh_from_map, subject.reference.world, subject.parallel);
  return measured;
}

results::MapScores refused(const std::string& reason) {
  results::MapScores map;
  map.refused = reason;
  return map;
}

results::MapScores measure_in(const Alignment& alignment, const Subject& subject) {
  if (!alignment.determined()) return refused(alignment.refusal);
  const Pose& moved = alignment.truth_from_estimate;
  return measure(subject, score(subject, moved), moved);
}

/// As measure_in(), with the distance to vertices if the reference has them.
results::MapScores measure_with_vertices(const Alignment& alignment, const Subject& subject,
                                         ScoredPoints* scored) {
  if (!alignment.determined()) return refused(alignment.refusal);
  const Pose& moved = alignment.truth_from_estimate;
  const std::vector<PointScore> scores = score(subject, moved);
  if (scored != nullptr) {
    scored->mesh_from_map = moved;
    scored->stride = stride_of(subject.map_points, std::max<std::size_t>(1, subject.map.size()));
  }
  results::MapScores measured =
      measure(subject, scores, moved, scored == nullptr ? nullptr : &scored->distances);
  if (!subject.reference.subdivided) return measured;
  // The distance to vertices only serves comparison with those who measure it: a sample will do.
  const std::size_t stride = scores.size() / kMaxPointsOfOther + 1;
  MortonOrder order;
  std::vector<PointScore> sample;
  for (std::size_t k = 0; k < scores.size(); k += stride) {
    order.entries.push_back(subject.order.entries[k]);
    sample.push_back(scores[k]);
  }
  measured.point_vertex = subject.reference.subdivided->distance_of(subject.map, order, sample,
                                                                    moved, subject.parallel);
  return measured;
}

/// Aligns all of the map's scored points, and scores `subject`. The transform from the first-pose
/// alignment to this one is the rigid part of the drift.
results::MapScores measure_robust(const Subject& all, const Subject& subject, const Pose& start,
                                  const Pose& first_pose) {
  const MeshAlignment alignment =
      align_to_mesh(all.map, start, subject.reference.world, subject.parallel);
  const Pose& moved = alignment.mesh_from_map;
  results::MapScores measured = alignment.determined()
                                    ? measure(subject, score(subject, moved), moved)
                                    : refused(alignment.refusal);
  measured.alignment = alignment.fit;
  const Pose drift = moved * first_pose.inverse();
  measured.alignment->turned_from_first_pose_rad = so3::angle(drift.linear());
  return measured;
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
    sizes[axis] = results::quantile(values, 0.99) - results::quantile(values, 0.01);
  }
  return sizes.norm();
}

double farthest_coordinate(std::span<const Eigen::Vector3f> map) {
  std::vector<double> values;
  for (const Eigen::Vector3f& p : map) {
    if (p.allFinite()) values.push_back(double{p.lpNorm<Eigen::Infinity>()});
  }
  return values.empty() ? 0.0 : results::quantile(values, 0.5);
}

}  // namespace

SeenSurface make_seen_surface(RayTruth truth, const world::World& world, const Parallel& parallel) {
  SeenSurface seen{std::move(truth.observed), {}, std::move(truth.identified)};
  seen.samples = seen_samples(world, seen.observed, parallel);
  return seen;
}

results::MapMetrics evaluate_map(std::span<const Eigen::Vector3f> map, const Trajectory& estimate,
                                 const Trajectory& truth, const MapReference& reference,
                                 const Parallel& parallel, const IdentifiedMap* identified,
                                 ScoredPoints* scored) {
  const Alignment se3 = align(estimate, truth, AlignmentKind::kSe3);
  const Alignment first_pose = align(estimate, truth, AlignmentKind::kFirstPose);
  const std::size_t max_points =
      max_scored_points(map, se3.truth_from_estimate, reference.world, parallel);
  std::optional<PointGrid> grid;
  if (reference.seen) grid.emplace(completeness_grid(map, parallel));
  const Subject all(map, max_points, reference, parallel, identified, grid ? &*grid : nullptr);
  const Subject some(map, std::min(max_points, kMaxPointsOfOther), reference, parallel, nullptr,
                     nullptr);
  results::MapMetrics metrics;
  metrics.se3 = measure_with_vertices(se3, all, scored);
  metrics.first_pose = measure_in(first_pose, se3.determined() ? some : all);
  const Alignment& start = se3.determined() ? se3 : first_pose;
  metrics.robust =
      first_pose.determined()
          ? measure_robust(all, some, start.truth_from_estimate, first_pose.truth_from_estimate)
          : refused("neither first_pose nor se3 gives a pose to start from");
  return metrics;
}

results::InterpolationFloor interpolation_floor(std::span<const Eigen::Vector3f> interpolated,
                                                const world::World& world,
                                                const Parallel& parallel) {
  if (interpolated.empty()) return {};
  const MapError error =
      map_error(sample_of(interpolated, kMaxPoints), Pose::Identity(), world, parallel);
  return {error.points, error.distance_m.rmse, error.outliers_percent};
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
