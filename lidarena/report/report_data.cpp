// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/report_data.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <span>

#include "lidarena/dataset/run_events.hpp"
#include "lidarena/report/decision.hpp"
#include "lidarena/report/run_command.hpp"
#include "lidarena/report/summary_tables.hpp"
#include "lidarena/results/claims.hpp"
#include "lidarena/results/lost.hpp"
#include "lidarena/results/study_cells.hpp"

namespace lidarena::report {
namespace {

namespace fs = std::filesystem;
using results::RunRecord;

constexpr std::size_t kMaxRows = 400;  // of a curve
constexpr std::size_t kMinRows = 20;   // fewer show nothing: curves are left out
constexpr std::size_t kRowsOfAllCurves = 100'000;
constexpr int kDigits = 6;  // more than a page shows

/// Null if not finite.
Json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  if (value == 0.0 || value == std::floor(value)) return value;
  const double scale = std::pow(10.0, kDigits - 1.0 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}
Json rounded(std::optional<double> value) { return value ? rounded(*value) : Json(nullptr); }

/// The largest of each `stride` consecutive values.
template <class T>
Json thinned(const std::vector<T>& values, std::size_t stride) {
  Json list = Json::array();
  for (auto from = values.begin(); from != values.end();) {
    const auto left = static_cast<std::size_t>(values.end() - from);
    const auto to = from + static_cast<std::ptrdiff_t>(std::min(stride, left));
    list.push_back(rounded(static_cast<double>(*std::max_element(from, to))));
    from = to;
  }
  return list;
}

/// Columns over time with at most `rows` rows and the names of metrics.json.
template <class Columns>
Json curve(const Columns& columns, std::size_t rows) {
  if (columns.t_s.empty() || rows < kMinRows) return nullptr;
  const std::size_t stride = (columns.t_s.size() + rows - 1) / rows;
  Json json;
  Columns::visit(columns, [&](const auto& name, const auto& column, auto&&...) {
    if constexpr (requires { column.begin(); }) {
      json[name] = thinned(column, stride);
    } else {
      json[name] = column * stride;
    }
  });
  return json;
}

/// At most `rows` events of a run in the order of their times, all instants before the longest of
/// the others: [index of the kind, begin and duration in s, value]. Null if none are known.
Json events_json(const fs::path& file, std::size_t rows) {
  if (rows < kMinRows || !fs::exists(file)) return nullptr;
  std::vector<dataset::RunEvent> events = dataset::read_events(file);
  if (events.size() > rows) {
    std::ranges::stable_sort(events, {}, [](const dataset::RunEvent& event) {
      return event.duration_s > 0.0 ? 1.0 / event.duration_s : 0.0;
    });
    events.resize(rows);
    std::ranges::stable_sort(events, {}, &dataset::RunEvent::t_sensor_s);
  }
  Json list = Json::array();
  for (const dataset::RunEvent& event : events) {
    list.push_back({static_cast<int>(event.kind), rounded(event.t_sensor_s),
                    rounded(event.duration_s), rounded(event.value)});
  }
  return list;
}

/// The kinds of events in the order of their indices.
Json event_kinds_json() {
  Json list = Json::array();
  for (const dataset::RunEventInfo& info : dataset::kRunEvents)
    list.push_back({{"name", info.name}, {"label", info.label}, {"value", info.value}});
  return list;
}

Json histogram(const std::optional<results::MapMetrics>& map) {
  const results::MapInGauge* scores = results::scores_of(map);
  return scores == nullptr ? Json(nullptr) : to_json(scores->histogram);
}

std::string dataset_of(const RunRecord& row) {
  const std::string folder = row.manifest ? row.manifest->dataset : "";
  return fs::path(folder).lexically_normal().filename().string();
}

Json run_json(const RunRecord& row, const fs::path& out, std::size_t rows) {
  Json run{{"name", row.name},
           {"folder", fs::relative(row.folder, out).generic_string()},
           {"dataset", dataset_of(row)},
           {"world", row.world},
           {"flight", row.flight},
           {"sensor", row.sensor},
           {"algorithm", row.algorithm},
           {"preset", results::variant_of(row)},
           {"variation", row.variation},
           {"varied", row.varied},
           {"differs", row.differs},
           {"seed", row.seed},
           {"status", row.status},
           {"lost", results::lost_reason(row)},
           {"ended_at_s", rounded(results::ended_at_s(row))},
           {"mean_map", has_mean_map(row)},
           {"command", command_of(row)},
           {"statuses", nullptr},
           {"coverage_percent", nullptr},
           {"events", events_json(row.folder / "events.csv", rows)},
           {"values", Json::array()}};
  for (const results::Figure& figure : results::figures()) {
    run["values"].push_back(rounded(results::value_of(row, figure)));
    if (const auto bound = results::zero_bound_of(row, figure))
      run["zero_bounds"][figure.key] = *bound;
    if (!row.metrics) continue;
    const results::Reading reading = figure.read(*row.metrics);
    if (reading.is_share && reading.used < reading.total)
      run["sampled"][figure.key] = {*reading.used, *reading.total};
  }
  if (row.manifest && row.manifest->summary.scans > 0)
    run["statuses"] = row.manifest->summary.statuses;
  if (!row.metrics) return run;
  const results::RunMetrics& m = *row.metrics;
  run["coverage_percent"] = rounded(results::coverage_of(m));
  run["own_map"] = histogram(m.maps.own);
  run["all_returns"] = histogram(m.maps.reprojected);
  if (m.final && m.final->errors_over_time) {
    run["error"] = curve(m.final->errors_over_time->ate_se3, rows);
    run["drift"] = curve(m.final->errors_over_time->rpe_1m, rows);
  }
  run["resources"] = curve(m.resources.over_time, rows);
  return run;
}

Json figures_json() {
  Json list = Json::array();
  for (const results::Figure& figure : results::figures()) {
    list.push_back({{"key", figure.key},
                    {"label", figure.label},
                    {"unit", figure.unit},
                    {"more_is_better", figure.better == results::Better::kMore},
                    {"in_runs", figure.table == results::FigureTable::kMain ||
                                    figure.table == results::FigureTable::kRuns}});
  }
  return list;
}

/// What the datasets say of each sensor: its geometry, and the facts of its data sheet.
Json sensors_json(const results::StudyResults& results) {
  Json list = Json::array();
  for (const std::string& name : results::StudyCells(results, "").sensors()) {
    Json sensor{{"name", name}, {"lidar", nullptr}, {"facts", nullptr}};
    for (const RunRecord& row : results.rows) {
      if (row.sensor != name || !row.lidar) continue;
      sensor["lidar"] = {{"rows", row.lidar->rows},
                         {"columns", row.lidar->columns},
                         {"rate_hz", row.lidar->rate_hz},
                         {"max_range_m", row.lidar->max_range_m}};
      sensor["facts"] = facts_of(row);
      break;
    }
    list.push_back(std::move(sensor));
  }
  return list;
}

/// Null if not known or that of a lost run.
Json finite(std::optional<double> value) {
  return value && std::isfinite(*value) ? rounded(*value) : Json(nullptr);
}

/// What the decision compares, and all candidates in the order of decision.hpp.
Json decision_json(const results::StudyResults& results) {
  Json decision{{"criteria", Json::array()}, {"candidates", Json::array()}};
  for (const Criterion& c : criteria())
    decision["criteria"].push_back(
        {{"key", c.key}, {"label", c.label}, {"unit", c.unit}, {"weight", c.weight}});
  for (const std::string& world : results::StudyCells(results, "").worlds()) {
    for (const Candidate& c : candidates(results, world)) {
      Json values = Json::array(), cells = Json::array();
      for (const auto& value : c.values) values.push_back(finite(value));
      for (const results::TableCell& cell : c.cells) cells.push_back(table_cell_json(cell));
      decision["candidates"].push_back({{"world", world},
                                        {"sensor", c.sensor},
                                        {"algorithm", c.algorithm},
                                        {"preset", c.variant},
                                        {"runs", c.runs.size()},
                                        {"kept", c.kept},
                                        {"values", values},
                                        {"cells", cells},
                                        {"own_map", table_cell_json(c.own_map)},
                                        {"verdict", verdict(c)},
                                        {"on_front", c.on_front},
                                        {"dominated_by", c.dominated_by}});
    }
  }
  return decision;
}

const std::array kClaimed{&results::kDrift,          &results::kLiveDrift, &results::kOwnMapRmse,
                          &results::kOwnMapOutliers, &results::kMapRmse,   &results::kMapOutliers,
                          &results::kCpuLoad,        &results::kOwnMemory};

/// Which combination of sensor and method is better than which, figure by figure, as the tests of
/// results/claims.hpp say, corrected together: "cells": their names; "better": {figure: [[better,
/// worse],
/// ...]}; "words": {figure: on how many pairs that rests}.
Json claims_json(const results::StudyResults& results) {
  std::map<std::string, results::Runs> cells;
  for (const RunRecord& row : results.rows)
    if (row.variation.empty()) cells[row.sensor + "|" + results::label_of(row)].push_back(&row);
  Json claims{{"cells", Json::array()}, {"better", Json::object()}};
  for (const auto& [name, runs] : cells) claims["cells"].push_back(name);
  std::vector<results::Contest> contests;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const results::Figure* figure : kClaimed) {
    std::size_t a = 0;
    for (auto one = cells.begin(); one != cells.end(); ++one, ++a) {
      std::size_t b = a + 1;
      for (auto other = std::next(one); other != cells.end(); ++other, ++b) {
        contests.push_back({one->second, other->second, figure});
        pairs.emplace_back(a, b);
      }
    }
  }
  const std::vector<results::Claim> made = results::claims_of(contests);
  const std::size_t of_one = made.size() / kClaimed.size();
  for (std::size_t k = 0; k < kClaimed.size(); ++k) {
    Json better = Json::array();
    for (std::size_t i = k * of_one; i < (k + 1) * of_one; ++i) {
      if (made[i].a_is_better) better.push_back({pairs[i].first, pairs[i].second});
      if (made[i].b_is_better) better.push_back({pairs[i].second, pairs[i].first});
    }
    claims["better"][kClaimed[k]->key] = better;
    claims["words"][kClaimed[k]->key] =
        results::words_of(std::span(made).subspan(k * of_one, of_one));
  }
  return claims;
}

/// The machines and versions of lidarena that the runs were made with.
std::set<std::string> made_on(const results::StudyResults& results) {
  std::set<std::string> machines;
  for (const RunRecord& row : results.rows) {
    if (!row.manifest || row.manifest->made_on.empty()) continue;
    const dataset::MachineFacts& on = row.manifest->made_on;
    machines.insert(fmt::format("{}, {} cores, {} GiB, lidarena {}", on.processor, on.cores,
                                on.memory_gib, on.lidarena));
  }
  return machines;
}

}  // namespace

Json report_data(const results::StudyResults& results, const std::vector<results::Table>& tables,
                 const fs::path& out) {
  Json data{{"title", results.title},
            {"version", LIDARENA_VERSION},
            {"made_on", made_on(results)},
            {"figures", figures_json()},
            {"sensors", sensors_json(results)},
            {"decision", decision_json(results)},
            {"claims", claims_json(results)},
            {"reference", value_to_json(results.reference)},
            {"event_kinds", event_kinds_json()},
            {"tables", Json::array()},
            {"runs", Json::array()}};
  for (const results::Table& table : tables) data["tables"].push_back(results::table_json(table));
  const std::size_t rows =
      std::min(kMaxRows, kRowsOfAllCurves / std::max<std::size_t>(results.rows.size(), 1));
  for (const RunRecord& row : results.rows) data["runs"].push_back(run_json(row, out, rows));
  return data;
}

}  // namespace lidarena::report
