// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/report_data.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <span>

#include "lidarena/dataset/run_events.hpp"
#include "lidarena/report/change_tables.hpp"
#include "lidarena/report/contribution_tables.hpp"
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

/// Empty if not finite.
std::optional<double> rounded(double value) {
  if (!std::isfinite(value)) return std::nullopt;
  if (value == 0.0 || value == std::floor(value)) return value;
  const double scale = std::pow(10.0, kDigits - 1.0 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}
std::optional<double> rounded(std::optional<double> value) {
  return value ? rounded(*value) : std::nullopt;
}

/// The largest of each `stride` consecutive values, rounded.
template <class T>
std::vector<T> thinned(const std::vector<T>& values, std::size_t stride) {
  std::vector<T> list;
  for (auto from = values.begin(); from != values.end();) {
    const auto left = static_cast<std::size_t>(values.end() - from);
    const auto to = from + static_cast<std::ptrdiff_t>(std::min(stride, left));
    const T largest = *std::max_element(from, to);
    if constexpr (std::is_floating_point_v<T>) {
      list.push_back(rounded(largest).value_or(std::numeric_limits<T>::quiet_NaN()));
    } else {
      list.push_back(largest);
    }
    from = to;
  }
  return list;
}

/// Columns over time with at most `rows` rows.
template <class Columns>
std::optional<Columns> curve(Columns columns, std::size_t rows) {
  if (columns.t_s.empty() || rows < kMinRows) return std::nullopt;
  const std::size_t stride = (columns.t_s.size() + rows - 1) / rows;
  Columns::visit(columns, [&](const auto&, auto& column, auto&&...) {
    if constexpr (requires { column.begin(); }) {
      column = thinned(column, stride);
    } else {
      column *= stride;
    }
  });
  return columns;
}

/// At most `rows` events of a run in the order of their times, all instants before the longest of
/// the others: index of the kind, begin and duration in s, value. Empty if none are known.
std::optional<std::vector<std::array<double, 4>>> events_of(const fs::path& file,
                                                            std::size_t rows) {
  if (rows < kMinRows || !fs::exists(file)) return std::nullopt;
  std::vector<dataset::RunEvent> events = dataset::read_events(file);
  if (events.size() > rows) {
    std::ranges::stable_sort(events, {}, [](const dataset::RunEvent& event) {
      return event.duration_s > 0.0 ? 1.0 / event.duration_s : 0.0;
    });
    events.resize(rows);
    std::ranges::stable_sort(events, {}, &dataset::RunEvent::t_sensor_s);
  }
  std::vector<std::array<double, 4>> list;
  const auto number = [](double value) {
    return rounded(value).value_or(std::numeric_limits<double>::quiet_NaN());
  };
  for (const dataset::RunEvent& event : events)
    list.push_back({static_cast<double>(event.kind), number(event.t_sensor_s),
                    number(event.duration_s), number(event.value)});
  return list;
}

/// In the order of their indices.
std::vector<EventKind> event_kinds() {
  std::vector<EventKind> list;
  for (const dataset::RunEventInfo& info : dataset::kRunEvents)
    list.push_back({info.name, info.label, info.value});
  return list;
}

std::optional<results::DistanceHistogram> histogram(const std::optional<results::MapMetrics>& map) {
  const results::MapScores* scores = results::scores_of(map);
  if (scores == nullptr) return std::nullopt;
  return scores->histogram;
}

std::string dataset_of(const RunRecord& row) {
  const std::string folder = row.manifest ? row.manifest->dataset : "";
  return fs::path(folder).lexically_normal().filename().string();
}

void set_figures(const RunRecord& row, PageRun& run) {
  for (const results::Figure& figure : results::figures()) {
    run.values.push_back(rounded(results::value_of(row, figure)));
    if (const auto bound = results::zero_bound_of(row, figure))
      run.zero_bounds[figure.key] = *bound;
    if (!row.metrics) continue;
    const results::Reading reading = figure.read(*row.metrics);
    if (reading.is_share && reading.used < reading.total)
      run.sampled[figure.key] = {*reading.used, *reading.total};
  }
}

void set_curves(const results::RunMetrics& metrics, std::size_t rows, PageRun& run) {
  run.coverage_percent = rounded(results::coverage_of(metrics));
  run.own_map = histogram(metrics.maps.own);
  run.all_returns = histogram(metrics.maps.reprojected);
  if (metrics.final && metrics.final->errors_over_time) {
    run.error = curve(metrics.final->errors_over_time->ate_se3, rows);
    run.drift = curve(metrics.final->errors_over_time->rpe_1m, rows);
  }
  run.resources = curve(metrics.resources.over_time, rows);
}

PageRun page_run(const RunRecord& row, const fs::path& out, std::size_t rows) {
  PageRun run{.name = row.name,
              .folder = fs::relative(row.folder, out).generic_string(),
              .dataset = dataset_of(row),
              .world = row.world,
              .flight = row.flight,
              .sensor = row.sensor,
              .algorithm = row.algorithm,
              .preset = results::variant_of(row),
              .variation = row.variation,
              .varied = row.varied,
              .differs = row.differs,
              .seed = row.seed,
              .status = row.status,
              .lost = results::lost_reason(row),
              .command = command_of(row),
              .ended_at_s = rounded(results::ended_at_s(row)),
              .mean_map = has_mean_map(row),
              .events = events_of(row.folder / "events.csv", rows)};
  set_figures(row, run);
  if (row.manifest && row.manifest->summary.scans > 0)
    run.statuses = row.manifest->summary.statuses;
  if (row.metrics) set_curves(*row.metrics, rows, run);
  return run;
}

std::vector<FigureInfo> figure_infos() {
  std::vector<FigureInfo> list;
  for (const results::Figure& figure : results::figures())
    list.push_back({.key = figure.key,
                    .label = figure.label,
                    .unit = figure.unit,
                    .more_is_better = figure.better == results::Better::kMore,
                    .in_runs = figure.table == results::FigureTable::kMain ||
                               figure.table == results::FigureTable::kRuns});
  return list;
}

/// The sensors with their geometry, as the datasets have it.
std::vector<PageSensor> sensors_of(const results::StudyResults& results) {
  std::vector<PageSensor> list;
  for (const std::string& name : results::StudyCells(results, "").sensors()) {
    PageSensor sensor{name, std::nullopt};
    for (const RunRecord& row : results.rows) {
      if (row.sensor != name || !row.lidar) continue;
      sensor.lidar = {row.lidar->rows, row.lidar->columns, row.lidar->rate_hz,
                      row.lidar->max_range_m};
      break;
    }
    list.push_back(std::move(sensor));
  }
  return list;
}

PageCandidate page_candidate(const Candidate& candidate, const std::string& world) {
  PageCandidate shown{.world = world,
                      .sensor = candidate.sensor,
                      .algorithm = candidate.algorithm,
                      .preset = candidate.variant,
                      .runs = candidate.runs.size(),
                      .kept = candidate.kept,
                      .cells = candidate.cells,
                      .own_map = candidate.own_map,
                      .verdict = verdict(candidate),
                      .on_front = candidate.on_front,
                      .dominated_by = candidate.dominated_by};
  for (const auto& value : candidate.values) shown.values.push_back(rounded(value));
  return shown;
}

/// What the decision compares, and all candidates in the order of decision.hpp.
PageDecision decision_of(const results::StudyResults& results) {
  PageDecision decision;
  for (const Criterion& c : criteria())
    decision.criteria.push_back({c.key, c.label, c.unit, c.weight});
  for (const std::string& world : results::StudyCells(results, "").worlds())
    for (const Candidate& candidate : candidates(results, world))
      decision.candidates.push_back(page_candidate(candidate, world));
  return decision;
}

const std::array kClaimed{&results::kDrift,          &results::kLiveDrift, &results::kOwnMapRmse,
                          &results::kOwnMapOutliers, &results::kMapRmse,   &results::kMapOutliers,
                          &results::kCpuLoad,        &results::kOwnMemory};

/// Which combination of sensor and method is better than which, figure by figure, as the tests of
/// results/claims.hpp say, corrected together.
CellClaims claims_of(const results::StudyResults& results) {
  std::map<std::string, results::Runs> cells;
  for (const RunRecord& row : results.rows)
    if (row.variation.empty()) cells[row.sensor + "|" + results::label_of(row)].push_back(&row);
  CellClaims claims;
  for (const auto& [name, runs] : cells) claims.cells.push_back(name);
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
    auto& better = claims.better[kClaimed[k]->key];
    for (std::size_t i = k * of_one; i < (k + 1) * of_one; ++i) {
      if (made[i].a_is_better) better.push_back({pairs[i].first, pairs[i].second});
      if (made[i].b_is_better) better.push_back({pairs[i].second, pairs[i].first});
    }
    claims.words[kClaimed[k]->key] = results::words_of(std::span(made).subspan(k * of_one, of_one));
  }
  return claims;
}

