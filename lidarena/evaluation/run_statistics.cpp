// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/run_statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "lidarena/evaluation/metric_figures.hpp"
#include "lidarena/evaluation/statistics.hpp"

namespace lidarena::evaluation {
namespace {

bool scored(const ScoredRun& run) { return run_status(run.metrics) == "ok"; }

std::vector<RunFigure> figures_of(std::span<const ScoredRun> runs, const std::string& algorithm,
                                  const MetricFigure& figure) {
  std::vector<RunFigure> figures;
  for (const ScoredRun& run : runs) {
    if (run.algorithm != algorithm) continue;
    const std::string failure =
        scored(run) ? refusal_of(run.metrics, figure) : status_and_reason(run.metrics);
    const std::optional<double> value = scored(run) ? value_of(run.metrics, figure) : std::nullopt;
    figures.push_back({run.flight, run.seed, value, failure});
  }
  return figures;
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

std::string interval_text(const Json& interval) {
  if (interval.is_null()) return "-";
  return fmt::format("{:.3g} .. {:.3g}", interval[0].get<double>(), interval[1].get<double>());
}

std::string shown(const Json& value) {
  return value.is_number() ? fmt::format("{:.3g}", value.get<double>()) : "-";
}

}  // namespace

Json statistics_json(std::span<const ScoredRun> runs, std::uint64_t seed) {
  std::vector<std::string> algorithms;
  for (const ScoredRun& run : runs) {
    if (std::find(algorithms.begin(), algorithms.end(), run.algorithm) == algorithms.end()) {
      algorithms.push_back(run.algorithm);
    }
  }
  Json json{{"algorithms", Json::object()}, {"paired", nullptr}};
  for (const std::string& algorithm : algorithms) {
    for (const MetricFigure& figure : metric_figures()) {
      const Spread spread =
          spread_of(figures_of(runs, algorithm, figure), seed, kResamples, figure.better);
      json["algorithms"][algorithm][figure.key] = to_json(spread, figure.unit);
    }
  }
  if (algorithms.size() != 2) return json;
  json["paired"] = {{"a", algorithms[0]}, {"b", algorithms[1]}, {"figures", Json::object()}};
  for (const MetricFigure& figure : metric_figures()) {
    const PairedComparison found = compare_paired(figures_of(runs, algorithms[0], figure),
                                                  figures_of(runs, algorithms[1], figure), seed);
    json["paired"]["figures"][figure.key] = to_json(found, figure.unit);
  }
  return json;
}

std::string statistics_text(const Json& statistics) {
  std::string text =
      "medians, ranges, and 95 % intervals by bootstrap over flights (- for fewer than three)\n";
  for (const auto& [algorithm, figures] : statistics.at("algorithms").items()) {
    text += fmt::format("{}\n", algorithm.empty() ? "all" : algorithm);
    for (const MetricFigure& figure : metric_figures()) {
      const Json& s = figures.at(figure.key);
      if (s.at("values") == 0 || s.at("runs") == 1) continue;
      text += fmt::format("  {:<38}{:>8} {:<4} {} .. {}, 95 % {}; {} of {} runs\n", figure.label,
                          shown(s.at("median")), figure.unit, shown(s.at("min")),
                          shown(s.at("max")), interval_text(s.at("median_95")),
                          s.at("values").get<std::size_t>(), s.at("runs").get<std::size_t>());
    }
    for (const Json& failure : figures.at(metric_figures()[0].key).at("failures")) {
      text += fmt::format("  no value: {}\n", failure.get<std::string>());
    }
  }
  const Json& paired = statistics.at("paired");
  if (paired.is_null()) return text;
  text += fmt::format("{} minus {}, on the same flights and seeds\n",
                      paired.at("b").get<std::string>(), paired.at("a").get<std::string>());
  for (const MetricFigure& figure : metric_figures()) {
    const Json& c = paired.at("figures").at(figure.key);
    if (c.at("pairs") == 0) continue;
    text += fmt::format("  {:<38}{:>8} {:<4} 95 % {}, Wilcoxon p {}; {} pairs\n", figure.label,
                        shown(c.at("median_difference")), figure.unit,
                        interval_text(c.at("difference_95")), shown(c.at("wilcoxon_p")),
                        c.at("pairs").get<std::size_t>());
  }
  return text;
}

}  // namespace lidarena::evaluation
