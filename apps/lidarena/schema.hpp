// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <string>

#include "lidarena/base/config_json.hpp"

namespace lidarena {

/// Functions that make the schema of each kind of YAML file, of each algorithm's configuration, and
/// of metrics.json.
std::map<std::string, std::function<Json()>> schemas();

}  // namespace lidarena
