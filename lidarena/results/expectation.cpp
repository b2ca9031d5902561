// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/expectation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lidarena/base/config.hpp"
#include "lidarena/results/figures.hpp"
#include "lidarena/results/study_cells.hpp"

namespace lidarena::results {
namespace {

/// The coordinates of a cell in the order of kKinds.
using CellKey = std::array<std::string, 3>;
constexpr std::array kKinds{"world", "sensor", "algorithm"};
constexpr std::array kNames{&CellName::world, &CellName::sensor, &CellName::algorithm};
constexpr std::array kLists{&CellFilter::world, &CellFilter::sensor, &CellFilter::algorithm};

/// Which of the three a name is of.
std::size_t kind_of(const CellName& name) {
  std::size_t kind = 0;
  while (kind + 1 < kNames.size() && (name.*kNames[kind]).empty()) ++kind;
  return kind;
}
const std::string& text_of(const CellName& name) { return name.*kNames[kind_of(name)]; }

std::string shown(double value) { return fmt::format("{:.3g}", value); }

/// A value to judge: of a cell, or a ratio of two cells.
struct Value {
  CellKey cell;
  std::string place;  ///< the cell in words, without what a ratio or a comparison runs over
  std::optional<double> value;
  std::string words;  ///< the value in words, or why there is none
};

class Judge {
 public:
  Judge(const StudyResults& results, const Expectation& expectation, const std::string& variant)
      : e_(expectation),
        figure_(figure_of(expectation.figure, expectation.finding)),
        cells_(results, variant) {}

  Judgement judge(const std::string& variant) const {
    Judgement judged{e_, variant, {}, {}};
    for (const CellName* best :
         {e_.lowest ? &*e_.lowest : nullptr, e_.highest ? &*e_.highest : nullptr}) {
      if (best != nullptr) compare(*best, best == (e_.lowest ? &*e_.lowest : nullptr), judged);
    }
    if (e_.above || e_.below) {
      for (const Value& value : values()) limit(value, judged);
    }
    return judged;
  }

 private:
  static void add(Judgement& judged, bool holds, bool all) {
    if (!judged.holds) judged.holds = holds;
    judged.holds = all ? *judged.holds && holds : *judged.holds || holds;
  }

  /// The cells that count, in the order of the study; with a ratio those of its numerator.
  std::vector<CellKey> chosen() const {
    std::vector<CellKey> cells;
    for (const std::string& world : cells_.worlds()) {
      for (const std::string& sensor : cells_.sensors()) {
        for (const std::string& algorithm : cells_.algorithms()) {
          const CellKey cell{world, sensor, algorithm};
          if (counts(cell) && !cells_.rows(world, sensor, algorithm).empty()) cells.push_back(cell);
        }
      }
    }
    return cells;
  }

  bool counts(const CellKey& cell) const {
    for (std::size_t kind = 0; kind < cell.size(); ++kind) {
      if (e_.ratio && kind == kind_of(e_.ratio->of)) {
        if (cell[kind] != text_of(e_.ratio->of)) return false;
        continue;
      }
      const std::vector<std::string>& names = e_.where.*kLists[kind];
      if (!names.empty() && std::ranges::find(names, cell[kind]) == names.end()) return false;
    }
    return true;
  }

  /// Infinite if it is that of a lost run.
  std::optional<double> median(const CellKey& cell) const {
    return cells_.spread(cell[0], cell[1], cell[2], figure_).median;
  }

  /// "cave, livox_mid360", without the kind `left_out`.
  static std::string place_of(const CellKey& cell, std::size_t left_out) {
    std::string text;
    for (std::size_t kind = 0; kind < cell.size(); ++kind) {
      if (kind != left_out) text += (text.empty() ? "" : ", ") + cell[kind];
    }
    return text;
  }

  std::string with_unit(double value) const {
    return std::isinf(value) ? "lost" : fmt::format("{} {}", shown(value), figure_.unit);
  }

  /// Why a cell has no figure.
  std::string state_of(const CellKey& cell) const {
    const std::string state = cells_.status_text(cell[0], cell[1], cell[2]);
    return fmt::format("{} {}", cell[2], state.empty() ? "not measured" : state);
  }

  /// The value in words, with the runs that are lost.
  std::string words_of(const CellKey& cell, double value) const {
    const std::string state = cells_.status_text(cell[0], cell[1], cell[2]);
    return with_unit(value) + (state.empty() ? "" : " (" + state + ")");
  }

  Value ratio_at(const CellKey& cell) const {
    const std::size_t kind = kind_of(e_.ratio->of);
    CellKey other = cell;
    other[kind] = text_of(e_.ratio->to);
    Value value{cell, place_of(cell, kind), {}, {}};
    const auto own = median(cell);
    const auto theirs = median(other);
    if (!own || !theirs) {
      value.words = state_of(own ? other : cell);
    } else if (std::isinf(*own) && std::isinf(*theirs)) {
      value.words = "lost with both";
    } else if (*theirs == 0.0) {
      value.words = fmt::format("nothing to compare, {} with {}", with_unit(0.0), other[kind]);
    } else {
      value.value = *own / *theirs;
      value.words = fmt::format("{} with {}, {} with {}", words_of(cell, *own), cell[kind],
                                words_of(other, *theirs), other[kind]);
    }
    return value;
  }

