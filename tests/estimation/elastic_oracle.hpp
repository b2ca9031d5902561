// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/estimation/elastic_alignment.hpp"

namespace lidarena::estimation::oracle {

/// Minimizes the cost of elastic_alignment.hpp with Ceres: Levenberg-Marquardt with automatic
/// differentiation, so that neither residuals nor derivatives are shared with the library. Stops
/// after `iterations` or when a step lowers the cost by less than 1e-6 of it.
ElasticMotion align_by_ceres(const ElasticProblem& problem, ElasticMotion motion, int iterations);

}  // namespace lidarena::estimation::oracle
