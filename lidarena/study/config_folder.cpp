// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/config_folder.hpp"

#include <algorithm>

#include "lidarena/base/config.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena::study {

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
  // a folder that has the same name as, say, a world must not hide that world
  if (fs::exists(name_or_path) && !fs::is_directory(name_or_path)) return name_or_path;
  const fs::path file = root_ / kind / (name_or_path + ".yaml");
  if (fs::exists(file)) return file;
  const std::vector<std::string> known = names(kind);
  const std::string nearest = nearest_word(name_or_path, known);
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
  throw InputError(name_or_path, "is neither a file nor a name in " + kind,
                   nearest.empty() ? "known: " + list : "did you mean '" + nearest + "'?");
}

}  // namespace lidarena::study
