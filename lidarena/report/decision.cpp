// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/decision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <tuple>

#include "lidarena/base/number.hpp"
#include "lidarena/report/summary_tables.hpp"
#include "lidarena/results/lost.hpp"
#include "lidarena/results/study_cells.hpp"

namespace lidarena::report {
namespace {

using results::Claim;
using results::RunRecord;
using results::TableCell;

const std::array kCriteria{Criterion{"drift", "drift", "cm per m", 3.0, &results::kDrift},
                           Criterion{"map", "map RMSE", "cm", 3.0, &results::kMapRmse},
                           Criterion{"cpu", "CPU", "% of a core", 1.0, &results::kCpuLoad},
                           Criterion{"weight", "weight", "kg", 1.0, nullptr},
                           Criterion{"power", "power", "W", 1.0, nullptr},
                           Criterion{"price", "price", "", 1.0, nullptr}};
constexpr double kLateShare = 0.05;  // of scans, up to which a run is in real time

/// What the sensor's file says; a price by the number in it ("below 1000 EUR": 1000).
TableCell fact_of(const RunRecord& run, const std::string& key) {
  const Json facts = facts_of(run);
  if (!facts.is_object()) return {};
  if (key == "weight") return results::number(facts.value("weight_kg", 0.0));
  if (key == "power") return results::number(facts.value("power_max_w", 0.0));
  TableCell cell = results::word(facts.value("price", ""));
  const std::size_t begin = cell.text.find_first_of("0123456789");
  if (begin == std::string::npos) return cell;
  const std::size_t end = cell.text.find_first_not_of("0123456789", begin);
  cell.value = parse_number(cell.text.substr(begin, end - begin));
  return cell;
}

/// Whether one core keeps up, by the CPU time; in a paced run by the clock.
std::optional<bool> is_real_time(const RunRecord& run) {
  if (!run.metrics || run.metrics->resources.empty()) return std::nullopt;
  const results::ResourceMetrics& used = run.metrics->resources;
  if (run.manifest && run.manifest->paced) return used.late_scans <= kLateShare;
  if (!used.cpu_late_scans) return std::nullopt;
  return *used.cpu_late_scans <= kLateShare;
}

/// Of all runs that are not lost; empty if it is not known of one of them.
std::optional<bool> are_real_time(const results::Runs& runs) {
  std::optional<bool> all;
  for (const RunRecord* run : runs) {
    if (results::is_lost(*run)) continue;
    const std::optional<bool> one = is_real_time(*run);
    if (!one) return std::nullopt;
    all = all.value_or(true) && *one;
  }
  return all;
}

Candidate candidate(const results::StudyCells& cells, const std::string& world,
                    const std::string& sensor, const std::string& algorithm) {
  Candidate c{sensor, algorithm, "", cells.rows(world, sensor, algorithm), 0, {}, {}, {},
              {},     {},        {}};
  c.variant = results::variant_of(*c.runs.front());
  c.kept = static_cast<std::size_t>(
      std::ranges::count_if(c.runs, [](const RunRecord* run) { return !results::is_lost(*run); }));
  const auto spread = [&](const results::Figure& figure) {
    return cells.spread(world, sensor, algorithm, figure);
  };
  for (const Criterion& criterion : kCriteria) {
    if (criterion.figure != nullptr) {
      c.values.push_back(spread(*criterion.figure).median);
      c.cells.push_back(cells.cell(world, sensor, algorithm, *criterion.figure));
      const bool is_map = criterion.figure == &results::kMapRmse;
      if (is_map && std::ranges::any_of(c.runs, [](const RunRecord* run) {
            return is_bent_by_interpolation(*run);
          })) {
        c.values.back().reset();  // it judges the interpolation
        c.cells.back().text += ", bent by interpolation";
      }
      continue;
    }
    c.cells.push_back(fact_of(*c.runs.front(), criterion.key));
    const auto value = c.cells.back().value;
    if (value == 0.0) c.cells.back() = {};  // the file does not say
    c.values.push_back(value == 0.0 ? std::nullopt : value);
  }
  c.own_map = results::spread_cell(spread(results::kOwnMapRmse));
  if (c.own_map.value &&
      std::ranges::any_of(c.runs, [](const RunRecord* run) { return has_mean_map(*run); }))
    c.own_map.text += ", means";
  c.is_real_time = are_real_time(c.runs);
  return c;
}

/// "fast_lio2", with its preset if that is not the default.
std::string name_of(const Candidate& c) {
  const bool usual = c.variant.empty() || c.variant == "indoor" || c.variant == "indoor-rolling" ||
                     c.variant == "rolling";
  return c.sensor + ", " + (usual ? c.algorithm : c.algorithm + " (" + c.variant + ")");
}

bool dominates(const Candidate& a, const Candidate& b) {
  bool better = false;
  for (std::size_t i = 0; i < kCriteria.size(); ++i) {
    if (!a.values[i] && !b.values[i]) continue;
    if (!a.values[i] || !b.values[i] || *a.values[i] > *b.values[i]) return false;
    better = better || *a.values[i] < *b.values[i];
  }
  return better;
}

double drift_of(const Candidate& c) {
  return c.values.front().value_or(std::numeric_limits<double>::infinity());
}

/// A dominated candidate, the one of the least drift that dominates it, and the contests of the
/// measured criteria in which its median is better.
struct Domination {
  Candidate* loser;
  const Candidate* winner;
  std::vector<const Criterion*> better;
};

std::vector<Domination> dominations(std::vector<Candidate>& all) {
  std::vector<Domination> found;
  for (Candidate& c : all) {
    if (!c.keeps_tracking()) continue;
    const Candidate* winner = nullptr;
    for (const Candidate& other : all) {
      if (!other.keeps_tracking() || !dominates(other, c)) continue;
      if (winner == nullptr || drift_of(other) < drift_of(*winner)) winner = &other;
    }
    c.on_front = winner == nullptr;
    if (winner == nullptr) continue;
    Domination domination{&c, winner, {}};
    for (std::size_t i = 0; i < kCriteria.size(); ++i) {
      if (kCriteria[i].figure != nullptr && winner->values[i] && *winner->values[i] < *c.values[i])
        domination.better.push_back(&kCriteria[i]);
    }
    found.push_back(std::move(domination));
  }
  return found;
}

/// The runs of a candidate in all worlds.
results::Runs everywhere(const results::StudyResults& results, const Candidate& c) {
  return results::StudyCells(results, c.variant).rows("", c.sensor, c.algorithm);
}

/// "ouster_os0_128, fast_lio2: better in drift (ratio 1.9 (1.5 to 2.2)), CPU (5 % level, 24
/// pairs)".
std::string words_of(const Domination& domination, std::span<const Claim> claims) {
  std::string shown, medians;
  for (std::size_t i = 0; i < claims.size(); ++i) {
    std::string& list = claims[i].a_is_better ? shown : medians;
    list += (list.empty() ? "" : ", ") + std::string(domination.better[i]->label);
    if (claims[i].a_is_better && claims[i].ratio_95) list += " (" + claims[i].ratio_words() + ")";
  }
  const std::string by = name_of(*domination.winner);
  if (claims.empty()) return by + ": as good, by the sensor's data sheet alone";
  if (medians.empty())
    return fmt::format("{}: better in {} (5 % level, {} pairs)", by, shown, claims[0].independent);
  const std::string tested = shown.empty() ? "" : fmt::format("better in {} (5 % level); ", shown);
  const std::string untested =
      claims[0].independent < results::kMinPairs
          ? "untested, " + claims[0].words()
          : fmt::format("not shown by the test, {} pairs", claims[0].independent);
  return fmt::format("{}: {}better in the medians of {} ({})", by, tested, medians, untested);
}

void find_front(const results::StudyResults& results, std::vector<Candidate>& all) {
  const std::vector<Domination> found = dominations(all);
  std::vector<results::Contest> contests;
  for (const Domination& domination : found) {
    for (const Criterion* criterion : domination.better)
      contests.push_back({everywhere(results, *domination.winner),
                          everywhere(results, *domination.loser), criterion->figure});
  }
  const std::vector<Claim> claims = results::claims_of(contests);
  std::size_t first = 0;
  for (const Domination& domination : found) {
    domination.loser->dominated_by =
        words_of(domination, std::span(claims).subspan(first, domination.better.size()));
    first += domination.better.size();
  }
}

}  // namespace

std::span<const Criterion> criteria() { return kCriteria; }

std::vector<Candidate> candidates(const results::StudyResults& results, const std::string& world) {
  std::vector<Candidate> all;
  std::set<std::string> seen;  // methods without presets occur in every variant
  for (const std::string& variant : results::variants_of(results)) {
    const results::StudyCells cells(results, variant);
    for (const std::string& sensor : cells.sensors()) {
      for (const std::string& algorithm : cells.algorithms()) {
        const auto rows = cells.rows(world, sensor, algorithm);
        if (rows.empty()) continue;
        if (const std::string& mode = rows.front()->mode; !mode.empty() && mode != "rolling") {
          continue;
        }
        if (!seen.insert(sensor + "|" + results::label_of(*rows.front())).second) continue;
        all.push_back(candidate(cells, world, sensor, algorithm));
      }
    }
  }
  find_front(results, all);
  std::ranges::stable_sort(all, {}, [](const Candidate& c) {
    return std::tuple(!c.on_front, !c.keeps_tracking(), drift_of(c));
  });
  return all;
}

std::string verdict(const Candidate& c) {
  if (!c.keeps_tracking())
    return fmt::format("lost in {} of {}", c.runs.size() - c.kept, c.runs.size());
  if (!c.is_real_time) return "time not measured";
  return *c.is_real_time ? "real time on one core" : "too slow for one core";
}

results::Table decision_table(const results::StudyResults& results, const std::string& world) {
  results::Table table{
      "decision-" + world,
      "All combinations tried, " + world,
      "The Pareto front first: no other combination that keeps tracking in every run is as good in "
      "all of drift, map (of sampled returns), CPU, weight, power and price and better in one. "
      "Then "
      "what "
      "is dominated, and by which; then what lost track. Medians over flights and seeds, the range "
      "and the runs that kept tracking; drift of the final trajectory / as known live. Whether a "
      "difference is more than chance is tested over the paired runs of all worlds (log ratios, "
      "ranked within each world; 5 % after Holm's correction), with the ratio and its interval at "
      "95 %.",
      {"sensor, method", "verdict", "Pareto front"},
      {}};
  for (const Criterion& criterion : kCriteria) {
    const std::string unit = *criterion.unit == '\0' ? "" : std::string(", ") + criterion.unit;
    table.head.push_back(criterion.label + unit);
  }
  table.head.insert(table.head.begin() + 5, "own map RMSE, cm");
  for (const Candidate& c : candidates(results, world)) {
    const std::string front = c.on_front           ? "on it"
                              : c.keeps_tracking() ? "dominated by " + c.dominated_by
                                                   : "lost";
    std::vector<TableCell> row{results::word(name_of(c)), results::word(verdict(c)),
                               results::word(front)};
    row.insert(row.end(), c.cells.begin(), c.cells.end());
    row.insert(row.begin() + 5, c.own_map);
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace lidarena::report
