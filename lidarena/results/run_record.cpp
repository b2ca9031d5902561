// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/run_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "lidarena/dataset/json_file.hpp"
#include "lidarena/results/lost.hpp"
#include "lidarena/results/table.hpp"

namespace lidarena::results {
namespace {

namespace fs = std::filesystem;

/// The name in configs/ if the file is a YAML file.
std::string name_of(const std::string& file) {
  return fs::path(file).extension() == ".yaml" ? fs::path(file).stem().string() : file;
}

/// From what the manifest of a dataset says; it has the names of the files without their folders.
Sources sources_of(const dataset::SimulationRecord& simulation) {
  Sources sources{name_of(simulation.world), name_of(simulation.flight_source), {}};
  for (const std::string& file : simulation.sensor_sources)
    sources.sensors.push_back(name_of(file));
  return sources;
}

/// Reads the description of the LiDAR and of the simulation from the manifest of the row's dataset.
void read_dataset_manifest(RunRecord& row) {
  if (row.manifest->dataset.empty()) return;
  const auto manifest = dataset::read_dataset_manifest(row.folder / row.manifest->dataset);
  if (!manifest) return;
  row.simulation = manifest->simulation;
  for (const LidarInfo& lidar : manifest->rig.lidars) {
    if (lidar.id == row.sensor) row.lidar = lidar;
  }
}

void read_row(RunRecord& row) {
  if (!fs::exists(row.folder / "manifest.json")) {
    row.status = "missing";
    row.reason = "the run has no results yet";
    return;
  }
  row.manifest = dataset::read_run_manifest(row.folder);
  const auto take = [](std::string& known, const std::string& read) {
    if (!read.empty()) known = read;
  };
  take(row.algorithm, row.manifest->algorithm);
  take(row.preset, row.manifest->preset);
  take(row.sensor, row.manifest->sensor);
  read_dataset_manifest(row);
  if (row.manifest->status == dataset::RunStatus::kFailed) {
    row.status = "failed";
    row.reason = row.manifest->reason;
    return;
  }
  if (!fs::exists(row.folder / "metrics.json")) {
    row.status = "not scored";
    row.reason = "no metrics.json: run `lidarena evaluate`";
    return;
  }
  set_metrics(row, read_metrics(row.folder));
}

}  // namespace

std::optional<double> value_of(const RunRecord& run, const Figure& figure) {
  return run.metrics ? value_of(*run.metrics, figure) : std::nullopt;
}

void set_metrics(RunRecord& row, RunMetrics metrics) {
  row.status = metrics.status;
  row.reason = metrics.reason;
  row.metrics = std::move(metrics);
}

std::string variant_of(const RunRecord& row) { return variant_of(row.preset, row.mode); }

std::string variant_of(const std::string& preset, const std::string& mode) {
  return preset + (preset.empty() || mode.empty() ? "" : "-") + mode;
}

std::string label_of(const RunRecord& row) {
  const std::string variant = variant_of(row);
  return row.algorithm + (variant.empty() ? "" : " (" + variant + ")");
}

StudyResults read_results(const fs::path& folder) {
  StudyResults results;
  if (fs::exists(folder / "plan.json")) {
    const Json study = dataset::read_json(folder / "plan.json");
    results.title = study.at("spec").value("title", "Study");
    const std::string place = (folder / "plan.json").string();
    value_from_json(study.at("spec").value("expect", Json::array()), results.expect, place);
    value_from_json(study.value("reference", Json::array()), results.reference, place);
    const std::vector<std::string> names;
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
      row.sources = {run.at("world").get<std::string>(), run.at("flight").get<std::string>(),
                     study.at("spec").value("sensors", names)};
      read_row(row);
      results.rows.push_back(std::move(row));
    }
  } else if (dataset::is_run(folder)) {
    RunRecord row;
    row.name = folder.filename().string();
    row.folder = folder;
    read_row(row);
    row.world = fs::path(row.manifest->dataset).filename().string();
    if (row.simulation) row.sources = sources_of(*row.simulation);
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
  Table table{"", "", "", {}, {}};
  table.head = {"run",  "world", "flight", "sensor", "algorithm",        "preset",
                "mode", "seed",  "status", "reason", "coverage_percent", "ended_at_s"};
  for (const Figure& figure : figures()) table.head.push_back(column_of(figure));
  for (const RunRecord& r : results.rows) {
    std::vector<TableCell> row;
    for (const std::string& text : {r.name, r.world, r.flight, r.sensor, r.algorithm, r.preset,
                                    r.mode, std::to_string(r.seed), r.status, r.reason}) {
      row.push_back(word(text));
    }
    row.push_back(number(r.metrics ? coverage_of(*r.metrics) : std::nullopt));
    row.push_back(number(r.metrics ? r.metrics->ended_at_s : std::nullopt));
    for (const Figure& figure : figures()) row.push_back(number(value_of(r, figure)));
    table.rows.push_back(std::move(row));
  }
  return table_csv(table);
}

std::string results_text(const StudyResults& results) {
  Table table{"",
              "",
              "",
              {"world", "sensor", "algorithm", "RPE cm/m", "live RPE cm/m", "ATE cm", "map RMSE cm",
               "outliers %", "CPU %", "own MB", "status"},
              {}};
  for (const RunRecord& r : results.rows) {
    std::vector<TableCell> row{word(r.world), word(r.sensor), word(label_of(r))};
    for (const Figure* figure :
         {&kDrift, &kLiveDrift, &kAte, &kMapRmse, &kMapOutliers, &kCpuLoad, &kOwnMemory}) {
      row.push_back(number(value_of(r, *figure)));
      if (r.metrics)
        row.back().text = value_text(row.back().value, zero_bound(figure->read(*r.metrics)));
    }
    const std::string lost = lost_reason(r);
    row.push_back(word(lost.empty() ? "ok" : lost));
    table.rows.push_back(std::move(row));
  }
  return table_text(table);
}

}  // namespace lidarena::results
