// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/stages/config_folder.hpp"

namespace lidarena::study {

inline const std::filesystem::path kConfigs = LIDARENA_SOURCE_DIR "/configs";
inline stages::ConfigFolder configs() { return stages::ConfigFolder(kConfigs); }

}  // namespace lidarena::study
