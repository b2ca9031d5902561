// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace lidarena::world {

/// The models that nearly every Gazebo world includes, by URL or as model://NAME.
enum class StandardModel { kNone, kSun, kGroundPlane };

/// The standard model that an <include> with this URI means, judged by the model's name alone: the
/// host, the owner, a version, capitals, and blanks, "%20", "_" or "-" within the name do not
/// matter.
StandardModel standard_model(const std::string& uri);

/// Gazebo's ground plane, 100 m x 100 m at z = 0 facing up, as an SDF file in memory.
class GroundPlaneFile {
 public:
  /// Throws Error if the system refuses a file in memory.
  GroundPlaneFile();
  ~GroundPlaneFile();
  GroundPlaneFile(const GroundPlaneFile&) = delete;
  GroundPlaneFile& operator=(const GroundPlaneFile&) = delete;

  /// Exists as long as this object.
  std::filesystem::path path() const;

 private:
  int descriptor_;
};

}  // namespace lidarena::world
