// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lidarena/report/table.hpp"
#include "lidarena/results/study_cells.hpp"

namespace lidarena::report {

/// Figures of F. Vultaggio, F. d'Apolito, C. Sulzbachner, P. Fanta-Jende, "Simulation of low-cost
/// MEMS-LiDAR and analysis of its effect on the performances of state-of-the-art SLAMs", 2023.
enum class PaperTable {
  kDrift,     ///< Table 2: RMSE of the drift, cm per 1 m
  kOutliers,  ///< Table 4: points beyond 20 cm, %
  kMapRmse    ///< Table 5: RMSE of the point-to-mesh distance, cm
};

/// The paper's own figure; empty if it has none. Names are the paper's (see study_cells.hpp).
std::optional<double> paper_figure(PaperTable table, const std::string& world,
                                   const std::string& sensor, const std::string& algorithm);

/// The increase of the drift from `cave` to `house`, as in the paper's Table 3: (house - cave) /
/// house, in percent. This definition was found by computing Table 3 from Table 2 in both ways.
double drift_increase_of_the_paper(double cave, double house);
/// The usual definition: (house - cave) / cave, in percent.
double drift_increase(double cave, double house);

/// Tables 1 to 5 from the runs of one preset, with the paper's own figures beside ours where it has
/// any. Worlds that are not in the paper get tables of the same form.
std::vector<ReportTable> paper_tables(const results::StudyResults& results,
                                      const std::string& preset);

}  // namespace lidarena::report
