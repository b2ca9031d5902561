// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <string_view>
#include <vector>

#include "lidarena/base/angle.hpp"
#include "lidarena/base/config.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena::results {
namespace {

constexpr double kNear_m = 0.05;  ///< distance within which completeness is a main figure

using Trajectory = std::optional<TrajectoryMetrics> RunMetrics::*;
using Map = std::optional<MapMetrics> MapsOfRun::*;

/// Empty for a summary of nothing.
std::optional<double> known(const Summary& summary, double Summary::*statistic) {
  return summary.empty() ? std::nullopt : std::optional(summary.*statistic);
}

std::string count_of(std::size_t count, const char* what) {
  return fmt::format("{} {}", count, what);
}

Reading of_rpe(const RpeMetrics& rpe, std::optional<double> value) {
  return {value,
          rpe.definition,
          "",
          "",
          rpe.used,
          rpe.total,
          fmt::format("{} of {} pieces", rpe.used, rpe.total)};
}
Reading translation(const RpeMetrics& rpe) {
  return of_rpe(rpe, known(rpe.translation, &Summary::rmse));
}
Reading rotation(const RpeMetrics& rpe) { return of_rpe(rpe, known(rpe.rotation, &Summary::rmse)); }
Reading floor_of(const RpeMetrics& rpe) {
  return of_rpe(rpe, rpe.floor ? std::optional(rpe.floor->translation_rmse_m) : std::nullopt);
}

Reading of_ate(const AteMetrics& ate, std::optional<double> value) {
  return {value,
          ate.definition,
          ate.refused.value_or(""),
          ate.warning.value_or(""),
          std::nullopt,
          std::nullopt,
          count_of(ate.translation.count, "poses")};
}
Reading translation(const AteMetrics& ate) {
  return of_ate(ate, known(ate.translation, &Summary::rmse));
}
Reading rotation(const AteMetrics& ate) { return of_ate(ate, known(ate.rotation, &Summary::rmse)); }

Reading translation(const KittiError& kitti) {
  return {kitti.translation_percent,       kitti.definition, kitti.refused.value_or(""), "", {}, {},
          count_of(kitti.pieces, "pieces")};
}

/// How many points were scored: "900 points", "900 of 1800 points" where they are a sample.
std::string points_of(const MapScores& map) {
  return map.points < map.map_points ? fmt::format("{} of {} points", map.points, map.map_points)
                                     : count_of(map.points, "points");
}

/// A reading of a map or of a part of its scores with a definition of its own.
Reading of_map(std::optional<double> value, const std::string& definition, std::string samples,
               const std::optional<std::string>& refused = {}) {
  return {value, definition, refused.value_or(""), "", {}, {}, std::move(samples), false};
}
Reading of_points(const MapScores& map, std::optional<double> value) {
  Reading reading = of_map(value, map.definition, points_of(map), map.refused);
  reading.used = map.points;
  reading.total = std::max(map.points, map.map_points);
  return reading;
}
Reading rmse(const MapScores& map) { return of_points(map, known(map.distance_m, &Summary::rmse)); }
Reading rmse_inliers(const MapScores& map) { return of_points(map, map.rmse_inliers_m); }
Reading outliers(const MapScores& map) {
  Reading reading = of_points(map, map.outliers_percent);
  reading.is_share = true;
  return reading;
}
Reading of_completeness(const MapScores& map, double CompletenessRow::*share) {
  const CompletenessRow* row = map.completeness.within(kNear_m);
  return of_map(row == nullptr ? std::nullopt : std::optional(row->*share),
                map.completeness.definition, count_of(map.completeness.samples, "samples"),
                map.refused);
}
Reading completeness(const MapScores& map) {
  return of_completeness(map, &CompletenessRow::recall_percent);
}
Reading f_score(const MapScores& map) {
  return of_completeness(map, &CompletenessRow::f_score_percent);
}
Reading double_walls(const MapScores& map) {
  const Ghosting& g = map.ghosting;
  return of_map(g.empty() ? std::nullopt : std::optional(g.double_percent), g.definition,
                count_of(g.patches, "patches"), map.refused);
}
Reading identity(const MapScores& map) {
  const IdentityError& e = map.identity;
  return of_map(known(e.distance_m, &Summary::rmse), e.definition,
                count_of(e.distance_m.count, "points"), map.refused);
}
/// Share of a class; none where all points are of the mesh or nothing is known of them.
template <std::optional<ClassOfPoints> PointClasses::*kind>
Reading share(const MapScores& map) {
  const PointClasses& classes = map.classes;
  bool any = false;
  for (const auto& stray : {classes.mover, classes.air, classes.ghost})
    any = any || (stray && stray->points > 0);
  const std::optional<ClassOfPoints>& of = classes.*kind;
  return of_map(any && of ? std::optional(of->share_percent) : std::nullopt, classes.definition,
                count_of(classes.points, "points"), map.refused);
}
template <std::optional<double> VertexDistance::*value>
Reading vertices(const MapScores& map) {
  const VertexDistance& d = map.point_vertex;
  Reading reading = of_map(d.*value, d.definition, count_of(d.points, "points"),
                           d.refused ? d.refused : map.refused);
  reading.used = d.points;
  reading.total = std::max<std::size_t>(d.points, map.map_points);
  reading.is_share = value == &VertexDistance::outliers_percent;
  return reading;
}
constexpr auto kToVertices = vertices<&VertexDistance::rmse_m>;
constexpr auto kBeyondVertices = vertices<&VertexDistance::outliers_percent>;

// Each makes the function of a figure from the place of its group and how it is read there.

template <Trajectory trajectory, auto pick, Reading (*read)(const RpeMetrics&)>
Reading rpe(const RunMetrics& m) {
  return m.*trajectory && (m.*trajectory)->rpe ? read(pick(*(m.*trajectory)->rpe)) : Reading{};
}
template <std::size_t i>
constexpr auto kLength = [](const RpeByLength& rpe) -> const RpeMetrics& { return rpe.lengths[i]; };
constexpr auto kAtPoses = [](const RpeByLength& rpe) -> const RpeMetrics& {
  return rpe.at_poses_1m;
};
constexpr auto kOverTime = [](const RpeByLength& rpe) -> const RpeMetrics& { return rpe.over_1s; };

const RpeAtOffset* at_best_offset(const RunMetrics& m) {
  const auto* rpe = m.final && m.final->rpe ? &*m.final->rpe : nullptr;
  return rpe != nullptr && rpe->at_best_offset_1m ? &*rpe->at_best_offset_1m : nullptr;
}
Reading rpe_at_best_offset(const RunMetrics& m) {
  const RpeAtOffset* best = at_best_offset(m);
  return best == nullptr ? Reading{} : translation(best->rpe);
}
Reading best_offset(const RunMetrics& m) {
  const RpeAtOffset* best = at_best_offset(m);
  return best == nullptr ? Reading{} : of_rpe(best->rpe, best->late_s);
}

Reading rpe_at_lidar_clock(const RunMetrics& m) {
  const auto* rpe = m.final && m.final->rpe ? &*m.final->rpe : nullptr;
  return rpe == nullptr || !rpe->at_lidar_clock_1m ? Reading{}
                                                   : translation(*rpe->at_lidar_clock_1m);
}

template <Trajectory trajectory, AteMetrics AteByAlignment::*by, Reading (*read)(const AteMetrics&)>
Reading ate(const RunMetrics& m) {
  return m.*trajectory && (m.*trajectory)->ate ? read((*(m.*trajectory)->ate).*by) : Reading{};
}
template <std::optional<KittiError> TrajectoryMetrics::*kitti>
Reading kitti_of(const RunMetrics& m) {
  return m.final && (*m.final).*kitti ? translation(*((*m.final).*kitti)) : Reading{};
}
template <Map map, Reading (*read)(const MapScores&)>
Reading map_of(const RunMetrics& m) {
  if (!(m.maps.*map)) return {};
  const MapScores& se3 = (m.maps.*map)->se3;
  const MapScores* scores = scores_of(m.maps.*map);
  Reading reading = read(scores == nullptr ? se3 : *scores);
  if (scores != nullptr && scores != &se3) {
    reading.warning = "aligned by the first pose: " + se3.refused.value_or("");
  }
  return reading;
}
template <Map map, Reading (*read)(const MapScores&)>
Reading robust_map_of(const RunMetrics& m) {
  return m.maps.*map ? read((m.maps.*map)->robust) : Reading{};
}
template <std::optional<double> InterpolationFloor::*value>
Reading floor_of_map(const RunMetrics& m) {
  const InterpolationFloor& floor = m.maps.interpolation_floor;
  return {floor.*value, "", "", "", {}, {}, count_of(floor.points, "points")};
}
template <SummaryInSeconds ResourceMetrics::*time, double Summary::*statistic>
Reading time_of_scan(const RunMetrics& m) {
  return {known(m.resources.*time, statistic), "", "", "", {}, {}, ""};
}
template <std::size_t ScansOfRun::*count>
Reading scans(const RunMetrics& m) {
  if (m.scans.empty()) return {};
  return {static_cast<double>(m.scans.*count), "", "", "", {}, {}, ""};
}
Reading cpu_load(const RunMetrics& m) {
  return {m.resources.cpu_load_percent, "", "", "", {}, {}, ""};
}
Reading late_scans(const RunMetrics& m) {
  if (m.resources.empty()) return {};
  return {m.resources.late_scans, "", "", "", {}, {}, ""};
}
template <MemoryMetrics ResourceMetrics::*memory>
Reading peak(const RunMetrics& m) {
  if (m.resources.empty()) return {};
  return {(m.resources.*memory).peak_bytes, "", "", "", {}, {}, ""};
}
Reading growth(const RunMetrics& m) {
  if (m.resources.empty()) return {};
  return {m.resources.own.growth_bytes_per_s, "", "", "", {}, {}, ""};
}
Reading growth_r_squared(const RunMetrics& m) {
  if (m.resources.empty()) return {};
  return {m.resources.own.growth_r_squared, "", "", "", {}, {}, ""};
}
Reading real_time_factor(const RunMetrics& m) {
  if (m.resources.empty()) return {};
  return {m.resources.real_time_factor, "", "", "", {}, {}, ""};
}

constexpr Trajectory kFinal = &RunMetrics::final;
constexpr Trajectory kLive = &RunMetrics::live;
constexpr Map kOwn = &MapsOfRun::own;
constexpr Map kReprojected = &MapsOfRun::reprojected;
constexpr auto kOfPath = Subject::kTrajectory;
constexpr auto kOfLive = Subject::kLiveTrajectory;
constexpr auto kOfMap = Subject::kMap;
constexpr auto kOfRun = Subject::kResources;
constexpr auto kNone = FigureTable::kNone;
constexpr auto kMain = FigureTable::kMain;
constexpr auto kMapTable = FigureTable::kMap;
constexpr auto kRuns = FigureTable::kRuns;

constexpr std::array kFigures{
    Figure{"rpe_1m_at_poses_translation", "RPE cm/m", 100, "cm", "RPE per meter, pose to pose",
           kOfPath, rpe<kFinal, kAtPoses, translation>, kMain},
    Figure{"rpe_1m_at_poses_rotation", "RPE deg/m", kDegreesPerRadian, "deg",
           "RPE per meter, pose to pose, rotation", kOfPath, rpe<kFinal, kAtPoses, rotation>,
           kMain},
    Figure{"rpe_1m_at_best_offset", nullptr, 100, "cm", "RPE per meter, at the best time offset",
           kOfPath, rpe_at_best_offset},
    Figure{"rpe_best_offset", nullptr, 1e3, "ms", "best time offset, stamps late by", kOfPath,
           best_offset},
    Figure{"rpe_1m_at_lidar_clock", nullptr, 100, "cm", "RPE per meter, at the LiDAR's clock",
           kOfPath, rpe_at_lidar_clock},
    Figure{"rpe_1m_translation", nullptr, 100, "cm", "RPE per meter, ends interpolated", kOfPath,
           rpe<kFinal, kLength<0>, translation>},
    Figure{"rpe_1m_rotation", nullptr, kDegreesPerRadian, "deg",
           "RPE per meter, ends interpolated, rotation", kOfPath,
           rpe<kFinal, kLength<0>, rotation>},
    Figure{"rpe_1m_floor", nullptr, 100, "cm", "RPE per meter, interpolation (floor)", kOfPath,
           rpe<kFinal, kLength<0>, floor_of>},
    Figure{"rpe_1s_translation", nullptr, 100, "cm", "RPE per second", kOfPath,
           rpe<kFinal, kOverTime, translation>},
    Figure{"rpe_10m_translation", nullptr, 100, "cm", "RPE per 10 m", kOfPath,
           rpe<kFinal, kLength<3>, translation>},
    Figure{"rpe_50m_translation", nullptr, 100, "cm", "RPE per 50 m", kOfPath,
           rpe<kFinal, kLength<5>, translation>},
    Figure{"ate_se3_translation", "ATE cm", 100, "cm", "ATE, SE(3) alignment", kOfPath,
           ate<kFinal, &AteByAlignment::se3, translation>, kMain},
    Figure{"ate_se3_rotation", nullptr, kDegreesPerRadian, "deg", "ATE, SE(3) alignment, rotation",
           kOfPath, ate<kFinal, &AteByAlignment::se3, rotation>},
    Figure{"ate_posyaw_translation", nullptr, 100, "cm", "ATE, position and heading", kOfPath,
           ate<kFinal, &AteByAlignment::posyaw, translation>},
    Figure{"ate_first_pose_translation", nullptr, 100, "cm", "ATE, first-pose alignment", kOfPath,
           ate<kFinal, &AteByAlignment::first_pose, translation>},
    Figure{"kitti_translation", nullptr, 1, "%", "KITTI, 100 to 800 m", kOfPath,
           kitti_of<&TrajectoryMetrics::kitti>},
    Figure{"kitti_short_translation", nullptr, 1, "%", "KITTI's rule, 1 to 50 m", kOfPath,
           kitti_of<&TrajectoryMetrics::kitti_short>},
    Figure{"live_rpe_1m_at_poses_translation", "live RPE cm/m", 100, "cm", "RPE per meter, live",
           kOfLive, rpe<kLive, kAtPoses, translation>, kMain},
    Figure{"live_ate_se3_translation", nullptr, 100, "cm", "ATE, SE(3) alignment, live", kOfLive,
           ate<kLive, &AteByAlignment::se3, translation>},
    Figure{"own_map_rmse", "own map cm", 100, "cm", "own map, RMSE", kOfMap, map_of<kOwn, rmse>,
           kMain},
    Figure{"own_map_outliers", nullptr, 1, "%", "own map, beyond 20 cm", kOfMap,
           map_of<kOwn, outliers>, kRuns},
    Figure{"own_map_rmse_robust", nullptr, 100, "cm", "own map, RMSE, robust alignment", kOfMap,
           robust_map_of<kOwn, rmse>},
    Figure{"own_map_rmse_vertices", nullptr, 100, "cm", "own map, RMSE to vertices", kOfMap,
           map_of<kOwn, kToVertices>},
    Figure{"own_map_outliers_vertices", nullptr, 1, "%", "own map, beyond 20 cm of vertices",
           kOfMap, map_of<kOwn, kBeyondVertices>},
    Figure{"own_map_completeness", nullptr, 1, "%", "own map, completeness at 5 cm", kOfMap,
           map_of<kOwn, completeness>, kNone, Better::kMore},
    Figure{"own_map_f_score", nullptr, 1, "%", "own map, F-score at 5 cm", kOfMap,
           map_of<kOwn, f_score>, kNone, Better::kMore},
    Figure{"own_map_double_walls", nullptr, 1, "%", "own map, double walls", kOfMap,
           map_of<kOwn, double_walls>},
    Figure{"reprojected_map_rmse", "map cm", 100, "cm", "reprojected map, RMSE", kOfMap,
           map_of<kReprojected, rmse>, kMain},
    Figure{"reprojected_map_rmse_inliers", nullptr, 100, "cm", "reprojected map, RMSE of inliers",
           kOfMap, map_of<kReprojected, rmse_inliers>},
    Figure{"reprojected_map_outliers", "outliers %", 1, "%", "reprojected map, beyond 20 cm",
           kOfMap, map_of<kReprojected, outliers>, kMain},
    Figure{"reprojected_map_rmse_robust", "robust cm", 100, "cm",
           "reprojected map, RMSE, robust alignment", kOfMap, robust_map_of<kReprojected, rmse>,
           kMapTable},
    Figure{"reprojected_map_rmse_vertices", "to vertices cm", 100, "cm",
           "reprojected map, RMSE to vertices", kOfMap, map_of<kReprojected, kToVertices>,
           kMapTable},
    Figure{"reprojected_map_completeness", "complete %", 1, "%",
           "reprojected map, completeness at 5 cm", kOfMap, map_of<kReprojected, completeness>,
           kMapTable, Better::kMore},
    Figure{"reprojected_map_f_score", "F-score %", 1, "%", "reprojected map, F-score at 5 cm",
           kOfMap, map_of<kReprojected, f_score>, kMapTable, Better::kMore},
    Figure{"reprojected_map_double_walls", "double walls %", 1, "%",
           "reprojected map, double walls", kOfMap, map_of<kReprojected, double_walls>, kMapTable},
    Figure{"reprojected_map_identity", "identity cm", 100, "cm", "reprojected map, identity error",
           kOfMap, map_of<kReprojected, identity>, kMapTable},
    Figure{"reprojected_map_movers", nullptr, 1, "%", "reprojected map, points of movers", kOfMap,
           map_of<kReprojected, share<&PointClasses::mover>>},
    Figure{"reprojected_map_air", nullptr, 1, "%", "reprojected map, points of the air", kOfMap,
           map_of<kReprojected, share<&PointClasses::air>>},
    Figure{"reprojected_map_ghosts", nullptr, 1, "%", "reprojected map, ghosts", kOfMap,
           map_of<kReprojected, share<&PointClasses::ghost>>},
    Figure{"interpolation_floor_rmse", "floor cm", 100, "cm",
           "reprojected map, interpolation (floor)", kOfMap,
           floor_of_map<&InterpolationFloor::rmse_m>, kMapTable},
    Figure{"interpolation_floor_outliers", "floor outliers %", 1, "%",
           "reprojected map, beyond 20 cm (floor)", kOfMap,
           floor_of_map<&InterpolationFloor::outliers_percent>, kMapTable},
    Figure{"latency_median", nullptr, 1e3, "ms", "latency, median", kOfRun,
           time_of_scan<&ResourceMetrics::latency, &Summary::median>},
    Figure{"latency_p95", nullptr, 1e3, "ms", "latency, P95", kOfRun,
           time_of_scan<&ResourceMetrics::latency, &Summary::p95>, kRuns},
    Figure{"latency_p99", nullptr, 1e3, "ms", "latency, P99", kOfRun,
           time_of_scan<&ResourceMetrics::latency, &Summary::p99>},
    Figure{"latency_max", nullptr, 1e3, "ms", "latency, maximum", kOfRun,
           time_of_scan<&ResourceMetrics::latency, &Summary::max>},
    Figure{"refused_scans", nullptr, 1, "", "scans refused (out of order)", kOfRun,
           scans<&ScansOfRun::refused>},
    Figure{"dropped_scans", nullptr, 1, "", "scans dropped (method late)", kOfRun,
           scans<&ScansOfRun::dropped>},
    Figure{"late_scans", nullptr, 100, "%", "scans not done when the next one came", kOfRun,
           late_scans, kRuns},
    Figure{"cpu_p95", "CPU P95 ms", 1e3, "ms", "CPU time of a scan, P95", kOfRun,
           time_of_scan<&ResourceMetrics::cpu, &Summary::p95>, kMain},
    Figure{"cpu_load", "CPU %", 1, "%", "CPU time, share of one core", kOfRun, cpu_load, kMain},
    Figure{"real_time_factor", nullptr, 1, "x", "real-time factor", kOfRun, real_time_factor, kNone,
           Better::kMore},
    Figure{"own_memory_peak", "own MB", 1e-6, "MB", "own memory, peak", kOfRun,
           peak<&ResourceMetrics::own>, kMain},
    Figure{"own_memory_growth", nullptr, 1e-6, "MB/s", "own memory, growth", kOfRun, growth},
    Figure{"own_memory_growth_r_squared", nullptr, 1, "", "own memory, r squared of its growth",
           kOfRun, growth_r_squared},
    Figure{"process_memory_peak", nullptr, 1e-6, "MB", "process memory, peak", kOfRun,
           peak<&ResourceMetrics::rss>},
};

consteval const Figure& known(std::string_view key) {
  return *std::ranges::find_if(kFigures, [&](const Figure& figure) { return key == figure.key; });
}

std::optional<double> coverage_percent(const std::optional<TrajectoryMetrics>& trajectory) {
  if (!trajectory) return std::nullopt;
  return 100.0 * trajectory->association.coverage;
}

}  // namespace

