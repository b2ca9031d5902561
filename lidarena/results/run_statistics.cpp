// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/run_statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "lidarena/results/figures.hpp"
#include "lidarena/results/lost.hpp"
#include "lidarena/results/statistics.hpp"
#include "lidarena/results/table.hpp"

namespace lidarena::results {
namespace {

std::vector<RunFigure> figures_of(std::span<const ScoredRun> runs, const std::string& algorithm,
                                  const Figure& figure) {
  std::vector<RunFigure> found;
  for (const ScoredRun& run : runs) {
    if (run.algorithm != algorithm) continue;
    const Reading reading = figure.read(run.metrics);
    const std::string lost = lost_reason(run.metrics);
    found.push_back({run.flight, run.seed, judged_value(run.metrics, figure),
                     lost.empty() ? reading.refused : lost, zero_bound(reading)});
  }
  return found;
}

/// "lost" for the infinite value of lost runs.
Json value_json(const std::optional<double>& value) {
  if (!value) return nullptr;
  return std::isinf(*value) ? Json("lost") : Json(*value);
}

Json to_json(const std::optional<Interval>& interval) {
  if (!interval) return nullptr;
  return {value_json(interval->low), value_json(interval->high)};
}

Json to_json(const Spread& s, const char* unit) {
  return {{"unit", unit},
          {"runs", s.runs},
          {"kept", s.kept},
          {"flights", s.flights},
          {"failures", s.failures},
          {"median", value_json(s.median)},
          {"best", value_json(s.best)},
          {"worst", value_json(s.worst)},
          {"zero_bound", value_json(s.zero_bound)},
          {"median_95", to_json(s.median_95)}};
}

Json to_json(const PairedComparison& c, const char* unit) {
  return {{"unit", unit},
          {"pairs", c.pairs},
          {"missing", c.missing},
          {"b_smaller", c.b_smaller},
          {"a_smaller", c.a_smaller},
          {"ties", c.ties},
          {"median_difference",
           value_json(c.pairs > 0 ? std::optional(c.median_difference) : std::nullopt)},
          {"difference_95", to_json(c.difference_95)},
          {"wilcoxon_p", c.wilcoxon_p ? Json(*c.wilcoxon_p) : Json(nullptr)}};
}

std::string interval_text(const std::optional<Interval>& interval) {
  return interval ? number(interval->low).text + " .. " + number(interval->high).text : "-";
}

std::vector<std::string> algorithms_of(std::span<const ScoredRun> runs) {
  std::vector<std::string> algorithms;
  for (const ScoredRun& run : runs) {
    if (std::ranges::find(algorithms, run.algorithm) == algorithms.end()) {
      algorithms.push_back(run.algorithm);
    }
  }
  return algorithms;
}

}  // namespace

RunStatistics statistics_of(std::span<const ScoredRun> runs, std::uint64_t seed) {
  RunStatistics statistics;
  for (const std::string& algorithm : algorithms_of(runs)) {
    RunStatistics::OfAlgorithm of{algorithm, {}};
    for (const Figure& figure : figures()) {
      of.figures.push_back(spread_of(figures_of(runs, algorithm, figure), figure.better, seed));
    }
    statistics.algorithms.push_back(std::move(of));
  }
  if (statistics.algorithms.size() != 2) return statistics;
  RunStatistics::OfPair pair{
      statistics.algorithms[0].algorithm, statistics.algorithms[1].algorithm, {}};
  for (const Figure& figure : figures()) {
    pair.figures.push_back(
        compare_paired(figures_of(runs, pair.a, figure), figures_of(runs, pair.b, figure), seed));
  }
  statistics.paired = std::move(pair);
  return statistics;
}

Json to_json(const RunStatistics& statistics) {
  Json json{{"algorithms", Json::object()}, {"paired", nullptr}};
  for (const RunStatistics::OfAlgorithm& of : statistics.algorithms) {
    for (std::size_t i = 0; i < of.figures.size(); ++i) {
      json["algorithms"][of.algorithm][figures()[i].key] =
          to_json(of.figures[i], figures()[i].unit);
    }
  }
  if (!statistics.paired) return json;
  const RunStatistics::OfPair& pair = *statistics.paired;
  json["paired"] = {{"a", pair.a}, {"b", pair.b}, {"figures", Json::object()}};
  for (std::size_t i = 0; i < pair.figures.size(); ++i) {
    json["paired"]["figures"][figures()[i].key] = to_json(pair.figures[i], figures()[i].unit);
  }
  return json;
}

std::string statistics_text(const RunStatistics& statistics) {
  std::string text =
      "medians, ranges from the best run to the worst, and 95 % intervals by bootstrap over "
      "flights "
      "(- for fewer than three)\n";
  for (const RunStatistics::OfAlgorithm& of : statistics.algorithms) {
    text += fmt::format("{}\n", of.algorithm.empty() ? "all" : of.algorithm);
    for (std::size_t i = 0; i < of.figures.size(); ++i) {
      const Figure& figure = figures()[i];
      const Spread& s = of.figures[i];
      if (!s.median || s.runs == 1) continue;
      text += fmt::format("  {:<38}{:>8} {:<4} {} .. {}, 95 % {}; {} of {} runs\n", figure.label,
                          number(s.median).text, figure.unit, number(s.best).text,
                          number(s.worst).text, interval_text(s.median_95), s.kept, s.runs);
    }
    for (const std::string& failure : of.figures.front().failures)
      text += fmt::format("  no value: {}\n", failure);
  }
  if (!statistics.paired) return text;
  const RunStatistics::OfPair& pair = *statistics.paired;
  text += fmt::format("{} minus {}, on the same flights and seeds\n", pair.b, pair.a);
  for (std::size_t i = 0; i < pair.figures.size(); ++i) {
    const Figure& figure = figures()[i];
    const PairedComparison& c = pair.figures[i];
    if (c.pairs == 0) continue;
    text +=
        fmt::format("  {:<38}{:>8} {:<4} 95 % {}, Wilcoxon p {}; {} pairs\n", figure.label,
                    number(c.median_difference).text, figure.unit, interval_text(c.difference_95),
                    c.wilcoxon_p ? fmt::format("{:.3g}", *c.wilcoxon_p) : "-", c.pairs);
  }
  return text;
}

}  // namespace lidarena::results
