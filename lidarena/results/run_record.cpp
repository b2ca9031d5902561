// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/run_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

/// The key that a study gave the run; empty if it is not of a study.
std::string key_of(const fs::path& run) {
  if (!fs::exists(run / "request.json")) return {};
  const Json request = dataset::read_json(run / "request.json");
  return request.value("result", Json::object()).value("key", "");
}

void read_row(RunRecord& row) {
  if (!fs::exists(row.folder / "manifest.json")) {
    row.status = kMissing;
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
    row.reason = row.manifest->reason;
    row.status = row.reason.starts_with(kFlightFailed) ? kNotFlown : "failed";
    return;
  }
  row.key = key_of(row.folder);
  if (fs::exists(row.folder / kKnownRow)) {
    const std::string place = (row.folder / kKnownRow).string();
    read_json(dataset::read_json(place), row.known.emplace(), place);
    row.status = row.known->status;
    row.reason = row.known->reason;
    return;
  }
  if (!fs::exists(row.folder / "metrics.json")) {
    row.status = "not scored";
    row.reason = "no metrics.json: run `lidarena evaluate`";
    return;
  }
  set_metrics(row, read_metrics(row.folder));
}

/// The sensors that fly with a planned run.
std::vector<std::string> sensors_beside(const Json& study, const Json& run) {
  std::vector<std::string> sensors;
  for (const Json& other : study.at("runs")) {
    const auto sensor = other.at("sensor").get<std::string>();
    if (other.value("dataset", "") == run.value("dataset", "") &&
        std::ranges::find(sensors, sensor) == sensors.end())
      sensors.push_back(sensor);
  }
  return sensors;
}

/// With all digits, so that a row that is read again has the same figures.
TableCell exact(std::optional<double> value) {
  return word(value && std::isfinite(*value) ? fmt::format("{}", *value) : "");
}

/// The bounds of all shares of zero, by the figure's key.
std::map<std::string, double> zero_bounds_of(const RunRecord& run) {
  std::map<std::string, double> bounds;
  for (const Figure& figure : figures())
    if (const auto bound = zero_bound_of(run, figure)) bounds[figure.key] = *bound;
  return bounds;
}

}  // namespace

std::optional<double> value_of(const RunRecord& run, const Figure& figure) {
  if (run.metrics) return value_of(*run.metrics, figure);
  if (!run.known) return std::nullopt;
  const auto value = run.known->figures.find(column_of(figure));
  return value == run.known->figures.end() ? std::nullopt : std::optional(value->second);
}

std::optional<double> zero_bound_of(const RunRecord& run, const Figure& figure) {
  if (run.metrics) return zero_bound(figure.read(*run.metrics));
  if (!run.known) return std::nullopt;
  const auto bound = run.known->zero_bounds.find(figure.key);
  return bound == run.known->zero_bounds.end() ? std::nullopt : std::optional(bound->second);
}

std::optional<double> ended_at_s(const RunRecord& run) {
  if (run.metrics) return run.metrics->ended_at_s;
  return run.known ? run.known->ended_at_s : std::nullopt;
}

std::optional<double> coverage_of(const RunRecord& run) {
  if (run.metrics) return coverage_of(*run.metrics);
  return run.known ? run.known->coverage_percent : std::nullopt;
}

void set_metrics(RunRecord& row, RunMetrics metrics) {
  row.status = metrics.status;
  row.reason = metrics.reason;
  row.metrics = std::move(metrics);
}

