// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/dataset/points/cloud.hpp"

namespace lidarena {

/// Scores of a map without a mesh: how far it agrees with itself and, if `reference` (a file) is
/// not empty, against that cloud, after `reference_from_map` was applied. One JSON object.
Json cloud_scores(const dataset::Cloud& map, const std::string& reference,
                  const Pose& reference_from_map, const Parallel& parallel);
/// The same for people.
std::string cloud_text(const Json& scores);

}  // namespace lidarena