const Figure& kDrift = known("rpe_1m_at_poses_translation");
const Figure& kDriftRotation = known("rpe_1m_at_poses_rotation");
const Figure& kAte = known("ate_se3_translation");
const Figure& kOwnMapRmse = known("own_map_rmse");
const Figure& kOwnMapOutliers = known("own_map_outliers");
const Figure& kOwnMapRmseToVertices = known("own_map_rmse_vertices");
const Figure& kOwnMapBeyondVertices = known("own_map_outliers_vertices");
const Figure& kMapRmse = known("reprojected_map_rmse");
const Figure& kMapOutliers = known("reprojected_map_outliers");
const Figure& kCpuP95 = known("cpu_p95");
const Figure& kCpuLoad = known("cpu_load");
const Figure& kLiveDrift = known("live_rpe_1m_at_poses_translation");
const Figure& kOwnMemory = known("own_memory_peak");

std::span<const Figure> figures() { return kFigures; }

double upper_bound_of_zero(std::size_t n) { return 300.0 / static_cast<double>(n); }

std::optional<double> zero_bound(const Reading& reading) {
  if (!reading.is_share || reading.value != 0.0 || reading.used.value_or(0) == 0)
    return std::nullopt;
  return upper_bound_of_zero(*reading.used);
}

std::string column_of(const Figure& figure) {
  std::string unit = figure.unit;
  if (unit == "%") unit = "percent";
  std::ranges::replace(unit, '/', '_');
  return figure.key + (unit.empty() ? "" : "_" + unit);
}

const Figure& figure_of(const std::string& key, const std::string& place) {
  std::vector<std::string> keys;
  for (const Figure& figure : kFigures) {
    if (key == figure.key) return figure;
    keys.emplace_back(figure.key);
  }
  const std::string nearest = nearest_word(key, keys);
  throw InputError(
      place, "there is no figure '" + key + "'",
      nearest.empty() ? "docs/metrics.md lists them" : "did you mean '" + nearest + "'?");
}

std::optional<double> value_of(const RunMetrics& metrics, const Figure& figure) {
  const std::optional<double> value = figure.read(metrics).value;
  return value ? std::optional(*value * figure.factor) : std::nullopt;
}

std::optional<double> coverage_of(const RunMetrics& metrics) {
  return coverage_percent(metrics.final);
}

std::optional<double> coverage_of(const RunMetrics& metrics, const Figure& figure) {
  return coverage_percent(figure.subject == Subject::kLiveTrajectory ? metrics.live
                                                                     : metrics.final);
}

}  // namespace lidarena::results