std::vector<std::string> varied_keys(const std::vector<RunRecord>& runs) {
  std::vector<std::string> keys;
  for (const RunRecord& run : runs) {
    for (const auto& [key, value] : run.varied.items())
      if (std::ranges::find(keys, key) == keys.end()) keys.push_back(key);
  }
  return keys;
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
      row.variation = run.value("variation", "");
      row.varied = run.value("varied", Json::object());
      row.differs = run.value("differs", names);
      row.sources = {run.at("world").get<std::string>(), run.at("flight").get<std::string>(),
                     sensors_beside(study, run)};
      read_row(row);
      if (const std::string as = run.value("as", ""); !as.empty()) row.algorithm = as;
      const bool has_result = row.status != kMissing && row.status != kNotFlown;
      (has_result ? results.rows : results.without_result).push_back(std::move(row));
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
                 !known.metrics && row.metrics) {
        known = std::move(row);
      }
    }
  }
  for (const char* status : {kNotFlown, kMissing}) {
    for (StudyResults& part : parts) {
      for (RunRecord& row : part.without_result)
        if (row.status == status && places.emplace(row.name, 0).second)
          all.without_result.push_back(std::move(row));
    }
  }
  return all;
}

std::string results_csv(const StudyResults& results) {
  Table table{"", "", "", {}, {}};
  table.head = {"run",  "world", "flight", "sensor", "algorithm",        "preset",
                "mode", "seed",  "status", "reason", "coverage_percent", "ended_at_s"};
  for (const Figure& figure : figures()) table.head.push_back(column_of(figure));
  const std::vector<std::string> varied = varied_keys(results.rows);
  const bool varies = std::ranges::any_of(
      results.rows, [](const RunRecord& run) { return !run.variation.empty(); });
  if (varies) table.head.emplace_back("variation");
  table.head.insert(table.head.end(), varied.begin(), varied.end());
  const bool has_keys =
      std::ranges::any_of(results.rows, [](const RunRecord& run) { return !run.key.empty(); });
  if (has_keys) table.head.insert(table.head.end(), {"own_map", "zero_bounds", "key"});
  const auto add = [&](const RunRecord& r) {
    std::vector<TableCell> row;
    for (const std::string& text : {r.name, r.world, r.flight, r.sensor, r.algorithm, r.preset,
                                    r.mode, std::to_string(r.seed), r.status, r.reason}) {
      row.push_back(word(text));
    }
    row.push_back(exact(coverage_of(r)));
    row.push_back(exact(ended_at_s(r)));
    for (const Figure& figure : figures()) row.push_back(exact(value_of(r, figure)));
    if (varies) row.push_back(word(r.variation));
    for (const std::string& key : varied) {
      const Json value = r.varied.value(key, Json());
      row.push_back(word(value.is_null()     ? ""
                         : value.is_string() ? value.get<std::string>()
                                             : value.dump()));
    }
    if (has_keys) {
      row.push_back(word(r.manifest ? value_to_json(r.manifest->own_map).get<std::string>() : ""));
      row.push_back(word(bounds_text(zero_bounds_of(r))));
      row.push_back(word(r.key));
    }
    table.rows.push_back(std::move(row));
  };
  std::ranges::for_each(results.rows, add);
  std::ranges::for_each(results.without_result, add);
  return table_csv(table);
}

std::string results_text(const StudyResults& results) {
  Table table{"",
              "",
              "",
              {"world", "sensor", "algorithm", "RPE cm/m", "live RPE cm/m", "ATE cm", "map RMSE cm",
               "outliers %", "CPU %", "own MB", "status"},
              {}};
  const auto add = [&](const RunRecord& r) {
    const std::string variation = r.variation.empty() ? "" : ", " + r.variation;
    std::vector<TableCell> row{word(r.world), word(r.sensor), word(label_of(r) + variation)};
    for (const Figure* figure :
         {&kDrift, &kLiveDrift, &kAte, &kMapRmse, &kMapOutliers, &kCpuLoad, &kOwnMemory}) {
      row.push_back(number(value_of(r, *figure)));
      if (row.back().value)
        row.back().text = value_text(row.back().value, zero_bound_of(r, *figure));
    }
    const std::string lost = lost_reason(r);
    row.push_back(word(lost.empty() ? "ok" : lost));
    table.rows.push_back(std::move(row));
  };
  std::ranges::for_each(results.rows, add);
  std::ranges::for_each(results.without_result, add);
  return table_text(table);
}

}  // namespace lidarena::results
