// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/origin.hpp"

#include <fmt/format.h>

namespace lidarena {

std::string origin_of(const std::filesystem::path& program) {
  const std::filesystem::path above = program.parent_path().parent_path();
  const std::filesystem::path two_above = above.parent_path();
  if (exists(two_above / "CMakeCache.txt")) return "the build in " + two_above.string();
  if (exists(two_above / fmt::format("lidarena-{}.dist-info", LIDARENA_VERSION)))
    return "the Python package in " + two_above.string();
  if (above == "/usr" && std::filesystem::exists("/var/lib/dpkg/info/lidarena.list"))
    return "the Debian package lidarena";
  return "the installation in " + above.string();
}

}  // namespace lidarena
