// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/results/run_record.hpp"

namespace lidarena::results {

/// If more of a map's points than this lie beyond 20 cm, tracking counts as lost.
constexpr double kTrackingLostOutliers_percent = 50.0;

using RowFigure = std::function<std::optional<double>(const RunRecord&)>;

/// The runs of a study by world, sensor and algorithm. Figures are medians over flights and seeds
/// of the runs that have them; status_text() says how many do not.
class StudyCells {
 public:
  /// Takes the runs of one variant (see variant_of()); empty = all. `results` must outlive this.
  StudyCells(const StudyResults& results, const std::string& variant);

  std::vector<std::string> worlds() const;
  std::vector<std::string> sensors() const;
  std::vector<std::string> algorithms() const;
  std::vector<std::string> presets() const;
  std::vector<std::string> modes() const;
  std::vector<const RunRecord*> rows(const std::string& world, const std::string& sensor,
                                     const std::string& algorithm) const;
  std::optional<double> median(const std::string& world, const std::string& sensor,
                               const std::string& algorithm, const RowFigure& figure) const;
  std::optional<double> median(const std::string& world, const std::string& sensor,
                               const std::string& algorithm, const Figure& figure) const;
  /// How many runs of a cell did not succeed ("1 of 3 diverged"); empty if all did.
  std::string status_text(const std::string& world, const std::string& sensor,
                          const std::string& algorithm) const;

 private:
  std::vector<const RunRecord*> rows_;
};

/// All readings in the order of their first use, but those of the preset `indoor` first. Methods
/// without presets belong to every reading.
std::vector<std::string> variants_of(const StudyResults& results);

}  // namespace lidarena::results
