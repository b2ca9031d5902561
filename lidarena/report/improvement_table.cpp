// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/improvement_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "lidarena/report/change_tables.hpp"
#include "lidarena/report/table_parts.hpp"
#include "lidarena/results/lost.hpp"
#include "lidarena/results/statistics.hpp"

namespace lidarena::report {
namespace {

using results::RunFigure;
using results::RunRecord;
using results::TableCell;

const std::array kImproved{&results::kLiveDrift, &results::kDrift, &results::kOwnMapRmse};

/// What a step does to one figure.
struct Effect {
  results::PairedComparison paired;
  bool helps = false, may_help = false, harms = false;
};

std::vector<RunFigure> variation_figures(const results::StudyResults& results,
                                         const std::string& variation,
                                         const results::Figure& figure) {
  std::vector<RunFigure> values;
  for (const RunRecord& run : results.rows) {
    if (run.variation != variation) continue;
    values.push_back(results::judged_figure(run, figure));
    values.back().flight += " " + values.back().seed;  // each seed has its own route and gusts
  }
  return values;
}

/// The effects of all variations on one figure, whose tests are corrected together.
std::vector<Effect> effects_on(const results::StudyResults& results,
                               const std::vector<std::string>& variations,
                               const results::Figure& figure) {
  const std::vector<RunFigure> base = variation_figures(results, "", figure);
  std::vector<Effect> effects;
  std::vector<double> p;
  for (const std::string& variation : variations) {
    effects.push_back(
        {results::compare_paired(base, variation_figures(results, variation, figure))});
    p.push_back(effects.back().paired.wilcoxon_p.value_or(1.0));
  }
  const std::vector<double> corrected = results::holm(p);
  for (std::size_t i = 0; i < effects.size(); ++i) {
    Effect& effect = effects[i];
    if (!effect.paired.difference_95) continue;
    const results::Interval& interval = *effect.paired.difference_95;
    effect.may_help = interval.high < 0.0;
    effect.helps = effect.may_help && corrected[i] < results::kLevel;
    effect.harms = interval.low > 0.0;
  }
  return effects;
}

TableCell effect_cell(const Effect& effect) {
  TableCell cell = difference_cell(effect.paired);
  cell.bold = effect.helps;
  return cell;
}

std::string step_verdict(const std::vector<const Effect*>& effects) {
  const auto any = [&](bool Effect::*what) {
    return std::ranges::any_of(effects, [&](const Effect* effect) { return effect->*what; });
  };
  if (any(&Effect::harms))
    return any(&Effect::may_help) ? "helps one figure, harms another" : "harms";
  if (any(&Effect::helps)) return "helps";
  return any(&Effect::may_help) ? "may help" : "no gain seen";
}

}  // namespace

Improvement improvement_of(const results::StudyResults& results,
                           const std::vector<StepNote>& steps) {
  std::vector<std::string> variations;
  for (const StepNote& step : steps) variations.push_back(step.name);
  std::map<std::string, std::vector<std::string>> parts;  // of a variation
  std::set<std::uint64_t> seeds;
  for (const RunRecord& run : results.rows) {
    seeds.insert(run.seed);
    parts[run.variation] = run.differs;
    if (run.differs.size() == 2 && std::ranges::find(variations, run.variation) == variations.end())
      variations.push_back(run.variation);
  }
  Improvement made{{"improve",
                    "What would make the sensor better",
                    fmt::format("Change on the same {} flights: median, behind it the interval at "
                                "95 % by bootstrap; less is better. Bold: the test passes, too, "
                                "corrected for the number of steps.",
                                seeds.size()),
                    {"step"},
                    {}},
                   {}};
  std::vector<std::vector<Effect>> by_figure;
  std::vector<TableCell> base{results::word("the sensor as it is")};
  for (const results::Figure* figure : kImproved) {
    made.table.head.push_back(fmt::format("{}, {}", figure->label, figure->unit));
    by_figure.push_back(effects_on(results, variations, *figure));
    base.push_back(results::spread_cell(
        results::spread_of(variation_figures(results, "", *figure), figure->better, 1, 0)));
  }
  for (const char* more : {"result", "source"}) made.table.head.emplace_back(more);
  base.resize(made.table.head.size());
  made.table.rows.push_back(base);
  std::vector<std::string> helping, maybe, useless, harming;
  std::map<std::string, std::string> verdicts;
  for (std::size_t i = 0; i < variations.size(); ++i) {
    std::vector<TableCell> row{results::word(variations[i])};
    std::vector<const Effect*> effects;
    for (const std::vector<Effect>& of_figure : by_figure) {
      row.push_back(effect_cell(of_figure[i]));
      effects.push_back(&of_figure[i]);
    }
    const std::string verdict = verdicts[variations[i]] = step_verdict(effects);
    row.push_back(results::word(verdict));
    row.push_back(results::word(i < steps.size() ? steps[i].note : "both steps together"));
    made.table.rows.push_back(std::move(row));
    if (i >= steps.size()) continue;
    if (verdict == "helps")
      helping.push_back(variations[i]);
    else if (verdict == "may help")
      maybe.push_back(variations[i]);
    else if (verdict == "no gain seen")
      useless.push_back(variations[i]);
    else
      harming.push_back(variations[i]);
  }
  made.words.push_back("helps: " + names_text(helping));
  if (!helping.empty()) made.words.push_back("cheapest step that helps: " + helping.front());
  made.words.push_back("may help, more flights (--seeds) would show: " + names_text(maybe));
  made.words.push_back("no gain seen: " + names_text(useless));
  if (!harming.empty()) made.words.push_back("harms some figure: " + names_text(harming));
  for (std::size_t i = steps.size(); i < variations.size(); ++i) {
    const auto& both = parts[variations[i]];
    if (verdicts[variations[i]] == "helps" &&
        std::ranges::all_of(
            both, [&](const std::string& one) { return verdicts[one] == "no gain seen"; }))
      made.words.push_back("helps only together: " + variations[i]);
  }
  return made;
}

}  // namespace lidarena::report
