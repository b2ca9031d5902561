// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/metrics_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <numbers>
#include <optional>
#include <vector>

#include "lidarena/evaluation/statistics.hpp"

namespace lidarena {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// A figure and where it stands in metrics.json.
struct Figure {
  const char* key;
  const char* heading;  ///< in tables; null = not in tables
  const char* group;    ///< pointer to the object with definition, used, total
  const char* value;    ///< pointer from there
  double factor;
  const char* unit;
  const char* words;  ///< on a terminal
};

constexpr std::array kFigures{
    Figure{"rpe_1m_translation", "RPE cm/m", "/final/rpe/1m", "/translation/rmse_m", 100, "cm",
           "RPE per metre"},
    Figure{"rpe_1m_rotation", "RPE deg/m", "/final/rpe/1m", "/rotation/rmse_rad", kDegrees, "deg",
           "RPE per metre, rotation"},
    Figure{"rpe_1s_translation", nullptr, "/final/rpe/1s", "/translation/rmse_m", 100, "cm",
           "RPE per second"},
    Figure{"rpe_10m_translation", nullptr, "/final/rpe/10m", "/translation/rmse_m", 100, "cm",
           "RPE per 10 m"},
    Figure{"rpe_50m_translation", nullptr, "/final/rpe/50m", "/translation/rmse_m", 100, "cm",
           "RPE per 50 m"},
    Figure{"ate_se3_translation", "ATE cm", "/final/ate/se3", "/translation/rmse_m", 100, "cm",
           "ATE, SE(3) gauge"},
    Figure{"ate_se3_rotation", nullptr, "/final/ate/se3", "/rotation/rmse_rad", kDegrees, "deg",
           "ATE, SE(3) gauge, rotation"},
    Figure{"ate_posyaw_translation", nullptr, "/final/ate/posyaw", "/translation/rmse_m", 100, "cm",
           "ATE, position and heading"},
    Figure{"ate_first_pose_translation", nullptr, "/final/ate/first_pose", "/translation/rmse_m",
           100, "cm", "ATE, first-pose gauge"},
    Figure{"kitti_translation", nullptr, "/final/kitti", "/translation_percent", 1, "%",
           "KITTI, 100 to 800 m"},
    Figure{"kitti_short_translation", nullptr, "/final/kitti_short", "/translation_percent", 1, "%",
           "KITTI's rule, 1 to 50 m"},
    Figure{"live_rpe_1m_translation", nullptr, "/live/rpe/1m", "/translation/rmse_m", 100, "cm",
           "RPE per metre, live"},
    Figure{"live_ate_se3_translation", nullptr, "/live/ate/se3", "/translation/rmse_m", 100, "cm",
           "ATE, SE(3) gauge, live"},
    Figure{"own_map_rmse", "own map cm", "/maps/own/se3", "/distance/rmse_m", 100, "cm",
           "own map, RMSE"},
    Figure{"own_map_outliers", nullptr, "/maps/own/se3", "/outliers_percent", 1, "%",
           "own map, beyond 20 cm"},
    Figure{"reprojected_map_rmse", "map cm", "/maps/reprojected/se3", "/distance/rmse_m", 100, "cm",
           "reprojected map, RMSE"},
    Figure{"reprojected_map_rmse_inliers", nullptr, "/maps/reprojected/se3", "/rmse_inliers_m", 100,
           "cm", "reprojected map, RMSE of inliers"},
    Figure{"reprojected_map_outliers", "outliers %", "/maps/reprojected/se3", "/outliers_percent",
           1, "%", "reprojected map, beyond 20 cm"},
    Figure{"latency_median", nullptr, "/resources", "/latency/median_s", 1e3, "ms",
           "latency, median"},
    Figure{"latency_p95", "P95 ms", "/resources", "/latency/p95_s", 1e3, "ms", "latency, P95"},
    Figure{"latency_p99", nullptr, "/resources", "/latency/p99_s", 1e3, "ms", "latency, P99"},
    Figure{"latency_max", nullptr, "/resources", "/latency/max_s", 1e3, "ms", "latency, maximum"},
    Figure{"real_time_factor", nullptr, "/resources", "/real_time_factor", 1, "x",
           "real-time factor"},
    Figure{"own_memory_peak", "own MB", "/resources", "/own/peak_bytes", 1e-6, "MB",
           "own memory, peak"},
    Figure{"process_memory_peak", nullptr, "/resources", "/rss/peak_bytes", 1e-6, "MB",
           "process memory, peak"},
};

const Json* find(const Json& json, const std::string& path) {
  const Json::json_pointer pointer(path);
  return json.is_structured() && json.contains(pointer) ? &json.at(pointer) : nullptr;
}

std::optional<double> number(const Json& json, const std::string& path, double factor = 1.0) {
  const Json* value = find(json, path);
  if (value == nullptr || !value->is_number()) return std::nullopt;
  return value->get<double>() * factor;
}

std::string text_at(const Json& json, const std::string& path) {
  const Json* value = find(json, path);
  return value != nullptr && value->is_string() ? value->get<std::string>() : std::string();
}

std::optional<double> value_of(const Json& metrics, const Figure& figure) {
  return number(metrics, std::string(figure.group) + figure.value, figure.factor);
}

std::string status_of(const Json& metrics) { return metrics.value("status", "ok"); }

std::string failure_of(const Json& metrics) {
  const std::string reason = metrics.value("reason", "");
  return status_of(metrics) + (reason.empty() ? "" : ": " + reason);
}

std::optional<double> coverage_percent(const Json& metrics, const char* trajectory) {
  return number(metrics, fmt::format("/{}/association/coverage", trajectory), 100.0);
}

/// Errors of the live trajectory rest on its own coverage, all else on the final one's.
std::optional<double> coverage_of(const Json& metrics, const Figure& figure) {
  const bool live = std::string_view(figure.group).starts_with("/live");
  return coverage_percent(metrics, live ? "live" : "final");
}

bool has_coverage(const Figure& figure) {
  return !std::string_view(figure.group).starts_with("/resources");
}

/// "used of total", in whatever the figure counts; empty when it counts nothing.
std::string basis_of(const Json& metrics, const Figure& figure) {
  const std::string group = figure.group;
  const auto used = number(metrics, group + "/used");
  const auto total = number(metrics, group + "/total");
  if (used && total) return fmt::format("{:.0f} of {:.0f} pieces", *used, *total);
  if (const auto pieces = number(metrics, group + "/pieces")) {
    return fmt::format("{:.0f} pieces", *pieces);
  }
  if (const auto count = number(metrics, group + "/translation/count")) {
    return fmt::format("{:.0f} poses", *count);
  }
  if (const auto points = number(metrics, group + "/points")) {
    return fmt::format("{:.0f} points", *points);
  }
  return {};
}

// --- terminal

std::string three_numbers(const Json& list, double factor) {
  std::string text;
  for (const Json& value : list) {
    text += value.is_number() ? fmt::format(" {:.4g}", value.get<double>() * factor) : " ?";
  }
  return text;
}

std::string lever_text(const Json& association) {
  const Json* arm = find(association, "/lever_arm");
  if (arm == nullptr || arm->is_null()) return "not shown by this motion";
  return fmt::format("at{} m, turned by{} deg (a diagnosis, not applied)",
                     three_numbers(arm->at("position_m"), 1.0),
                     three_numbers(arm->at("rotation_vector_rad"), kDegrees));
}

std::string gauge_text(const Json& metrics) {
  const Json* se3 = find(metrics, "/final/ate/se3");
  if (se3 == nullptr) return {};
  if (se3->contains("refused")) {
    return fmt::format("  SE(3) gauge refused: {}\n", se3->at("refused").get<std::string>());
  }
  return fmt::format("  SE(3) gauge x y z qx qy qz qw:{}, scale hint {:.5f} (not applied)\n",
                     three_numbers(se3->at("truth_from_estimate_m_quaternion"), 1.0),
                     se3->at("scale_hint").get<double>());
}

std::string diagnosis_text(const Json& metrics) {
  const Json* found = find(metrics, "/final/association");
  if (found == nullptr) return {};
  const auto at = [&](const char* key) { return number(*found, std::string("/") + key); };
  const auto offset = at("time_offset_s");
  std::string text = fmt::format(
      "  {:.0f} of {:.0f} poses matched, coverage {:.1f} %, overlap {:.2f} s, longest gap {:.2f} "
      "s\n  rates: estimate {:.4g} Hz, truth {:.4g} Hz; stamps late by {}\n",
      at("matched").value_or(0), at("estimates").value_or(0), 100 * at("coverage").value_or(0),
      at("overlap_s").value_or(0), at("longest_gap_s").value_or(0),
      at("estimate_rate_hz").value_or(0), at("truth_rate_hz").value_or(0),
      offset ? fmt::format("{:.1f} +- {:.1f} ms (not corrected)", 1e3 * *offset,
                           1e3 * at("time_offset_sigma_s").value_or(0))
             : "an amount that this motion does not show");
  text += "  estimate's frame in the truth's body: " + lever_text(*found) + "\n";
  return text + gauge_text(metrics);
}

std::string figure_text(const Json& metrics, const Figure& figure) {
  const std::string refused = text_at(metrics, std::string(figure.group) + "/refused");
  if (!refused.empty()) return fmt::format("  {:<34}   refused: {}\n", figure.words, refused);
  const auto value = value_of(metrics, figure);
  if (!value) return {};
  std::string line = fmt::format("  {:<34}{:>10.3f} {:<4}", figure.words, *value, figure.unit);
  const auto coverage = coverage_of(metrics, figure);
  if (has_coverage(figure) && coverage) {
    const std::string basis = basis_of(metrics, figure);
    line += fmt::format("  coverage {:.0f} %{}{}", *coverage, basis.empty() ? "" : ", ", basis);
  }
  const std::string warning = text_at(metrics, std::string(figure.group) + "/warning");
  if (!warning.empty()) line += " (" + warning + ")";
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

// --- tables

using Cell = std::optional<double>;

std::vector<const Figure*> table_figures() {
  std::vector<const Figure*> figures;
  for (const Figure& figure : kFigures) {
    if (figure.heading != nullptr) figures.push_back(&figure);
  }
  return figures;
}

/// How many of the other runs have a smaller value than run `i`; empty where there is no contest.
std::optional<std::size_t> rank_of(std::span<const ScoredRun> runs, std::size_t i,
                                   const Figure& figure) {
  const Cell mine = value_of(runs[i].metrics, figure);
  if (!mine) return std::nullopt;
  std::size_t smaller = 0;
  std::size_t others = 0;
  for (const ScoredRun& run : runs) {
    const Cell value = value_of(run.metrics, figure);
    if (!value) continue;
    ++others;
    if (*value < *mine) ++smaller;
  }
  if (others < 2) return std::nullopt;
  return smaller;
}

std::string title_of(const ScoredRun& run) {
  return run.algorithm.empty() ? run.name : run.name + " (" + run.algorithm + ")";
}

std::string cell_text(const Cell& value) { return value ? fmt::format("{:.3g}", *value) : "-"; }

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

/// Without what Markdown takes for the end of a cell.
std::string for_markdown(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? "\\|" : c == '\n' ? " " : std::string(1, c);
  return out;
}

std::string for_latex(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
      case '%':
      case '$':
      case '#':
      case '_':
      case '{':
      case '}':
        out += std::string("\\") + c;
        break;
      case '\\':
        out += "\\textbackslash{}";
        break;
      case '~':
        out += "\\textasciitilde{}";
        break;
      case '^':
        out += "\\textasciicircum{}";
        break;
      default:
        out += c;
    }
  }
  return out;
}

