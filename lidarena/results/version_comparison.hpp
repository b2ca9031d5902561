// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lidarena/results/run_record.hpp"
#include "lidarena/results/statistics.hpp"
#include "lidarena/results/stratified.hpp"
#include "lidarena/results/table.hpp"

/// The same runs of two studies side by side: two versions of a SLAM, two settings, two machines.
namespace lidarena::results {

enum class Verdict { kBetter, kWorse, kNeither };
const char* to_string(Verdict verdict);

/// One figure of one sensor and method, over the pairs of runs on the same scene, flight and seed.
struct FigureChange {
  std::string sensor, method;
  const Figure* figure = nullptr;
  double before = 0.0, after = 0.0;  ///< medians over the pairs, infinite where half are lost
  PairedComparison paired;           ///< of which `a` is before and `b` after
  StratifiedComparison ratios;       ///< after / before, the worlds as strata
  std::optional<double> p;           ///< of `ratios`, after Holm's correction
  Verdict verdict = Verdict::kNeither;

  /// Change of the median in %, positive = worse; empty if it was zero and is not, or is lost.
  std::optional<double> worsening_percent() const;
};

/// Lost runs (lost.hpp), of those that were planned in both studies.
struct LostRuns {
  std::string sensor, method;
  std::size_t runs = 0, before = 0, after = 0;
  std::vector<std::string> newly;  ///< names of runs that were not lost before, with the reason
};

struct VersionComparison {
  std::vector<FigureChange> changes;  ///< worse ones first, then better, each by the change
  std::vector<LostRuns> lost;
  std::size_t unpaired = 0;  ///< runs of which the other study has no counterpart
  std::size_t tests = 0;     ///< figures that changed, for which the level is corrected

  /// The fewest pairs of which the test can say anything if all of them changed alike.
  std::size_t pairs_needed() const;
};

/// Pairs each run of `after` with that of `before` on the same world, flight, mode and seed, with
/// the same sensor and method; studies of a single method are compared whatever it is called. A
/// figure is better or worse if the test of stratified.hpp says so at kLevel, after Holm's
/// correction for the number of figures.
/// Throws InputError if no two runs are pairs.
VersionComparison compare_versions(const StudyResults& before, const StudyResults& after);

Table table_of(const VersionComparison& comparison);
Json to_json(const VersionComparison& comparison);
/// Both tables in words, for a terminal.
std::string comparison_text(const VersionComparison& comparison);

/// How much worse a figure may get.
struct ChangeLimit {
  std::string text;                ///< as given
  const Figure* figure = nullptr;  ///< null: runs that are lost
  double limit = 0.0;              ///< in the figure's unit, or runs
  bool in_percent = false;
};
/// "FIGURE=LIMIT" with a figure's key or drift, map, outliers, cpu, memory, lost; LIMIT a
/// number in the figure's unit or "N%". Throws InputError.
ChangeLimit parse_limit(const std::string& text);
/// One line for each sensor and method whose median, or number of lost runs, grew beyond a limit.
std::vector<std::string> exceeded(const VersionComparison& comparison,
                                  const std::vector<ChangeLimit>& limits);

}  // namespace lidarena::results
