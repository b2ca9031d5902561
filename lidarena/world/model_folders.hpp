// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lidarena::world {

/// The folders in which `model://NAME/...` is searched, in order.
class ModelFolders {
 public:
  /// Relative to the world file: ../models, models, its own folder and the one above; then
  /// `further`; then those of the environment variable GAZEBO_MODEL_PATH (separated by colons).
  ModelFolders(const std::filesystem::path& world_file,
               const std::vector<std::filesystem::path>& further);

  /// The file or folder that `uri` refers to: model://NAME/..., package://NAME/..., file://PATH or
  /// a plain path. Relative file:// and plain paths are searched in `base` first. Empty when there
  /// is no such file or folder. Escapes (my%20house) are resolved where no file has them in its
  /// name.
  std::optional<std::filesystem::path> find(const std::string& uri,
                                            const std::filesystem::path& base) const;

  /// The folders, separated by commas.
  std::string listed() const;

 private:
  std::optional<std::filesystem::path> find_as_it_is(const std::string& uri,
                                                     const std::filesystem::path& base) const;

  std::vector<std::filesystem::path> folders_;
};

}  // namespace lidarena::world