  std::vector<Value> values() const {
    std::vector<Value> found;
    for (const CellKey& cell : chosen()) {
      if (e_.ratio) {
        found.push_back(ratio_at(cell));
        continue;
      }
      const auto value = median(cell);
      found.push_back({cell, place_of(cell, kKinds.size()), value,
                       value ? words_of(cell, *value) : state_of(cell)});
    }
    return found;
  }

  void limit(const Value& value, Judgement& judged) const {
    judged.evidence.push_back(value.place + ": " + value.words);
    if (!value.value) return;
    add(judged, (!e_.above || *value.value > *e_.above) && (!e_.below || *value.value < *e_.below),
        e_.cells == Extent::kAll);
  }

  /// Judges that `best` has the lowest (or highest) value beside all others of its kind.
  void compare(const CellName& best, bool lowest, Judgement& judged) const {
    const std::size_t kind = kind_of(best);
    const std::vector<Value> all = values();
    const auto better = [&](const Value& a, const Value& b) {
      return lowest ? *a.value < *b.value : *a.value > *b.value;
    };
    for (const Value& own : all) {
      if (own.cell[kind] != text_of(best) || !own.value) continue;
      const Value* rival = nullptr;
      for (const Value& other : all) {
        CellKey same = other.cell;
        same[kind] = own.cell[kind];
        if (!other.value || other.cell == own.cell || same != own.cell) continue;
        if (rival == nullptr || better(other, *rival)) rival = &other;
      }
      if (rival == nullptr) continue;
      add(judged, better(own, *rival), e_.cells == Extent::kAll);
      judged.evidence.push_back(fmt::format("{}: {}, against {} of {}", place_of(own.cell, kind),
                                            own.words, rival->words, rival->cell[kind]));
    }
  }

  const Expectation& e_;
  const Figure& figure_;
  StudyCells cells_;
};

void check_name(const CellName& name, const CellFilter& names, const std::string& place) {
  const auto given =
      std::ranges::count_if(kNames, [&](const auto member) { return !(name.*member).empty(); });
  if (given != 1) throw InputError(place, "names not exactly one of world, sensor and algorithm");
  const std::size_t kind = kind_of(name);
  const std::vector<std::string>& known = names.*kLists[kind];
  if (std::ranges::find(known, text_of(name)) != known.end()) return;
  const std::string nearest = nearest_word(text_of(name), known);
  throw InputError(place, fmt::format("the study has no {} '{}'", kKinds[kind], text_of(name)),
                   nearest.empty() ? "" : "did you mean '" + nearest + "'?");
}

}  // namespace

void check(const Expectation& e, const CellFilter& names, const std::string& place) {
  const std::string here = place + ": expect: " + (e.finding.empty() ? e.figure : e.finding);
  figure_of(e.figure, here);
  if (!e.lowest && !e.highest && !e.above && !e.below) {
    throw InputError(here, "says nothing of the figure",
                     "give one of lowest, highest, above, below");
  }
  for (const auto& name : {e.lowest, e.highest}) {
    if (name) check_name(*name, names, here);
  }
  if (e.ratio) {
    check_name(e.ratio->of, names, here);
    check_name(e.ratio->to, names, here);
    if (kind_of(e.ratio->of) != kind_of(e.ratio->to)) {
      throw InputError(here, "has a ratio of two different kinds",
                       "give two worlds, two sensors or two algorithms");
    }
  }
  for (std::size_t kind = 0; kind < kLists.size(); ++kind) {
    for (const std::string& name : e.where.*kLists[kind]) {
      CellName one;
      one.*kNames[kind] = name;
      check_name(one, names, here);
    }
  }
}

std::vector<Judgement> judge(const StudyResults& results, const std::string& variant) {
  std::vector<Judgement> judged;
  for (const Expectation& expectation : results.expect)
    judged.push_back(Judge(results, expectation, variant).judge(variant));
  return judged;
}

std::vector<Judgement> shortfalls(const StudyResults& results) {
  std::vector<Judgement> found;
  for (const std::string& variant : variants_of(results)) {
    for (Judgement& judged : judge(results, variant)) {
      if (judged.holds == false) found.push_back(std::move(judged));
    }
  }
  return found;
}

std::optional<double> reference_of(const StudyResults& results, const std::string& world,
                                   const std::string& sensor, const std::string& algorithm,
                                   const std::string& figure) {
  const auto fits = [](const std::string& pattern, const std::string& name) {
    return pattern.empty() || pattern == name;
  };
  for (const ReferenceFigure& known : results.reference) {
    if (known.figure == figure && fits(known.world, world) && fits(known.sensor, sensor) &&
        fits(known.algorithm, algorithm)) {
      return known.value;
    }
  }
  return std::nullopt;
}

}  // namespace lidarena::results
