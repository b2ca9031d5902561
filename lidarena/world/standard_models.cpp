// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/standard_models.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cctype>
#include <sstream>
#include <string_view>

#include "lidarena/base/error.hpp"

namespace lidarena::world {

namespace {

constexpr std::string_view kGroundPlane =
    "<?xml version='1.0'?><sdf version='1.6'><model name='ground_plane'><static>true</static>"
    "<link name='link'><collision name='collision'><geometry><plane><normal>0 0 1</normal>"
    "<size>100 100</size></plane></geometry></collision><visual name='visual'><geometry><plane>"
    "<normal>0 0 1</normal><size>100 100</size></plane></geometry></visual></link></model></sdf>";

/// The name of the model: the part after "models" if there is one (as in the URLs of Fuel), else
/// the first part.
std::string model_name(const std::string& uri) {
  const std::size_t scheme = uri.find("://");
  std::istringstream parts(scheme == std::string::npos ? uri : uri.substr(scheme + 3));
  std::string first, part;
  while (std::getline(parts, part, '/')) {
    if (part == "models" && std::getline(parts, part, '/')) return part;
    if (first.empty()) first = part;
  }
  return first;
}

/// Letters and digits in lower case, without "%20".
std::string plain(std::string name) {
  for (std::size_t at = name.find("%20"); at != std::string::npos; at = name.find("%20"))
    name.erase(at, 3);
  std::string letters;
  for (const unsigned char c : name) {
    if (std::isalnum(c) != 0) letters += static_cast<char>(std::tolower(c));
  }
  return letters;
}

}  // namespace

StandardModel standard_model(const std::string& uri) {
  const std::string name = plain(model_name(uri));
  if (name == "sun") return StandardModel::kSun;
  return name == "groundplane" ? StandardModel::kGroundPlane : StandardModel::kNone;
}

GroundPlaneFile::GroundPlaneFile() : descriptor_(memfd_create("ground_plane.sdf", MFD_CLOEXEC)) {
  const auto size = static_cast<ssize_t>(kGroundPlane.size());
  if (descriptor_ < 0 || write(descriptor_, kGroundPlane.data(), kGroundPlane.size()) != size)
    throw Error("the ground plane cannot be put into memory");
}

GroundPlaneFile::~GroundPlaneFile() { close(descriptor_); }

std::filesystem::path GroundPlaneFile::path() const {
  return "/proc/self/fd/" + std::to_string(descriptor_);
}

}  // namespace lidarena::world