std::vector<PageContributions> page_contributions(const results::StudyResults& results) {
  std::vector<PageContributions> list;
  for (const results::Contributions& c : shown_contributions(results)) {
    if (!c.missing.empty()) continue;
    PageContributions page{.world = c.world,
                           .sensor = c.sensor,
                           .method = c.method,
                           .figure = c.figure->key,
                           .flights = c.flights,
                           .base = c.base,
                           .all = c.all,
                           .parts = {}};
    for (const results::Contribution& part : c.parts) {
      PageContribution shown{part.name, part.value, {}, {}};
      if (part.value_95) {
        shown.low = part.value_95->low;
        shown.high = part.value_95->high;
      }
      page.parts.push_back(shown);
    }
    list.push_back(std::move(page));
  }
  return list;
}

std::vector<PageChange> page_changes(const results::StudyResults& results) {
  std::vector<PageChange> list;
  for (const results::Change& c : shown_changes(results)) {
    if (!std::isfinite(c.paired.median_difference)) continue;  // most runs are lost
    PageChange page{.world = c.world,
                    .sensor = c.sensor,
                    .method = c.method,
                    .figure = c.figure->key,
                    .variation = c.variation,
                    .flights = c.paired.pairs,
                    .value = c.paired.median_difference,
                    .low = {},
                    .high = {}};
    const auto& interval = c.paired.difference_95;
    if (interval && std::isfinite(interval->low) && std::isfinite(interval->high)) {
      page.low = interval->low;
      page.high = interval->high;
    }
    list.push_back(std::move(page));
  }
  return list;
}

