// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/metric_figures.hpp"

#include <fmt/format.h>

#include <array>
#include <numbers>
#include <string_view>

namespace lidarena::evaluation {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

constexpr FigureTable kNone = FigureTable::kNone;
constexpr FigureTable kMain = FigureTable::kMain;
constexpr FigureTable kMap = FigureTable::kMap;

constexpr std::array kFigures{
    MetricFigure{"rpe_1m_at_poses_translation", "RPE cm/m", "/final/rpe/1m_at_poses",
                 "/translation/rmse_m", 100, "cm", "RPE per meter, pose to pose", kMain},
    MetricFigure{"rpe_1m_at_poses_rotation", "RPE deg/m", "/final/rpe/1m_at_poses",
                 "/rotation/rmse_rad", kDegrees, "deg", "RPE per meter, pose to pose, rotation",
                 kMain},
    MetricFigure{"rpe_1m_translation", nullptr, "/final/rpe/1m", "/translation/rmse_m", 100, "cm",
                 "RPE per meter, ends interpolated"},
    MetricFigure{"rpe_1m_rotation", nullptr, "/final/rpe/1m", "/rotation/rmse_rad", kDegrees, "deg",
                 "RPE per meter, ends interpolated, rotation"},
    MetricFigure{"rpe_1m_floor", nullptr, "/final/rpe/1m", "/floor/translation_rmse_m", 100, "cm",
                 "RPE per meter, interpolation (floor)"},
    MetricFigure{"rpe_1s_translation", nullptr, "/final/rpe/1s", "/translation/rmse_m", 100, "cm",
                 "RPE per second"},
    MetricFigure{"rpe_10m_translation", nullptr, "/final/rpe/10m", "/translation/rmse_m", 100, "cm",
                 "RPE per 10 m"},
    MetricFigure{"rpe_50m_translation", nullptr, "/final/rpe/50m", "/translation/rmse_m", 100, "cm",
                 "RPE per 50 m"},
    MetricFigure{"ate_se3_translation", "ATE cm", "/final/ate/se3", "/translation/rmse_m", 100,
                 "cm", "ATE, SE(3) gauge", kMain},
    MetricFigure{"ate_se3_rotation", nullptr, "/final/ate/se3", "/rotation/rmse_rad", kDegrees,
                 "deg", "ATE, SE(3) gauge, rotation"},
    MetricFigure{"ate_posyaw_translation", nullptr, "/final/ate/posyaw", "/translation/rmse_m", 100,
                 "cm", "ATE, position and heading"},
    MetricFigure{"ate_first_pose_translation", nullptr, "/final/ate/first_pose",
                 "/translation/rmse_m", 100, "cm", "ATE, first-pose gauge"},
    MetricFigure{"kitti_translation", nullptr, "/final/kitti", "/translation_percent", 1, "%",
                 "KITTI, 100 to 800 m"},
    MetricFigure{"kitti_short_translation", nullptr, "/final/kitti_short", "/translation_percent",
                 1, "%", "KITTI's rule, 1 to 50 m"},
    MetricFigure{"live_rpe_1m_at_poses_translation", nullptr, "/live/rpe/1m_at_poses",
                 "/translation/rmse_m", 100, "cm", "RPE per meter, live"},
    MetricFigure{"live_ate_se3_translation", nullptr, "/live/ate/se3", "/translation/rmse_m", 100,
                 "cm", "ATE, SE(3) gauge, live"},
    MetricFigure{"own_map_rmse", "own map cm", "/maps/own/se3", "/distance/rmse_m", 100, "cm",
                 "own map, RMSE", kMain},
    MetricFigure{"own_map_outliers", nullptr, "/maps/own/se3", "/outliers_percent", 1, "%",
                 "own map, beyond 20 cm"},
    MetricFigure{"own_map_rmse_robust", nullptr, "/maps/own/robust", "/distance/rmse_m", 100, "cm",
                 "own map, RMSE, robust gauge"},
    MetricFigure{"own_map_completeness", nullptr, "/maps/own/se3/completeness",
                 "/rows/1/recall_percent", 1, "%", "own map, completeness at 5 cm", kNone,
                 Better::kMore},
    MetricFigure{"own_map_f_score", nullptr, "/maps/own/se3/completeness",
                 "/rows/1/f_score_percent", 1, "%", "own map, F-score at 5 cm", kNone,
                 Better::kMore},
    MetricFigure{"own_map_double_walls", nullptr, "/maps/own/se3/ghosting", "/double_percent", 1,
                 "%", "own map, double walls"},
    MetricFigure{"reprojected_map_rmse", "map cm", "/maps/reprojected/se3", "/distance/rmse_m", 100,
                 "cm", "reprojected map, RMSE", kMain},
    MetricFigure{"reprojected_map_rmse_inliers", nullptr, "/maps/reprojected/se3",
                 "/rmse_inliers_m", 100, "cm", "reprojected map, RMSE of inliers"},
    MetricFigure{"reprojected_map_outliers", "outliers %", "/maps/reprojected/se3",
                 "/outliers_percent", 1, "%", "reprojected map, beyond 20 cm", kMain},
    MetricFigure{"reprojected_map_rmse_robust", "robust cm", "/maps/reprojected/robust",
                 "/distance/rmse_m", 100, "cm", "reprojected map, RMSE, robust gauge", kMap},
    MetricFigure{"reprojected_map_rmse_vertices", "to vertices cm",
                 "/maps/reprojected/se3/point_vertex", "/rmse_m", 100, "cm",
                 "reprojected map, RMSE to vertices", kMap},
    MetricFigure{"reprojected_map_completeness", "complete %", "/maps/reprojected/se3/completeness",
                 "/rows/1/recall_percent", 1, "%", "reprojected map, completeness at 5 cm", kMap,
                 Better::kMore},
    MetricFigure{"reprojected_map_f_score", "F-score %", "/maps/reprojected/se3/completeness",
                 "/rows/1/f_score_percent", 1, "%", "reprojected map, F-score at 5 cm", kMap,
                 Better::kMore},
    MetricFigure{"reprojected_map_double_walls", "double walls %", "/maps/reprojected/se3/ghosting",
                 "/double_percent", 1, "%", "reprojected map, double walls", kMap},
    MetricFigure{"reprojected_map_identity", "identity cm", "/maps/reprojected/se3/identity",
                 "/distance/rmse_m", 100, "cm", "reprojected map, identity error", kMap},
    MetricFigure{"latency_median", nullptr, "/resources", "/latency/median_s", 1e3, "ms",
                 "latency, median"},
    MetricFigure{"latency_p95", "P95 ms", "/resources", "/latency/p95_s", 1e3, "ms", "latency, P95",
                 kMain},
    MetricFigure{"latency_p99", nullptr, "/resources", "/latency/p99_s", 1e3, "ms", "latency, P99"},
    MetricFigure{"latency_max", nullptr, "/resources", "/latency/max_s", 1e3, "ms",
                 "latency, maximum"},
    MetricFigure{"real_time_factor", nullptr, "/resources", "/real_time_factor", 1, "x",
                 "real-time factor", kNone, Better::kMore},
    MetricFigure{"own_memory_peak", "own MB", "/resources", "/own/peak_bytes", 1e-6, "MB",
                 "own memory, peak", kMain},
    MetricFigure{"process_memory_peak", nullptr, "/resources", "/rss/peak_bytes", 1e-6, "MB",
                 "process memory, peak"},
};

}  // namespace

