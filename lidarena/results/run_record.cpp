// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/run_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <numbers>

#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/run_files.hpp"

namespace lidarena::results {
namespace {

namespace fs = std::filesystem;

constexpr double kDegrees = 180.0 / std::numbers::pi;

std::optional<MapFigures> figures_of(const std::optional<MapMetrics>& map) {
  const MapInGauge* scores = scores_of(map);
  if (scores == nullptr) return std::nullopt;
  MapFigures figures;
  figures.points = scores->points;
  figures.rmse_cm = 100.0 * scores->distance_m.rmse;
  figures.rmse_inliers_cm = 100.0 * scores->rmse_inliers_m.value_or(0.0);
  figures.outliers_percent = scores->outliers_percent.value_or(0.0);
  for (const std::uint64_t count : scores->histogram.counts) {
    figures.histogram_percent.push_back(100.0 * static_cast<double>(count) /
                                        static_cast<double>(figures.points));
  }
  return figures;
}

/// Reads the description of the LiDAR and of the simulation from the manifest of the row's dataset.
void read_dataset_manifest(RunRecord& row) {
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

void read_row(RunRecord& row) {
  if (!fs::exists(row.folder / "manifest.json")) {
    row.status = "missing";
    row.reason = "the run has no results yet";
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
  if (!fs::exists(row.folder / "metrics.json")) {
    row.status = "not scored";
    row.reason = "no metrics.json: run `lidarena evaluate`";
    return;
  }
  set_metrics(row, read_metrics(row.folder));
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

std::optional<double> value_of(const RunRecord& run, const Figure& figure) {
  return run.metrics ? value_of(*run.metrics, figure) : std::nullopt;
}

void set_metrics(RunRecord& row, RunMetrics metrics) {
  const RunMetrics& m = row.metrics.emplace(std::move(metrics));
  row.status = m.status;
  row.reason = m.reason;
  if (m.final) {
    row.coverage_percent = 100.0 * m.final->association.coverage;
    if (m.final->rpe && !m.final->rpe->at_poses_1m.translation.empty()) {
      row.rpe_cm_per_m = 100.0 * m.final->rpe->at_poses_1m.translation.rmse;
      row.rpe_deg_per_m = kDegrees * m.final->rpe->at_poses_1m.rotation.rmse;
    }
    if (m.final->ate && !m.final->ate->se3.translation.empty()) {
      row.ate_cm = 100.0 * m.final->ate->se3.translation.rmse;
    }
  }
  row.own_map = figures_of(m.maps.own);
  row.reprojected_map = figures_of(m.maps.reprojected);
  if (m.resources.empty()) return;
  row.real_time_factor = m.resources.real_time_factor;
  row.latency_p95_ms = 1e3 * m.resources.latency.p95;
  row.own_memory_mb = 1e-6 * m.resources.own.peak_bytes;
  row.process_memory_mb = 1e-6 * m.resources.rss.peak_bytes;
}

std::string variant_of(const RunRecord& row) { return variant_of(row.preset, row.mode); }

std::string variant_of(const std::string& preset, const std::string& mode) {
  return preset + (preset.empty() || mode.empty() ? "" : "-") + mode;
}

std::string label_of(const RunRecord& row) {
  const std::string variant = variant_of(row);
  return row.algorithm + (variant.empty() ? "" : " (" + variant + ")");
}

double own_memory_mb(const dataset::ResourceRow& row) {
  return static_cast<double>(row.map_bytes + row.scan_buffer_bytes + row.backlog_bytes) / 1e6;
}

StudyResults read_results(const fs::path& folder) {
  StudyResults results;
  if (fs::exists(folder / "plan.json")) {
    const Json study = dataset::read_json(folder / "plan.json");
    results.title = study.at("spec").value("title", "Study");
    const std::string place = (folder / "plan.json").string();
    value_from_json(study.at("spec").value("expect", Json::array()), results.expect, place);
    value_from_json(study.value("reference", Json::array()), results.reference, place);
    for (const Json& run : study.at("runs")) {
      RunRecord row;
      row.name = run.at("name").get<std::string>();
      row.folder = folder / "runs" / row.name;
      row.world = fs::path(run.at("world").get<std::string>()).stem().string();
      row.flight = fs::path(run.at("flight").get<std::string>()).stem().string();
      row.sensor = fs::path(run.at("sensor").get<std::string>()).stem().string();
      row.algorithm = run.at("algorithm").get<std::string>();
      row.preset = run.at("preset").get<std::string>();
      row.seed = run.at("seed").get<std::uint64_t>();
      if (run.contains("mode") && run.at("mode").is_string()) row.mode = run.at("mode");
      read_row(row);
      results.rows.push_back(std::move(row));
    }
  } else if (fs::exists(folder / "manifest.json") &&
             dataset::read_json(folder / "manifest.json").value("kind", "") == "run") {
    RunRecord row;
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

StudyResults merged(std::vector<StudyResults> parts) {
  StudyResults all;
  std::map<std::string, std::size_t> places;
  for (StudyResults& part : parts) {
    if (all.title.empty()) all.title = part.title;
    if (all.expect.empty()) all.expect = std::move(part.expect);
    if (all.reference.empty()) all.reference = std::move(part.reference);
    for (RunRecord& row : part.rows) {
      const auto [place, is_new] = places.emplace(row.name, all.rows.size());
      if (is_new) {
        all.rows.push_back(std::move(row));
      } else if (RunRecord& known = all.rows[place->second];
                 (!known.metrics && row.metrics) || known.status == "missing") {
        known = std::move(row);
      }
    }
  }
  return all;
}

std::string results_csv(const StudyResults& results) {
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
  for (const RunRecord& r : results.rows) {
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

std::string results_text(const StudyResults& results) {
  constexpr std::size_t kColumns = 10, kNames = 3;  // names are aligned left, figures right
  using Row = std::array<std::string, kColumns>;
  std::vector<Row> lines{{"world", "sensor", "algorithm", "RPE cm/m", "ATE cm", "map RMSE cm",
                          "outliers %", "x real", "own MB", "status"}};
  for (const RunRecord& r : results.rows) {
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
  for (const Row& line : lines) {
    for (std::size_t c = 0; c < kColumns; ++c) widths[c] = std::max(widths[c], line[c].size());
  }
  std::string text;
  for (const Row& line : lines) {
    for (std::size_t c = 0; c + 1 < kColumns; ++c) {
      text += c < kNames ? fmt::format("{:<{}}  ", line[c], widths[c])
                         : fmt::format("{:>{}}  ", line[c], widths[c]);
    }
    text += line.back() + "\n";
  }
  return text;
}

}  // namespace lidarena::results
