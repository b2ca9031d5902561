// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/report_data.hpp"

#include <algorithm>
#include <cmath>

namespace lidarena::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kCurveValues = 400;

/// Rounded to six digits, which is more than a chart shows; null if not finite.
Json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  if (value == 0.0) return 0;
  const double scale = std::pow(10.0, 5.0 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

Json rounded(std::optional<double> value) { return value ? rounded(*value) : Json(nullptr); }

Json map_json(const std::optional<results::MapFigures>& map) {
  if (!map) return nullptr;
  Json histogram = Json::array();
  for (const double percent : map->histogram_percent) histogram.push_back(rounded(percent));
  return {{"histogram_percent", histogram},
          {"outliers_percent", rounded(map->outliers_percent)},
          {"rmse_cm", rounded(map->rmse_cm)},
          {"points", map->points}};
}

/// Calls `take` with every k-th of `count` indices, at most kCurveValues of them.
template <class Take>
void for_thinned(std::size_t count, const Take& take) {
  const std::size_t stride = count / kCurveValues + 1;
  for (std::size_t i = 0; i < count; i += stride) take(i);
}

Json error_curve(const std::optional<results::RunMetrics>& metrics) {
  if (!metrics || !metrics->final || !metrics->final->errors_over_time) return nullptr;
  const results::ErrorsOverTime& errors = metrics->final->errors_over_time->ate_se3;
  if (errors.empty()) return nullptr;
  Json curve{{"t_s", Json::array()}, {"cm", Json::array()}};
  for_thinned(errors.t_s.size(), [&](std::size_t i) {
    curve["t_s"].push_back(rounded(errors.t_s[i]));
    curve["cm"].push_back(rounded(100.0 * errors.translation_m[i]));
  });
  return curve;
}

Json memory_curve(const fs::path& folder) {
  if (!fs::exists(folder / "resources.csv")) return nullptr;
  const std::vector<dataset::ResourceRow> rows = dataset::read_resources(folder / "resources.csv");
  if (rows.empty()) return nullptr;
  Json curve{{"t_s", Json::array()},
             {"map_mb", Json::array()},
             {"scan_buffer_mb", Json::array()},
             {"backlog_mb", Json::array()}};
  for_thinned(rows.size(), [&](std::size_t i) {
    const auto megabytes = [](std::uint64_t bytes) {
      return rounded(static_cast<double>(bytes) * 1e-6);
    };
    curve["t_s"].push_back(rounded(rows[i].t_sensor_s));
    curve["map_mb"].push_back(megabytes(rows[i].map_bytes));
    curve["scan_buffer_mb"].push_back(megabytes(rows[i].scan_buffer_bytes));
    curve["backlog_mb"].push_back(megabytes(rows[i].backlog_bytes));
  });
  return curve;
}

Json run_json(const results::RunRecord& row) {
  const Json cpu_share =
      row.real_time_factor ? rounded(1.0 / *row.real_time_factor) : Json(nullptr);
  return {{"name", row.name},
          {"world", row.world},
          {"flight", row.flight},
          {"sensor", row.sensor},
          {"algorithm", row.algorithm},
          {"preset", results::variant_of(row)},
          {"seed", row.seed},
          {"status", row.status},
          {"rpe_cm_per_m", rounded(row.rpe_cm_per_m)},
          {"cpu_share", cpu_share},
          {"memory_mb", rounded(row.own_memory_mb)},
          {"map", map_json(row.own_map)},
          {"all_returns", map_json(row.reprojected_map)},
          {"error", error_curve(row.metrics)},
          {"memory", memory_curve(row.folder)}};
}

}  // namespace

Json report_data(const results::StudyResults& results) {
  Json data{{"title", results.title}, {"worlds", Json::array()}, {"runs", Json::array()}};
  for (const results::RunRecord& row : results.rows) {
    if (std::find(data["worlds"].begin(), data["worlds"].end(), row.world) ==
        data["worlds"].end()) {
      data["worlds"].push_back(row.world);
    }
    data["runs"].push_back(run_json(row));
  }
  return data;
}

}  // namespace lidarena::report
