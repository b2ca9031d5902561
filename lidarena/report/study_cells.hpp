// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/report/result_table.hpp"

namespace lidarena {

/// Of a map's points, beyond 20 cm: the track was lost.
constexpr double kLostMap_percent = 50.0;

using RowFigure = std::function<std::optional<double>(const ResultRow&)>;

std::optional<double> rpe_of(const ResultRow& row);       ///< cm per m
std::optional<double> outliers_of(const ResultRow& row);  ///< %, of the published map
std::optional<double> map_rmse_of(const ResultRow& row);  ///< cm, of the published map

/// The runs of a study, asked by what was run. Figures are medians over flights and seeds of the
/// runs that have them; how many have not, status_text() says.
class StudyCells {
 public:
  /// Of one reading (see reading_of()); empty = all. `results` must outlive this.
  StudyCells(const Results& results, const std::string& reading);

  std::vector<std::string> worlds() const;
  std::vector<std::string> sensors() const;
  std::vector<std::string> algorithms() const;
  std::vector<std::string> presets() const;
  std::vector<std::string> modes() const;
  std::vector<const ResultRow*> rows(const std::string& world, const std::string& sensor,
                                     const std::string& algorithm) const;
  std::optional<double> median(const std::string& world, const std::string& sensor,
                               const std::string& algorithm, const RowFigure& figure) const;
  /// What went wrong in a cell, in a few words ("1 of 3 diverged"); empty when nothing did.
  std::string status_text(const std::string& world, const std::string& sensor,
                          const std::string& algorithm) const;

 private:
  std::vector<const ResultRow*> rows_;
};

/// Readings in the order of their first use, of the preset `original` first: it is the one to
/// compare with the paper.
std::vector<std::string> readings_of(const Results& results);

/// The paper's name of a world ("Cave", "House"), sensor ("Mid-360", "Os0-128") or algorithm
/// ("Fast LIO2"); empty where the paper has none. Worlds and sensors are told by how their names
/// begin or what they hold: cave..., house..., ...mid360..., ...os0...
std::string paper_world(const std::string& world);
std::string paper_sensor(const std::string& sensor);
std::string paper_algorithm(const std::string& algorithm);

}  // namespace lidarena
