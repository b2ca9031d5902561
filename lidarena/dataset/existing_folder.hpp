// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace lidarena::dataset {

/// The folder itself, absolute, or the nearest one above it that exists: on whose disk it will be.
inline std::filesystem::path existing_folder(const std::filesystem::path& folder) {
  std::filesystem::path place = std::filesystem::absolute(folder);
  while (!std::filesystem::exists(place) && place.has_relative_path()) place = place.parent_path();
  return place;
}

}  // namespace lidarena::dataset
