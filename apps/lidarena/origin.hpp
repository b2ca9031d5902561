// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace lidarena {

/// What the file of this `program` (absolute path) belongs to, in words: a build, a Python package
/// (pip, wheel), a Debian package, or an installation by CMake.
std::string origin_of(const std::filesystem::path& program);

}  // namespace lidarena