std::span<const MetricFigure> metric_figures() { return kFigures; }

const Json* find_in(const Json& json, const std::string& path) {
  const Json::json_pointer pointer(path);
  return json.is_structured() && json.contains(pointer) ? &json.at(pointer) : nullptr;
}

std::optional<double> number_in(const Json& json, const std::string& path, double factor) {
  const Json* value = find_in(json, path);
  if (value == nullptr || !value->is_number()) return std::nullopt;
  return value->get<double>() * factor;
}

std::string text_in(const Json& json, const std::string& path) {
  const Json* value = find_in(json, path);
  return value != nullptr && value->is_string() ? value->get<std::string>() : std::string();
}

std::string refusal_of(const Json& metrics, const MetricFigure& figure) {
  std::string group = figure.group;
  while (!group.empty()) {
    std::string refused = text_in(metrics, group + "/refused");
    if (!refused.empty()) return refused;
    group.resize(group.rfind('/'));
  }
  return {};
}

std::optional<double> value_of(const Json& metrics, const MetricFigure& figure) {
  return number_in(metrics, std::string(figure.group) + figure.value, figure.factor);
}

std::string run_status(const Json& metrics) { return metrics.value("status", "ok"); }

std::string status_and_reason(const Json& metrics) {
  const std::string reason = metrics.value("reason", "");
  return run_status(metrics) + (reason.empty() ? "" : ": " + reason);
}

std::optional<double> coverage_percent(const Json& metrics, const char* trajectory) {
  return number_in(metrics, fmt::format("/{}/association/coverage", trajectory), 100.0);
}

std::optional<double> coverage_of(const Json& metrics, const MetricFigure& figure) {
  const bool live = std::string_view(figure.group).starts_with("/live");
  return coverage_percent(metrics, live ? "live" : "final");
}

}  // namespace lidarena::evaluation
