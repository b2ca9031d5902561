// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lidarena/report/study_cells.hpp"
#include "lidarena/report/table.hpp"

namespace lidarena {

/// Figures of F. Vultaggio, F. d'Apolito, C. Sulzbachner, P. Fanta-Jende, "Simulation of low-cost
/// MEMS-LiDAR and analysis of its effect on the performances of state-of-the-art SLAMs", 2023.
enum class PaperTable {
  kDrift,     ///< Table 2: RMSE of the drift, cm per 1 m
  kOutliers,  ///< Table 4: points beyond 20 cm, %
  kMapRmse    ///< Table 5: RMSE of the point-to-mesh distance, cm
};

/// The paper's own figure; empty where it has none. Names are the paper's (see study_cells.hpp).
std::optional<double> paper_figure(PaperTable table, const std::string& world,
                                   const std::string& sensor, const std::string& algorithm);

/// The increase of the drift from `cave` to `house`, as the paper's Table 3 has it: (house - cave)
/// / house, in per cent. That its figures are so divided was found by trying both on its Table 2.
double drift_increase_of_the_paper(double cave, double house);
/// The usual one: (house - cave) / cave, in per cent.
double drift_increase(double cave, double house);

/// Tables 1 to 5 made from the runs of one preset, the paper's own figures beside ours where it has
/// them. Worlds that the paper has not get tables of the same shape.
std::vector<ReportTable> paper_tables(const Results& results, const std::string& preset);

}  // namespace lidarena
