// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "lidarena/results/claims.hpp"
#include "lidarena/results/run_record.hpp"
#include "lidarena/results/statistics.hpp"
#include "lidarena/results/table.hpp"

namespace lidarena::results {

/// The runs of a study's base by world, sensor and algorithm: its cells. Lost runs (lost.hpp) are
/// the worst of their cell. Runs of its variations are in report/sweep_tables.hpp.
class StudyCells {
 public:
  /// Takes the runs of one variant (see variant_of()); empty = all. `results` must outlive this.
  StudyCells(const StudyResults& results, const std::string& variant);

  std::vector<std::string> worlds() const;
  std::vector<std::string> sensors() const;
  std::vector<std::string> algorithms() const;
  std::vector<std::string> presets() const;
  std::vector<std::string> modes() const;
  /// The runs of a cell; of all worlds if `world` is empty.
  Runs rows(const std::string& world, const std::string& sensor,
            const std::string& algorithm) const;
  /// A figure over flights and seeds, without an interval.
  Spread spread(const std::string& world, const std::string& sensor, const std::string& algorithm,
                const Figure& figure) const;
  /// The spread as text; of the drift also the live one; of lost runs that ended themselves when.
  /// The state of the runs where there is no figure.
  TableCell cell(const std::string& world, const std::string& sensor, const std::string& algorithm,
                 const Figure& figure) const;
  /// "ended at 4.6 s [3.5]" if all lost runs of a cell ended themselves: the medians of the time
  /// and, if `figure` is the drift, of the drift until then. Empty otherwise.
  std::string ended_text(const std::string& world, const std::string& sensor,
                         const std::string& algorithm, const Figure& figure) const;
  /// How many runs of a cell are lost, by their state ("1 of 3 diverged"); empty if none is.
  std::string status_text(const std::string& world, const std::string& sensor,
                          const std::string& algorithm) const;

 private:
  Runs rows_;
};

/// All readings in the order of their first use, but those of the preset `indoor` first. Methods
/// without presets belong to every reading.
std::vector<std::string> variants_of(const StudyResults& results);

}  // namespace lidarena::results
