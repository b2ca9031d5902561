// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/version_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "lidarena/base/number.hpp"
#include "lidarena/results/lost.hpp"
#include "lidarena/results/summary.hpp"

namespace lidarena::results {
namespace {

/// The figures that are compared; all are better when small.
const std::array kCompared{&kDrift,   &kLiveDrift,   &kOwnMapRmse, &kOwnMapOutliers,
                           &kMapRmse, &kMapOutliers, &kCpuP95,     &kOwnMemory};

const std::array kShortNames{std::pair{"drift", &kDrift}, std::pair{"map", &kMapRmse},
                             std::pair{"outliers", &kMapOutliers}, std::pair{"cpu", &kCpuP95},
                             std::pair{"memory", &kOwnMemory}};

/// What the two runs of a pair have in common beside sensor and method.
using Place = std::tuple<std::string, std::string, std::string, std::string, std::uint64_t>;
using Group = std::pair<std::string, std::string>;  ///< sensor, method

struct Pair {
  const RunRecord* before;
  const RunRecord* after;
};
using Pairs = std::map<Group, std::vector<Pair>>;

std::set<std::string> methods_of(const StudyResults& results) {
  std::set<std::string> methods;
  for (const RunRecord& run : results.rows) methods.insert(label_of(run));
  return methods;
}

Pairs pairs_of(const StudyResults& before, const StudyResults& after) {
  const std::set<std::string> old_methods = methods_of(before), methods = methods_of(after);
  const bool single = old_methods.size() == 1 && methods.size() == 1;
  const auto method_of = [&](const RunRecord& run) {
    return single ? *methods.begin() : label_of(run);
  };
  const auto place_of = [](const RunRecord& run) {
    return Place(run.world, run.flight, run.mode, run.variation, run.seed);
  };
  std::map<std::pair<Group, Place>, const RunRecord*> old_runs;
  for (const RunRecord& run : before.rows)
    old_runs[{{run.sensor, method_of(run)}, place_of(run)}] = &run;
  Pairs pairs;
  for (const RunRecord& run : after.rows) {
    const Group group{run.sensor, method_of(run)};
    const auto old = old_runs.find({group, place_of(run)});
    if (old != old_runs.end()) pairs[group].push_back({old->second, &run});
  }
  return pairs;
}

std::optional<FigureChange> change_of(const Group& group, const std::vector<Pair>& pairs,
                                      const Figure& figure) {
  std::vector<RunFigure> before, after;
  std::vector<double> old_values, new_values;
  std::map<std::string, std::vector<double>> by_world;
  for (const Pair& pair : pairs) {
    before.push_back(judged_figure(*pair.before, figure));
    after.push_back(judged_figure(*pair.after, figure));
    if (!before.back().value || !after.back().value) continue;
    old_values.push_back(*before.back().value);
    new_values.push_back(*after.back().value);
    if (const auto ratio = log_ratio(old_values.back(), new_values.back()))
      by_world[pair.after->world].push_back(*ratio);
  }
  if (old_values.empty()) return std::nullopt;
  FigureChange change{group.first,
                      group.second,
                      &figure,
                      quantile(old_values, 0.5),
                      quantile(new_values, 0.5),
                      compare_paired(before, after),
                      {},
                      std::nullopt};
  std::vector<std::vector<double>> strata;
  for (auto& [world, ratios] : by_world) strata.push_back(std::move(ratios));
  change.ratios = compare_strata(strata);
  change.p = change.ratios.p;
  return change;
}

void correct(std::vector<FigureChange>& changes) {
  std::vector<FigureChange*> tested;
  std::vector<double> p;
  for (FigureChange& change : changes) {
    if (!change.p) continue;
    tested.push_back(&change);
    p.push_back(*change.p);
  }
  const std::vector<double> corrected = holm(p);
  for (std::size_t k = 0; k < tested.size(); ++k) {
    FigureChange& change = *tested[k];
    change.p = corrected[k];
    if (corrected[k] < kLevel)
      change.verdict = change.ratios.b_is_smaller ? Verdict::kBetter : Verdict::kWorse;
  }
}

LostRuns lost_of(const Group& group, const std::vector<Pair>& pairs) {
  LostRuns lost{group.first, group.second, pairs.size(), 0, 0, {}};
  for (const auto& [before, after] : pairs) {
    const bool was_lost = is_lost(*before);
    const std::string reason = lost_reason(*after);
    lost.before += was_lost ? 1 : 0;
    lost.after += reason.empty() ? 0 : 1;
    if (!reason.empty() && !was_lost) lost.newly.push_back(after->name + ": " + reason);
  }
  return lost;
}

/// "lost" if it is that of a lost run.
Json number_json(double value) { return std::isinf(value) ? Json("lost") : Json(value); }

Json ratio_json(std::optional<double> ratio) { return ratio ? number_json(*ratio) : Json(nullptr); }

Json interval_json(const std::optional<Interval>& interval) {
  return interval ? Json{number_json(interval->low), number_json(interval->high)} : Json(nullptr);
}

std::string percent_text(std::optional<double> percent) {
  return percent ? fmt::format("{:+.1f} %", *percent) : "";
}

}  // namespace

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kBetter:
      return "better";
    case Verdict::kWorse:
      return "worse";
    default:
      return "neither";
  }
}

