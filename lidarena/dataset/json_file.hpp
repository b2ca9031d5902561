// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/base/config_json.hpp"

namespace lidarena::dataset {

/// Throws InputError naming file and byte when it is missing or is not JSON.
Json read_json(const std::filesystem::path& file);
/// Indented by two, with a final newline. Throws Error when the disk is full.
void write_json(const std::filesystem::path& file, const Json& json);

}  // namespace lidarena::dataset
