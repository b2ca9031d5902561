// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/pose.hpp"

namespace lidarena {

/// What lays a run's estimate over the truth by its metrics.json: SE(3) over all positions where
/// that is determined, else the first pose. Empty where the metrics hold neither.
std::optional<Pose> truth_from_estimate(const Json& metrics);

}  // namespace lidarena
