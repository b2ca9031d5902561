// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/metrics_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <vector>

#include "lidarena/evaluation/metric_figures.hpp"

namespace lidarena::evaluation {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

bool has_coverage(const MetricFigure& figure) {
  return !std::string_view(figure.group).starts_with("/resources");
}

/// The number of samples ("38 of 45 pieces", "900 points"); empty when the figure has none.
std::string sample_count_text(const Json& metrics, const MetricFigure& figure) {
  const std::string group = figure.group;
  const auto used = number_in(metrics, group + "/used");
  const auto total = number_in(metrics, group + "/total");
  if (used && total) return fmt::format("{:.0f} of {:.0f} pieces", *used, *total);
  constexpr std::array<std::array<const char*, 2>, 6> kCounts{{{"/pieces", "pieces"},
                                                               {"/translation/count", "poses"},
                                                               {"/points", "points"},
                                                               {"/samples", "samples"},
                                                               {"/patches", "patches"},
                                                               {"/distance/count", "points"}}};
  for (const auto& [path, what] : kCounts) {
    if (const auto count = number_in(metrics, group + path)) {
      return fmt::format("{:.0f} {}", *count, what);
    }
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
  const Json* arm = find_in(association, "/lever_arm");
  if (arm == nullptr || arm->is_null()) return "not observable from this motion";
  return fmt::format("at{} m, rotated by{} deg (a diagnostic, not applied)",
                     three_numbers(arm->at("position_m"), 1.0),
                     three_numbers(arm->at("rotation_vector_rad"), kDegrees));
}

std::string gauge_text(const Json& metrics) {
  const Json* se3 = find_in(metrics, "/final/ate/se3");
  if (se3 == nullptr) return {};
  if (se3->contains("refused")) {
    return fmt::format("  SE(3) gauge refused: {}\n", se3->at("refused").get<std::string>());
  }
  return fmt::format("  SE(3) gauge x y z qx qy qz qw:{}, scale hint {:.5f} (not applied)\n",
                     three_numbers(se3->at("truth_from_estimate_m_quaternion"), 1.0),
                     se3->at("scale_hint").get<double>());
}

std::string diagnosis_text(const Json& metrics) {
  const Json* found = find_in(metrics, "/final/association");
  if (found == nullptr) return {};
  const auto at = [&](const char* key) { return number_in(*found, std::string("/") + key); };
  const auto offset = at("time_offset_s");
  std::string text = fmt::format(
      "  {:.0f} of {:.0f} poses matched, coverage {:.1f} %, overlap {:.2f} s, longest gap {:.2f} "
      "s\n  rates: estimate {:.4g} Hz, truth {:.4g} Hz; stamps late by {}\n",
      at("matched").value_or(0), at("estimates").value_or(0), 100 * at("coverage").value_or(0),
      at("overlap_s").value_or(0), at("longest_gap_s").value_or(0),
      at("estimate_rate_hz").value_or(0), at("truth_rate_hz").value_or(0),
      offset ? fmt::format("{:.1f} +- {:.1f} ms (not corrected)", 1e3 * *offset,
                           1e3 * at("time_offset_sigma_s").value_or(0))
             : "an amount that is not observable from this motion");
  text += "  estimate's frame in the truth's body: " + lever_text(*found) + "\n";
  return text + gauge_text(metrics);
}

std::string block_of(const MetricFigure& figure) {
  const std::string_view group = figure.group;
  return group.starts_with("/maps")        ? "map"
         : group.starts_with("/resources") ? "resources"
                                           : "trajectory";
}

std::string figure_text(const Json& metrics, const MetricFigure& figure) {
  const std::string refused = text_in(metrics, std::string(figure.group) + "/refused");
  if (!refused.empty()) return fmt::format("  {:<38}   refused: {}\n", figure.label, refused);
  const auto value = value_of(metrics, figure);
  if (!value) return {};
  std::string line = fmt::format("  {:<38}{:>10.3f} {:<4}", figure.label, *value, figure.unit);
  const auto coverage = coverage_of(metrics, figure);
  if (has_coverage(figure) && coverage) {
    const std::string basis = sample_count_text(metrics, figure);
    line += fmt::format("  coverage {:.0f} %{}{}", *coverage, basis.empty() ? "" : ", ", basis);
  }
  const std::string warning = text_in(metrics, std::string(figure.group) + "/warning");
  if (!warning.empty()) line += " (" + warning + ")";
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

// --- tables

using Cell = std::optional<double>;

/// The columns of a table; in the map table only those that some run has.
std::vector<const MetricFigure*> table_figures(std::span<const ScoredRun> runs, FigureTable table) {
  std::vector<const MetricFigure*> figures;
  for (const MetricFigure& figure : metric_figures()) {
    if (figure.table != table) continue;
    const bool known = std::any_of(runs.begin(), runs.end(), [&](const ScoredRun& run) {
      return value_of(run.metrics, figure).has_value();
    });
    if (known || table == FigureTable::kMain) figures.push_back(&figure);
  }
  return figures;
}

/// How many of the other runs have a better value than run `i`; empty when fewer than two runs have
/// a value.
std::optional<std::size_t> rank_of(std::span<const ScoredRun> runs, std::size_t i,
                                   const MetricFigure& figure) {
  const Cell mine = value_of(runs[i].metrics, figure);
  if (!mine) return std::nullopt;
  const double sign = figure.better == Better::kLess ? 1.0 : -1.0;
  std::size_t better = 0;
  std::size_t others = 0;
  for (const ScoredRun& run : runs) {
    const Cell value = value_of(run.metrics, figure);
    if (!value) continue;
    ++others;
    if (sign * *value < sign * *mine) ++better;
  }
  if (others < 2) return std::nullopt;
  return better;
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

/// Escapes what would end a cell in Markdown.
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

bool scored(const ScoredRun& run) { return run_status(run.metrics) == "ok"; }

std::string latex_row(std::span<const ScoredRun> runs, std::size_t i,
                      const std::vector<const MetricFigure*>& figures) {
  const ScoredRun& run = runs[i];
  std::string row = for_latex(title_of(run));
  if (!scored(run)) {
    return row + fmt::format(" & \\multicolumn{{{}}}{{l}}{{{}}} \\\\\n", figures.size() + 1,
                             for_latex(status_and_reason(run.metrics)));
  }
  row += " & " + cell_text(coverage_percent(run.metrics, "final"));
  for (const MetricFigure* figure : figures) {
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

std::string markdown_table(std::span<const ScoredRun> runs,
                           const std::vector<const MetricFigure*>& figures) {
  std::string text = "| run | coverage % |";
  std::string rule = "| --- | ---: |";
  for (const MetricFigure* figure : figures) {
    text += fmt::format(" {} |", figure->heading);
    rule += " ---: |";
  }
  text += " status |\n" + rule + " --- |\n";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    text += fmt::format("| {} | {} |", for_markdown(title_of(runs[i])),
                        cell_text(coverage_percent(runs[i].metrics, "final")));
    for (const MetricFigure* figure : figures) {
      const std::string cell = cell_text(value_of(runs[i].metrics, *figure));
      text += rank_of(runs, i, *figure) == 0U ? fmt::format(" **{}** |", cell)
                                              : fmt::format(" {} |", cell);
    }
    text += fmt::format(" {} |\n", for_markdown(status_and_reason(runs[i].metrics)));
  }
  return text;
}

std::string latex_table(std::span<const ScoredRun> runs,
                        const std::vector<const MetricFigure*>& figures) {
  std::string text = fmt::format("\\begin{{tabular}}{{l{}}}\n\\toprule\nrun & coverage \\%",
                                 std::string(figures.size() + 1, 'r'));
  for (const MetricFigure* figure : figures) text += " & " + for_latex(figure->heading);
  text += " \\\\\n\\midrule\n";
  for (std::size_t i = 0; i < runs.size(); ++i) text += latex_row(runs, i, figures);
  return text + "\\bottomrule\n\\end{tabular}\n";
}

}  // namespace

std::string metrics_text(const ScoredRun& run) {
  const Json& m = run.metrics;
  std::string text = fmt::format("{}\nstatus: {}\n", title_of(run), status_and_reason(m));
  for (const Json& warning : m.value("warnings", Json::array())) {
    text += fmt::format("warning: {}\n", warning.get<std::string>());
  }
  text += diagnosis_text(m);
  const bool live_is_final =
      find_in(m, "/live") != nullptr && find_in(m, "/final") != nullptr && m["live"] == m["final"];
  std::string block;
  for (const MetricFigure& figure : metric_figures()) {
    if (live_is_final && std::string_view(figure.group).starts_with("/live")) continue;
    const std::string line = figure_text(m, figure);
    if (!line.empty() && block != block_of(figure)) {
      block = block_of(figure);
      text += block + "\n";
    }
    text += line;
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
        quoted(run.seed), run_status(run.metrics), quoted(run.metrics.value("reason", "")));
    bool any = false;
    for (const MetricFigure& figure : metric_figures()) {
      const Cell value = value_of(run.metrics, figure);
      if (!value) continue;
      any = true;
      const std::string group = figure.group;
      const auto coverage =
          has_coverage(figure) ? coverage_of(run.metrics, figure) : std::optional<double>();
      const auto count = [&](const char* key) {
        const auto n = number_in(run.metrics, group + key);
        return n ? fmt::format("{:.0f}", *n) : std::string();
      };
      csv += fmt::format("{},{},{},{},{:.9g},{},{},{}\n", head,
                         coverage ? fmt::format("{:.3f}", *coverage) : "", figure.key,
                         quoted(text_in(run.metrics, group + "/definition")), *value, figure.unit,
                         count("/used"), count("/total"));
    }
    if (!any) csv += head + ",,,,,,,\n";
  }
  return csv;
}

std::string metrics_markdown(std::span<const ScoredRun> runs) {
  std::string text = markdown_table(runs, table_figures(runs, FigureTable::kMain));
  const auto map_figures = table_figures(runs, FigureTable::kMap);
  if (map_figures.empty()) return text;
  text += '\n';
  return text += markdown_table(runs, map_figures);
}

std::string metrics_latex(std::span<const ScoredRun> runs) {
  std::string text = latex_table(runs, table_figures(runs, FigureTable::kMain));
  const auto map_figures = table_figures(runs, FigureTable::kMap);
  if (map_figures.empty()) return text;
  text += '\n';
  return text += latex_table(runs, map_figures);
}

}  // namespace lidarena::evaluation