/// The machines and versions of lidarena that the runs were made with.
std::vector<std::string> made_on(const results::StudyResults& results) {
  std::set<std::string> machines;
  for (const RunRecord& row : results.rows) {
    if (!row.manifest || row.manifest->made_on.empty()) continue;
    const dataset::MachineFacts& on = row.manifest->made_on;
    machines.insert(fmt::format("{}, {} cores, {} GiB, lidarena {}", on.processor, on.cores,
                                on.memory_gib, on.lidarena));
  }
  return {machines.begin(), machines.end()};
}

}  // namespace

ReportData report_data(const results::StudyResults& results,
                       const std::vector<results::Table>& tables, const fs::path& out) {
  ReportData data{.title = results.title,
                  .version = LIDARENA_VERSION,
                  .made_on = made_on(results),
                  .figures = figure_infos(),
                  .sensors = sensors_of(results),
                  .decision = decision_of(results),
                  .claims = claims_of(results),
                  .contributions = page_contributions(results),
                  .changes = page_changes(results),
                  .reference = results.reference,
                  .event_kinds = event_kinds(),
                  .tables = tables,
                  .runs = {},
                  .without_result = {}};
  const std::size_t rows =
      std::min(kMaxRows, kRowsOfAllCurves / std::max<std::size_t>(results.rows.size(), 1));
  for (const RunRecord& row : results.rows) data.runs.push_back(page_run(row, out, rows));
  for (const RunRecord& row : results.without_result)
    data.without_result.push_back({row.name, row.status, row.reason});
  return data;
}

}  // namespace lidarena::report
