// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/sdf_state.hpp"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <sstream>

#include "lidarena/world/sdf_text.hpp"

namespace lidarena::world {
namespace {

/// Roll, pitch and yaw turn about the fixed axes x, y, z, one after the other.
std::optional<Pose> parse_pose(std::string_view text) {
  std::istringstream words{std::string(text)};
  std::array<double, 6> v{};
  for (double& value : v) words >> value;
  if (!words) return std::nullopt;
  const Eigen::Quaterniond rotation = Eigen::AngleAxisd(v[5], Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(v[4], Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(v[3], Eigen::Vector3d::UnitX());
  return make_pose(rotation, {v[0], v[1], v[2]});
}

bool is_unit_scale(std::string_view text) {
  std::istringstream words{std::string(text)};
  double x = 1.0, y = 1.0, z = 1.0;
  words >> x >> y >> z;
  return x == 1.0 && y == 1.0 && z == 1.0;
}

/// Reads the elements within `content`; `scope` is the model that they are in, "" or "name::".
void read_state(std::string_view content, const std::string& scope, SavedState& state) {
  std::size_t at = 0;
  while (const auto element = next_element(content, at)) {
    at = element->end;
    const std::string_view inner =
        content.substr(element->content_begin, element->content_end - element->content_begin);
    if (element->name != "model" && element->name != "link") continue;
    const std::string name = scope + std::string(element->attribute("name"));
    const auto pose = child_text(inner, "pose");
    const auto parsed = pose ? parse_pose(*pose) : std::nullopt;
    if (element->name == "link") {
      if (parsed) state.links[name] = *parsed;
      continue;
    }
    if (parsed) state.models[name] = *parsed;
    const auto scale = child_text(inner, "scale");
    if (scale && !is_unit_scale(*scale)) state.has_scales = true;
    read_state(inner, name + "::", state);
  }
}

}  // namespace

SavedState saved_state(std::string_view sdf_text) {
  SavedState state;
  for (const Element& element : all_elements(sdf_text, "state")) {
    state = {};
    read_state(sdf_text.substr(element.content_begin, element.content_end - element.content_begin),
               "", state);
  }
  return state;
}

std::vector<std::string> unsupported_elements(std::string_view sdf_text) {
  std::vector<std::string> found;
  for (const char* name : {"actor", "population", "road"}) {
    if (const std::size_t count = all_elements(sdf_text, name).size(); count > 0)
      found.push_back(fmt::format("{} <{}>", count, name));
  }
  return found;
}

}  // namespace lidarena::world
