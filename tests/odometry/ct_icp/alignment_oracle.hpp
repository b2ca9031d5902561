// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/odometry/ct_icp/alignment.hpp"

namespace lidarena::odometry::ct_icp::oracle {

/// Minimizes the cost of alignment.hpp with Ceres: Levenberg-Marquardt with automatic
/// differentiation, so that neither residuals nor derivatives are shared with the library. Stops
/// after `iterations` or when a step lowers the cost by less than 1e-6 of it.
ElasticMotion align_by_ceres(const ElasticProblem& problem, const ElasticMotion& motion,
                             int iterations);

}  // namespace lidarena::odometry::ct_icp::oracle
