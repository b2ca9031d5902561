// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/run_statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "lidarena/results/figures.hpp"
#include "lidarena/results/statistics.hpp"

namespace lidarena::results {
namespace {

std::vector<RunFigure> figures_of(std::span<const ScoredRun> runs, const std::string& algorithm,
                                  const Figure& figure) {
  std::vector<RunFigure> found;
  for (const ScoredRun& run : runs) {
    if (run.algorithm != algorithm) continue;
    if (run.metrics.is_ok()) {
      found.push_back(
          {run.flight, run.seed, value_of(run.metrics, figure), figure.read(run.metrics).refused});
    } else {
      found.push_back({run.flight, run.seed, std::nullopt, run.metrics.status_and_reason()});
    }
  }
  return found;
}

Json to_json(const std::optional<Interval>& interval) {
  if (!interval) return nullptr;
  return {interval->low, interval->high};
}

Json to_json(const Spread& s, const char* unit) {
  const bool some = s.values > 0;
  const auto known = [&](double value) { return some ? Json(value) : Json(nullptr); };
  return {{"unit", unit},
          {"runs", s.runs},
          {"values", s.values},
          {"flights", s.flights},
          {"failures", s.failures},
          {"median", known(s.median)},
          {"min", known(s.min)},
          {"max", known(s.max)},
          {"mean", known(s.mean)},
          {"median_with_failures",
           s.median_with_failures ? Json(*s.median_with_failures) : Json(nullptr)},
          {"median_95", to_json(s.median_95)}};
}

Json to_json(const PairedComparison& c, const char* unit) {
  return {{"unit", unit},
          {"pairs", c.pairs},
          {"missing", c.missing},
          {"b_smaller", c.b_smaller},
          {"a_smaller", c.a_smaller},
          {"ties", c.ties},
          {"median_difference", c.pairs > 0 ? Json(c.median_difference) : Json(nullptr)},
          {"difference_95", to_json(c.difference_95)},
          {"wilcoxon_p", c.wilcoxon_p ? Json(*c.wilcoxon_p) : Json(nullptr)}};
}

std::string interval_text(const std::optional<Interval>& interval) {
  return interval ? fmt::format("{:.3g} .. {:.3g}", interval->low, interval->high) : "-";
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
      of.figures.push_back(
          spread_of(figures_of(runs, algorithm, figure), seed, kResamples, figure.better));
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
      "medians, ranges, and 95 % intervals by bootstrap over flights (- for fewer than three)\n";
  for (const RunStatistics::OfAlgorithm& of : statistics.algorithms) {
    text += fmt::format("{}\n", of.algorithm.empty() ? "all" : of.algorithm);
    for (std::size_t i = 0; i < of.figures.size(); ++i) {
      const Figure& figure = figures()[i];
      const Spread& s = of.figures[i];
      if (s.values == 0 || s.runs == 1) continue;
      text += fmt::format("  {:<38}{:>8.3g} {:<4} {:.3g} .. {:.3g}, 95 % {}; {} of {} runs\n",
                          figure.label, s.median, figure.unit, s.min, s.max,
                          interval_text(s.median_95), s.values, s.runs);
    }
    for (const std::string& failure : of.figures.front().failures) {
      text += fmt::format("  no value: {}\n", failure);
    }
  }
  if (!statistics.paired) return text;
  const RunStatistics::OfPair& pair = *statistics.paired;
  text += fmt::format("{} minus {}, on the same flights and seeds\n", pair.b, pair.a);
  for (std::size_t i = 0; i < pair.figures.size(); ++i) {
    const Figure& figure = figures()[i];
    const PairedComparison& c = pair.figures[i];
    if (c.pairs == 0) continue;
    text += fmt::format("  {:<38}{:>8.3g} {:<4} 95 % {}, Wilcoxon p {}; {} pairs\n", figure.label,
                        c.median_difference, figure.unit, interval_text(c.difference_95),
                        c.wilcoxon_p ? fmt::format("{:.3g}", *c.wilcoxon_p) : "-", c.pairs);
  }
  return text;
}

}  // namespace lidarena::results
