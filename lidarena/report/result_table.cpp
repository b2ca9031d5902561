// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/result_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <numbers>

#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/run_files.hpp"

namespace lidarena::report {
namespace {

namespace fs = std::filesystem;

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// The number at `path` of `json`, times `factor`; empty if there is none.
std::optional<double> number(const Json& json, const std::string& path, double factor = 1.0) {
  const Json::json_pointer pointer(path);
  if (!json.is_structured() || !json.contains(pointer) || !json.at(pointer).is_number()) return {};
  return json.at(pointer).get<double>() * factor;
}

std::optional<MapFigures> map_figures(const Json& metrics, const std::string& map) {
  for (const char* gauge : {"se3", "first_pose"}) {
    const std::string base = fmt::format("/maps/{}/{}", map, gauge);
    const auto rmse = number(metrics, base + "/distance/rmse_m", 100.0);
    if (!rmse) continue;
    const Json& entry = metrics.at(Json::json_pointer(base));
    MapFigures figures;
    figures.points = entry.at("points").get<std::size_t>();
    figures.rmse_cm = *rmse;
    figures.rmse_inliers_cm = number(entry, "/rmse_inliers_m", 100.0).value_or(0.0);
    figures.median_cm = number(entry, "/distance/median_m", 100.0).value_or(0.0);
    figures.p95_cm = number(entry, "/distance/p95_m", 100.0).value_or(0.0);
    figures.outliers_percent = number(entry, "/outliers_percent").value_or(0.0);
    for (const Json& count : entry.at("histogram").at("counts")) {
      figures.histogram_percent.push_back(100.0 * count.get<double>() /
                                          static_cast<double>(figures.points));
    }
    return figures;
  }
  return std::nullopt;
}

void summarize_resources(const fs::path& folder, ResultRow& row) {
  const std::vector<dataset::ResourceRow> rows = dataset::read_resources(folder / "resources.csv");
  std::vector<double> latency_ms;
  double process_mb = 0.0;
  double own_mb = 0.0;
  for (const dataset::ResourceRow& r : rows) {
    latency_ms.push_back(1e3 * r.latency_s);
    process_mb = std::max(process_mb, static_cast<double>(r.rss_bytes) / 1e6);
    own_mb = std::max(own_mb, own_memory_mb(r));
  }
  if (latency_ms.empty()) return;
  row.own_memory_mb = own_mb;
  row.process_memory_mb = process_mb;
  const auto p95 = latency_ms.begin() + static_cast<std::ptrdiff_t>(latency_ms.size() * 95 / 100);
  std::nth_element(latency_ms.begin(), p95, latency_ms.end());
  row.latency_p95_ms = *p95;
}

/// Reads the description of the LiDAR and of the simulation from the manifest of the row's dataset.
void read_dataset_manifest(ResultRow& row) {
  const fs::path file = row.folder / row.manifest.value("dataset", "") / "manifest.json";
  if (!row.manifest.contains("dataset") || !fs::exists(file)) return;
  const Json manifest = dataset::read_json(file);
  row.simulation = manifest.value("simulation", Json());
  const Json::json_pointer lidars("/rig/lidars");
  if (!manifest.contains(lidars)) return;
  for (const Json& lidar : manifest.at(lidars)) {
    if (lidar.value("id", "") == row.sensor) row.lidar = lidar;
  }
}

void read_row(ResultRow& row) {
  if (!fs::exists(row.folder / "manifest.json")) {
    row.status = "missing";
    row.reason = "the run has left no files";
    return;
  }
  row.manifest = dataset::read_json(row.folder / "manifest.json");
  row.algorithm = row.manifest.value("algorithm", row.algorithm);
  row.preset = row.manifest.value("preset", row.preset);
  row.sensor = row.manifest.value("sensor", row.sensor);
  read_dataset_manifest(row);
  if (row.manifest.contains("failed")) {
    row.status = "failed";
    row.reason = row.manifest.at("failed").get<std::string>();
    return;
  }
  const auto sensor_s = number(row.manifest, "/summary/sensor_seconds");
  const auto compute_s = number(row.manifest, "/summary/compute_seconds");
  if (sensor_s && compute_s && *compute_s > 0) row.real_time_factor = *sensor_s / *compute_s;
  if (fs::exists(row.folder / "resources.csv")) summarize_resources(row.folder, row);
  if (!fs::exists(row.folder / "metrics.json")) {
    row.status = "not scored";
    row.reason = "no metrics.json: run `lidarena evaluate`";
    return;
  }
  row.metrics = dataset::read_json(row.folder / "metrics.json");
  row.status = row.metrics.value("status", "ok");
  row.reason = row.metrics.value("reason", "");
  row.rpe_cm_per_m = number(row.metrics, "/final/rpe/1m_at_poses/translation/rmse_m", 100.0);
  row.rpe_deg_per_m = number(row.metrics, "/final/rpe/1m_at_poses/rotation/rmse_rad", kDegrees);
  row.ate_cm = number(row.metrics, "/final/ate/se3/translation/rmse_m", 100.0);
  row.coverage_percent = number(row.metrics, "/final/association/coverage", 100.0);
  row.own_map = map_figures(row.metrics, "own");
  row.reprojected_map = map_figures(row.metrics, "reprojected");
}

std::string cell(const std::optional<double>& value, const char* format) {
  return value ? fmt::format(fmt::runtime(format), *value) : std::string();
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

std::optional<double> figure(const std::optional<MapFigures>& map, double MapFigures::*member) {
  return map ? std::optional<double>((*map).*member) : std::nullopt;
}

}  // namespace

std::string variant_of(const ResultRow& row) { return variant_of(row.preset, row.mode); }

std::string variant_of(const std::string& preset, const std::string& mode) {
  return preset + (preset.empty() || mode.empty() ? "" : "-") + mode;
}

std::string label_of(const ResultRow& row) {
  const std::string variant = variant_of(row);
  return row.algorithm + (variant.empty() ? "" : " (" + variant + ")");
}

double own_memory_mb(const dataset::ResourceRow& row) {
  return static_cast<double>(row.map_bytes + row.scan_buffer_bytes + row.backlog_bytes) / 1e6;
}

Results read_results(const fs::path& folder) {
  Results results;
  if (fs::exists(folder / "study.json")) {
    const Json study = dataset::read_json(folder / "study.json");
    results.title = study.at("spec").value("title", "Study");
    for (const Json& run : study.at("runs")) {
      ResultRow row;
      row.name = run.at("name").get<std::string>();
      row.folder = folder / "runs" / row.name;
      row.world = fs::path(run.at("world").get<std::string>()).stem().string();
      row.flight = fs::path(run.at("flight").get<std::string>()).stem().string();
      row.sensor = run.at("sensor").get<std::string>();
      row.algorithm = run.at("algorithm").get<std::string>();
      row.preset = run.at("preset").get<std::string>();
      row.seed = run.at("seed").get<std::uint64_t>();
      if (run.contains("mode") && run.at("mode").is_string()) row.mode = run.at("mode");
      read_row(row);
      results.rows.push_back(std::move(row));
    }
  } else if (fs::exists(folder / "manifest.json") &&
             dataset::read_json(folder / "manifest.json").value("kind", "") == "run") {
    ResultRow row;
    row.name = folder.filename().string();
    row.folder = folder;
    read_row(row);
    row.world = fs::path(row.manifest.value("dataset", "")).filename().string();
    results.title = row.name;
    results.rows.push_back(std::move(row));
  } else {
    throw InputError(folder.string(), "contains no results",
                     "give the folder of a study or of a run");
  }
  return results;
}

Results merged(std::vector<Results> parts) {
  Results all;
  std::map<std::string, std::size_t> places;
  for (Results& part : parts) {
    if (all.title.empty()) all.title = part.title;
    for (ResultRow& row : part.rows) {
      const auto [place, is_new] = places.emplace(row.name, all.rows.size());
      if (is_new) {
        all.rows.push_back(std::move(row));
      } else if (all.rows[place->second].metrics.is_null() && !row.metrics.is_null()) {
        all.rows[place->second] = std::move(row);
      }
    }
  }
  return all;
}

std::string results_csv(const Results& results) {
  std::string csv =
      "run,world,flight,sensor,algorithm,preset,mode,seed,status,reason,rpe_cm_per_m,rpe_deg_per_m,"
      "ate_se3_cm,coverage_percent,own_map_points,own_map_rmse_cm,own_map_rmse_inliers_cm,"
      "own_map_outliers_percent,reprojected_points,reprojected_rmse_cm,"
      "reprojected_rmse_inliers_cm,reprojected_outliers_percent,real_time_factor,latency_p95_ms,"
      "own_memory_mb,process_memory_mb\n";
  const auto map_cells = [](const std::optional<MapFigures>& map) {
    return fmt::format("{},{},{},{}", map ? std::to_string(map->points) : "",
                       cell(figure(map, &MapFigures::rmse_cm), "{:.4f}"),
                       cell(figure(map, &MapFigures::rmse_inliers_cm), "{:.4f}"),
                       cell(figure(map, &MapFigures::outliers_percent), "{:.6g}"));
  };
  for (const ResultRow& r : results.rows) {
    csv += fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", quoted(r.name),
        quoted(r.world), quoted(r.flight), quoted(r.sensor), quoted(r.algorithm), quoted(r.preset),
        r.mode, r.seed, quoted(r.status), quoted(r.reason), cell(r.rpe_cm_per_m, "{:.5f}"),
        cell(r.rpe_deg_per_m, "{:.5f}"), cell(r.ate_cm, "{:.4f}"),
        cell(r.coverage_percent, "{:.3f}"), map_cells(r.own_map), map_cells(r.reprojected_map),
        cell(r.real_time_factor, "{:.2f}"), cell(r.latency_p95_ms, "{:.2f}"),
        cell(r.own_memory_mb, "{:.2f}"), cell(r.process_memory_mb, "{:.1f}"));
  }
  return csv;
}

std::string results_text(const Results& results) {
  constexpr std::size_t kColumns = 10, kNames = 3;  // names are aligned left, figures right
  using Line = std::array<std::string, kColumns>;
  std::vector<Line> lines{{"world", "sensor", "algorithm", "RPE cm/m", "ATE cm", "map RMSE cm",
                           "outliers %", "x real", "own MB", "status"}};
  for (const ResultRow& r : results.rows) {
    const auto shown = [](const std::optional<double>& v, const char* format) {
      return v ? cell(v, format) : std::string("-");
    };
    lines.push_back({r.world, r.sensor, label_of(r), shown(r.rpe_cm_per_m, "{:.2f}"),
                     shown(r.ate_cm, "{:.2f}"),
                     shown(figure(r.reprojected_map, &MapFigures::rmse_cm), "{:.2f}"),
                     shown(figure(r.reprojected_map, &MapFigures::outliers_percent), "{:.3g}"),
                     shown(r.real_time_factor, "{:.1f}"), shown(r.own_memory_mb, "{:.1f}"),
                     r.reason.empty() ? r.status : r.status + ": " + r.reason});
  }
  std::array<std::size_t, kColumns> widths{};
  for (const Line& line : lines) {
    for (std::size_t c = 0; c < kColumns; ++c) widths[c] = std::max(widths[c], line[c].size());
  }
  std::string text;
  for (const Line& line : lines) {
    for (std::size_t c = 0; c + 1 < kColumns; ++c) {
      text += c < kNames ? fmt::format("{:<{}}  ", line[c], widths[c])
                         : fmt::format("{:>{}}  ", line[c], widths[c]);
    }
    text += line.back() + "\n";
  }
  return text;
}

}  // namespace lidarena::report