bool scored(const ScoredRun& run) { return status_of(run.metrics) == "ok"; }

std::string latex_row(std::span<const ScoredRun> runs, std::size_t i,
                      const std::vector<const Figure*>& figures) {
  const ScoredRun& run = runs[i];
  std::string row = for_latex(title_of(run));
  if (!scored(run)) {
    return row + fmt::format(" & \\multicolumn{{{}}}{{l}}{{{}}} \\\\\n", figures.size() + 1,
                             for_latex(failure_of(run.metrics)));
  }
  row += " & " + cell_text(coverage_percent(run.metrics, "final"));
  for (const Figure* figure : figures) {
    const std::string text = cell_text(value_of(run.metrics, *figure));
    const auto rank = rank_of(runs, i, *figure);
    if (rank == 0U) {
      row += " & \\textbf{" + text + "}";
    } else if (rank == 1U) {
      row += " & \\underline{" + text + "}";
    } else {
      row += " & " + (text == "-" ? "--" : text);
    }
  }
  return row + " \\\\\n";
}

// --- statistics

std::vector<RunFigure> figures_of(std::span<const ScoredRun> runs, const std::string& algorithm,
                                  const Figure& figure) {
  std::vector<RunFigure> figures;
  for (const ScoredRun& run : runs) {
    if (run.algorithm != algorithm) continue;
    const std::string failure = scored(run)
                                    ? text_at(run.metrics, std::string(figure.group) + "/refused")
                                    : failure_of(run.metrics);
    const Cell value = scored(run) ? value_of(run.metrics, figure) : std::nullopt;
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

std::string metrics_text(const ScoredRun& run) {
  const Json& m = run.metrics;
  std::string text = fmt::format("{}\nstatus: {}\n", title_of(run), failure_of(m));
  for (const Json& warning : m.value("warnings", Json::array())) {
    text += fmt::format("warning: {}\n", warning.get<std::string>());
  }
  text += diagnosis_text(m);
  const bool live_is_final =
      find(m, "/live") != nullptr && find(m, "/final") != nullptr && m["live"] == m["final"];
  for (const Figure& figure : kFigures) {
    if (live_is_final && std::string_view(figure.group).starts_with("/live")) continue;
    text += figure_text(m, figure);
  }
  return text;
}

std::string metrics_csv(std::span<const ScoredRun> runs) {
  std::string csv =
      "run,algorithm,flight,seed,status,reason,coverage_percent,figure,definition,value,unit,used,"
      "total\n";
  for (const ScoredRun& run : runs) {
    const std::string head = fmt::format(
        "{},{},{},{},{},{}", quoted(run.name), quoted(run.algorithm), quoted(run.flight),
        quoted(run.seed), status_of(run.metrics), quoted(run.metrics.value("reason", "")));
    bool any = false;
    for (const Figure& figure : kFigures) {
      const Cell value = value_of(run.metrics, figure);
      if (!value) continue;
      any = true;
      const std::string group = figure.group;
      const auto coverage =
          has_coverage(figure) ? coverage_of(run.metrics, figure) : std::optional<double>();
      const auto count = [&](const char* key) {
        const auto n = number(run.metrics, group + key);
        return n ? fmt::format("{:.0f}", *n) : std::string();
      };
      csv += fmt::format("{},{},{},{},{:.9g},{},{},{}\n", head,
                         coverage ? fmt::format("{:.3f}", *coverage) : "", figure.key,
                         quoted(text_at(run.metrics, group + "/definition")), *value, figure.unit,
                         count("/used"), count("/total"));
    }
    if (!any) csv += head + ",,,,,,,\n";
  }
  return csv;
}

std::string metrics_markdown(std::span<const ScoredRun> runs) {
  const std::vector<const Figure*> figures = table_figures();
  std::string text = "| run | coverage % |";
  std::string rule = "| --- | ---: |";
  for (const Figure* figure : figures) {
    text += fmt::format(" {} |", figure->heading);
    rule += " ---: |";
  }
  text += " status |\n" + rule + " --- |\n";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    text += fmt::format("| {} | {} |", for_markdown(title_of(runs[i])),
                        cell_text(coverage_percent(runs[i].metrics, "final")));
    for (const Figure* figure : figures) {
      const std::string cell = cell_text(value_of(runs[i].metrics, *figure));
      text += rank_of(runs, i, *figure) == 0U ? fmt::format(" **{}** |", cell)
                                              : fmt::format(" {} |", cell);
    }
    text += fmt::format(" {} |\n", for_markdown(failure_of(runs[i].metrics)));
  }
  return text;
}

std::string metrics_latex(std::span<const ScoredRun> runs) {
  const std::vector<const Figure*> figures = table_figures();
  std::string text = fmt::format("\\begin{{tabular}}{{l{}}}\n\\toprule\nrun & coverage \\%",
                                 std::string(figures.size() + 1, 'r'));
  for (const Figure* figure : figures) text += " & " + for_latex(figure->heading);
  text += " \\\\\n\\midrule\n";
  for (std::size_t i = 0; i < runs.size(); ++i) text += latex_row(runs, i, figures);
  return text + "\\bottomrule\n\\end{tabular}\n";
}

Json statistics_json(std::span<const ScoredRun> runs, std::uint64_t seed) {
  std::vector<std::string> algorithms;
  for (const ScoredRun& run : runs) {
    if (std::find(algorithms.begin(), algorithms.end(), run.algorithm) == algorithms.end()) {
      algorithms.push_back(run.algorithm);
    }
  }
  Json json{{"algorithms", Json::object()}, {"paired", nullptr}};
  for (const std::string& algorithm : algorithms) {
    for (const Figure& figure : kFigures) {
      const Spread spread = spread_of(figures_of(runs, algorithm, figure), seed);
      json["algorithms"][algorithm][figure.key] = to_json(spread, figure.unit);
    }
  }
  if (algorithms.size() != 2) return json;
  json["paired"] = {{"a", algorithms[0]}, {"b", algorithms[1]}, {"figures", Json::object()}};
  for (const Figure& figure : kFigures) {
    const PairedComparison found = compare_paired(figures_of(runs, algorithms[0], figure),
                                                  figures_of(runs, algorithms[1], figure), seed);
    json["paired"]["figures"][figure.key] = to_json(found, figure.unit);
  }
  return json;
}

std::string statistics_text(const Json& statistics) {
  std::string text =
      "medians, ranges, and 95 % intervals by bootstrap over flights (- under three flights)\n";
  for (const auto& [algorithm, figures] : statistics.at("algorithms").items()) {
    text += fmt::format("{}\n", algorithm.empty() ? "all" : algorithm);
    for (const Figure& figure : kFigures) {
      const Json& s = figures.at(figure.key);
      if (s.at("values") == 0 || s.at("runs") == 1) continue;
      text += fmt::format("  {:<34}{:>8} {:<4} {} .. {}, 95 % {}; {} of {} runs\n", figure.words,
                          shown(s.at("median")), figure.unit, shown(s.at("min")),
                          shown(s.at("max")), interval_text(s.at("median_95")),
                          s.at("values").get<std::size_t>(), s.at("runs").get<std::size_t>());
    }
    for (const Json& failure : figures.at(kFigures[0].key).at("failures")) {
      text += fmt::format("  without: {}\n", failure.get<std::string>());
    }
  }
  const Json& paired = statistics.at("paired");
  if (paired.is_null()) return text;
  text += fmt::format("{} minus {}, on the same flights and seeds\n",
                      paired.at("b").get<std::string>(), paired.at("a").get<std::string>());
  for (const Figure& figure : kFigures) {
    const Json& c = paired.at("figures").at(figure.key);
    if (c.at("pairs") == 0) continue;
    text += fmt::format("  {:<34}{:>8} {:<4} 95 % {}, Wilcoxon p {}; {} pairs\n", figure.words,
                        shown(c.at("median_difference")), figure.unit,
                        interval_text(c.at("difference_95")), shown(c.at("wilcoxon_p")),
                        c.at("pairs").get<std::size_t>());
  }
  return text;
}

}  // namespace lidarena
