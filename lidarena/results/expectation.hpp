// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lidarena::results {

struct StudyResults;

/// Cells of a study by their names; an empty list stands for all.
struct CellFilter {
  std::vector<std::string> world, sensor, algorithm;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("world", self.world, "", "names; none = all");
    v("sensor", self.sensor, "", "names; none = all");
    v("algorithm", self.algorithm, "", "names; none = all");
  }
};

/// One world, one sensor or one algorithm; the other two are empty.
struct CellName {
  std::string world, sensor, algorithm;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("world", self.world, "", "name of a world, or");
    v("sensor", self.sensor, "", "of a sensor, or");
    v("algorithm", self.algorithm, "", "of an algorithm");
  }
};

/// A figure of one world, sensor or algorithm, divided by that of another one.
struct FigureRatio {
  CellName of, to;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("of", self.of, "", "the world, sensor or algorithm of the numerator");
    v("to", self.to, "", "that of the denominator");
  }
};

enum class Extent { kAll, kSome };
constexpr auto enum_names(Extent) {
  return std::array{std::pair{"all", Extent::kAll}, std::pair{"some", Extent::kSome}};
}

/// What the figures of a study should show: a finding of others that is put to the test, or what a
/// change to an algorithm must not break. A figure of a cell is the median over flights and seeds,
/// in which lost runs are the worst; a ratio of two lost cells is not judged.
struct Expectation {
  std::string finding;
  std::string figure;
  CellFilter where;
  std::optional<FigureRatio> ratio;
  std::optional<CellName> lowest, highest;
  std::optional<double> above, below;
  Extent cells = Extent::kAll;
  std::string rule, otherwise;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("finding", self.finding, "", "in words");
    v("figure", self.figure, "", "key of a figure, see docs/metrics.md");
    v("where", self.where, "", "the cells that count");
    v("ratio", self.ratio, "", "judge this ratio of the figure instead of the figure");
    v("lowest", self.lowest, "", "this one has the lowest value, beside all others of its kind");
    v("highest", self.highest, "", "this one has the highest value");
    v("above", self.above, "", "the value is larger than this, in the figure's unit");
    v("below", self.below, "", "the value is smaller than this, in the figure's unit");
    v("cells", self.cells, "", "whether all or only some of the cells must meet it");
    v("rule", self.rule, "", "what is checked, in words");
    v("otherwise", self.otherwise, "", "a possible reason if it falls short");
  }
};

/// Throws InputError at `place` if the expectation is incomplete or names a figure, or a cell of
/// `names`, that does not exist.
void check(const Expectation& expectation, const CellFilter& names, const std::string& place);

/// An expectation, judged by the runs of one variant.
struct Judgement {
  Expectation expectation;
  std::string variant;
  std::optional<bool> holds;  ///< empty: these runs cannot tell; the evidence says why
  std::vector<std::string> evidence;
};

/// All expectations of the study, for one variant (see variants_of()).
std::vector<Judgement> judge(const StudyResults& results, const std::string& variant);
/// Those of all variants that fall short.
std::vector<Judgement> shortfalls(const StudyResults& results);

/// A figure that somebody else has published; empty names stand for all.
struct ReferenceFigure {
  static constexpr const char* kTitle = "ReferenceFigure";
  std::string world, sensor, algorithm, figure;
  double value = 0.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("world", self.world, "", "");
    v("sensor", self.sensor, "", "");
    v("algorithm", self.algorithm, "", "");
    v("figure", self.figure, "", "key of a figure, or of a property of a sensor");
    v("value", self.value, "", "in the figure's unit");
  }
};

/// The published figure of a cell; empty if there is none.
std::optional<double> reference_of(const StudyResults& results, const std::string& world,
                                   const std::string& sensor, const std::string& algorithm,
                                   const std::string& figure);

}  // namespace lidarena::results
