// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/model_folders.hpp"

#include <charconv>
#include <cstdlib>
#include <sstream>

namespace lidarena::world {

namespace fs = std::filesystem;

namespace {

/// With each %20 and the like as the character that it stands for (RFC 3986, 2.1).
std::string without_escapes(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned value = 0;
    const char* digits = uri.data() + i + 1;
    const bool is_escape = uri[i] == '%' && i + 2 < uri.size() &&
                           std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2;
    text += is_escape ? static_cast<char>(value) : uri[i];
    if (is_escape) i += 2;
  }
  return text;
}

}  // namespace

ModelFolders::ModelFolders(const fs::path& world_file, const std::vector<fs::path>& further) {
  const fs::path here = fs::absolute(world_file).lexically_normal().parent_path();
  folders_ = {here.parent_path() / "models", here / "models", here, here.parent_path()};
  folders_.insert(folders_.end(), further.begin(), further.end());
  if (const char* variable = std::getenv("GAZEBO_MODEL_PATH")) {
    std::istringstream paths(variable);
    for (std::string path; std::getline(paths, path, ':');) {
      if (!path.empty()) folders_.emplace_back(path);
    }
  }
}

std::optional<fs::path> ModelFolders::find(const std::string& uri, const fs::path& base) const {
  if (auto path = find_as_it_is(uri, base)) return path;
  const std::string plain = without_escapes(uri);
  return plain == uri ? std::nullopt : find_as_it_is(plain, base);
}

std::optional<fs::path> ModelFolders::find_as_it_is(const std::string& uri,
                                                    const fs::path& base) const {
  const std::size_t colon = uri.find("://");
  const std::string scheme = colon == std::string::npos ? "" : uri.substr(0, colon);
  const fs::path path = colon == std::string::npos ? uri : uri.substr(colon + 3);
  if (!scheme.empty() && scheme != "model" && scheme != "package" && scheme != "file") {
    return std::nullopt;  // other schemes, for example https
  }
  std::error_code ignored;
  if (path.empty()) return std::nullopt;
  if (path.is_absolute()) {
    return fs::exists(path, ignored) ? std::optional(path) : std::nullopt;
  }
  if (scheme.empty() || scheme == "file") {
    if (fs::exists(base / path, ignored)) return base / path;
  }
  for (const fs::path& folder : folders_) {
    if (fs::exists(folder / path, ignored)) return folder / path;
  }
  return std::nullopt;
}

std::string ModelFolders::listed() const {
  std::string text;
  for (const fs::path& folder : folders_) text += (text.empty() ? "" : ", ") + folder.string();
  return text;
}

}  // namespace lidarena::world
