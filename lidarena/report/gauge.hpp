// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/pose.hpp"

namespace lidarena::report {

/// The alignment of a run's estimate to the truth, from its metrics.json: SE(3) over all positions
/// where that is determined, else the first pose. Empty if the metrics hold neither.
std::optional<Pose> truth_from_estimate(const Json& metrics);

}  // namespace lidarena::report
