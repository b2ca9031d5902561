// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/config_folder.hpp"

#include <algorithm>

#include "lidarena/base/config.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/sensor/sensor_config.hpp"

namespace lidarena::stages {

namespace fs = std::filesystem;

ConfigFolder ConfigFolder::find(const fs::path& start) {
  for (fs::path folder = fs::absolute(start);; folder = folder.parent_path()) {
    for (const fs::path& candidate : {folder / "configs", folder / "share/lidarena/configs"}) {
      if (fs::is_directory(candidate / "worlds")) return ConfigFolder(candidate);
    }
    if (folder == folder.parent_path()) break;
  }
  throw InputError(start.string(), "no folder configs/ in this folder or above it",
                   "run lidarena in the project's folder or give --configs FOLDER");
}

std::vector<std::string> ConfigFolder::names(const std::string& kind) const {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(root_ / kind, none)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

fs::path ConfigFolder::resolve(const std::string& kind, const std::string& name_or_path) const {
  // A folder or a program that has the same name as, say, a study must not hide that study.
  const fs::path path = name_or_path;
  const bool is_file = fs::exists(path) && !fs::is_directory(path);
  const bool is_bare_word = !path.has_extension() && !path.has_parent_path();
  if (is_file && !is_bare_word) return path;
  const fs::path file = root_ / kind / (name_or_path + ".yaml");
  if (fs::exists(file)) return file;
  if (is_file) return path;
  const std::vector<std::string> known = names(kind);
  const std::string nearest = nearest_word(name_or_path, known);
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
  throw InputError(name_or_path, "is neither a file nor a name in " + kind,
                   nearest.empty() ? "known: " + list : "did you mean '" + nearest + "'?");
}

sensor::SensorConfig ConfigFolder::load_sensor(const std::string& name_or_path) const {
  return sensor::load_sensor(resolve("sensors", name_or_path), root_ / "sensors");
}

std::vector<fs::path> ConfigFolder::sensor_files(const std::string& name_or_path) const {
  return sensor::sensor_files(resolve("sensors", name_or_path), root_ / "sensors");
}

}  // namespace lidarena::stages
