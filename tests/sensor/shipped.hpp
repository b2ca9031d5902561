// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "lidarena/base/parallel.hpp"

namespace lidarena::sensor {

inline const std::filesystem::path kConfigs = LIDARENA_SOURCE_DIR "/configs/sensors";
inline const Parallel kOneThread(1);

}  // namespace lidarena::sensor