std::optional<double> FigureChange::worsening_percent() const {
  if (after == before) return 0.0;
  if (before == 0.0 || std::isinf(before) || std::isinf(after)) return std::nullopt;
  return 100.0 * (after - before) / std::abs(before);
}

std::size_t VersionComparison::pairs_needed() const {
  std::size_t pairs = 1;
  double p = 1.0;  // two-sided, of this many differences of one sign: 2 / 2^pairs
  for (; p * static_cast<double>(std::max<std::size_t>(tests, 1)) >= kLevel; p *= 0.5) ++pairs;
  return pairs;
}

VersionComparison compare_versions(const StudyResults& before, const StudyResults& after) {
  const Pairs pairs = pairs_of(before, after);
  if (pairs.empty()) {
    throw InputError(after.title,
                     "has no run on the same scene, flight and seed, with the same "
                     "sensor and method, as a run of " +
                         before.title,
                     "compare studies of the same file");
  }
  VersionComparison comparison;
  std::size_t paired = 0;
  for (const auto& [group, runs] : pairs) {
    paired += runs.size();
    comparison.lost.push_back(lost_of(group, runs));
    for (const Figure* figure : kCompared)
      if (auto change = change_of(group, runs, *figure))
        comparison.changes.push_back(*std::move(change));
  }
  comparison.unpaired = before.rows.size() + after.rows.size() - 2 * paired;
  comparison.tests = static_cast<std::size_t>(std::ranges::count_if(
      comparison.changes, [](const FigureChange& change) { return change.p.has_value(); }));
  correct(comparison.changes);
  std::ranges::stable_sort(comparison.changes, {}, [](const FigureChange& change) {
    const int order = change.verdict == Verdict::kWorse    ? 0
                      : change.verdict == Verdict::kBetter ? 1
                                                           : 2;
    return std::pair(order, -std::abs(change.worsening_percent().value_or(1e9)));
  });
  return comparison;
}

Table table_of(const VersionComparison& comparison) {
  Table table{
      "comparison",
      "Before and after",
      fmt::format("Medians over pairs of runs on the same scene, flight and seed; a lost run "
                  "is the worse one of its pair; better or worse by Wilcoxon's test of log "
                  "ratios, ranked within each world, at {:.0f} % after Holm's correction, which "
                  "here takes at least {} pairs.",
                  100.0 * kLevel, comparison.pairs_needed()),
      {"sensor", "method", "figure", "before", "after", "change", "pairs", "p", "verdict"},
      {}};
  for (const FigureChange& change : comparison.changes) {
    table.rows.push_back({word(change.sensor), word(change.method),
                          word(fmt::format("{}, {}", change.figure->label, change.figure->unit)),
                          number(change.before), number(change.after),
                          word(percent_text(change.worsening_percent())),
                          number(static_cast<double>(change.paired.pairs)), number(change.p, 2),
                          word(to_string(change.verdict))});
    table.rows.back().back().bold = change.verdict != Verdict::kNeither;
  }
  return table;
}

