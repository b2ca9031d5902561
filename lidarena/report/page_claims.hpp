// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lidarena/results/claims.hpp"
#include "lidarena/results/study_cells.hpp"
#include "lidarena/results/table.hpp"

namespace lidarena::report {

/// The tests behind the tables of a page, corrected together: within each world between the cells
/// of a row and of a column, and over all worlds for the tables of ratios.
class PageClaims {
 public:
  using Figures = std::span<const results::Figure* const>;

  PageClaims(const results::StudyCells& cells, Figures within_worlds, Figures over_worlds);

  /// Whether a cell is better, by the runs of this world, than with each other method (or sensor).
  bool is_best(const results::Figure& figure, const std::string& world, const std::string& sensor,
               const std::string& algorithm, bool among_methods) const;
  /// On how many pairs the tests of one figure within a world rest.
  std::string words(const results::Figure& figure, const std::string& world) const;
  /// How many tests were corrected for.
  std::size_t tests() const;
  /// Tables of the ratios over all worlds with their intervals: for each sensor a method (row) by
  /// each other one, and for each method a sensor by each other one. Empty where no ratio has an
  /// interval.
  std::vector<results::Table> ratio_tables(const results::Figure& figure,
                                           const std::string& variant) const;

 private:
  struct Cell {
    std::string sensor, algorithm;
    bool operator==(const Cell&) const = default;
  };
  struct Test {
    const results::Figure* figure;
    std::string world;  ///< empty: over all
    Cell a, b;
  };

  void add(const results::StudyCells& cells, const results::Figure& figure,
           const std::string& world, std::vector<results::Contest>& contests);
  /// Ratio of `of` to `to`, bold where it is better.
  results::TableCell ratio_cell(const results::Figure& figure, const Cell& of,
                                const Cell& to) const;
  results::Table matrix(const results::Figure& figure, const std::string& fixed,
                        bool of_methods) const;

  std::vector<std::string> sensors_, algorithms_;
  std::vector<Test> tests_;
  std::vector<results::Claim> claims_;
};

}  // namespace lidarena::report