Json to_json(const VersionComparison& comparison) {
  Json changes = Json::array(), lost = Json::array();
  for (const FigureChange& change : comparison.changes) {
    changes.push_back({{"sensor", change.sensor},
                       {"method", change.method},
                       {"figure", change.figure->key},
                       {"unit", change.figure->unit},
                       {"before", number_json(change.before)},
                       {"after", number_json(change.after)},
                       {"change_percent", value_to_json(change.worsening_percent())},
                       {"pairs", change.paired.pairs},
                       {"ratio", ratio_json(change.ratios.ratio)},
                       {"ratio_95", interval_json(change.ratios.ratio_95)},
                       {"p", value_to_json(change.p)},
                       {"verdict", to_string(change.verdict)}});
  }
  for (const LostRuns& runs : comparison.lost) {
    lost.push_back({{"sensor", runs.sensor},
                    {"method", runs.method},
                    {"runs", runs.runs},
                    {"before", runs.before},
                    {"after", runs.after},
                    {"newly", runs.newly}});
  }
  return {{"changes", changes}, {"lost", lost}, {"unpaired", comparison.unpaired}};
}

std::string comparison_text(const VersionComparison& comparison) {
  const Table table = table_of(comparison);
  std::string text = table_text(table) + table.note + "\n";
  for (const LostRuns& runs : comparison.lost) {
    if (runs.before == 0 && runs.after == 0) continue;
    text += fmt::format("{} with {}: {} of {} runs lost, {} before\n", runs.sensor, runs.method,
                        runs.after, runs.runs, runs.before);
    for (const std::string& name : runs.newly) text += "  newly lost: " + name + "\n";
  }
  if (comparison.unpaired > 0)
    text += fmt::format("{} runs have no counterpart\n", comparison.unpaired);
  return text;
}

ChangeLimit parse_limit(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string place = "--fail-on " + text;
  if (equals == std::string::npos)
    throw InputError(place, "is not FIGURE=LIMIT", "write drift=5%,lost=0");
  ChangeLimit limit{text};
  const std::string name = text.substr(0, equals);
  std::string value = text.substr(equals + 1);
  limit.in_percent = value.ends_with('%');
  if (limit.in_percent) value.pop_back();
  const auto parsed = parse_number(value);
  if (!parsed || !(*parsed >= 0.0))
    throw InputError(place, "'" + value + "' is not a number from 0 on", "write drift=5%,lost=0");
  limit.limit = *parsed;
  if (name == "lost") {
    if (limit.in_percent) throw InputError(place, "lost runs are counted", "write lost=0");
    return limit;
  }
  const auto known = std::ranges::find(kShortNames, name, [](const auto& of) { return of.first; });
  limit.figure = known == kShortNames.end() ? &figure_of(name, place) : known->second;
  if (std::ranges::find(kCompared, limit.figure) == kCompared.end())
    throw InputError(place, "is not a figure that is compared",
                     "one of drift, map, outliers, cpu, memory, own_map_rmse, own_map_outliers");
  return limit;
}

std::vector<std::string> exceeded(const VersionComparison& comparison,
                                  const std::vector<ChangeLimit>& limits) {
  std::vector<std::string> lines;
  for (const ChangeLimit& limit : limits) {
    for (const LostRuns& runs : comparison.lost) {
      if (limit.figure != nullptr) break;
      if (static_cast<double>(runs.after) <= static_cast<double>(runs.before) + limit.limit)
        continue;
      lines.push_back(fmt::format("{}: {} with {} lost {} of {} runs, {} before", limit.text,
                                  runs.sensor, runs.method, runs.after, runs.runs, runs.before));
    }
    for (const FigureChange& change : comparison.changes) {
      if (change.figure != limit.figure) continue;
      const double allowed =
          limit.in_percent ? 0.01 * limit.limit * std::abs(change.before) : limit.limit;
      if (!(change.after - change.before > allowed)) continue;  // two lost medians are equal
      lines.push_back(fmt::format(
          "{}: {} with {}: {} {} -> {} {} ({}; {} pairs)", limit.text, change.sensor, change.method,
          change.figure->label, number(change.before).text, number(change.after).text,
          change.figure->unit, percent_text(change.worsening_percent()), change.paired.pairs));
    }
  }
  return lines;
}

}  // namespace lidarena::results
