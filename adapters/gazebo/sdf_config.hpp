// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <sdf/sdf.hh>
#include <string>
#include <type_traits>
#include <vector>

#include "lidarena/base/config.hpp"

namespace lidarena::gazebo_plugin {

/// Reads the elements inside a <plugin> like a configuration file, with the same errors: for an
/// unknown element the most similar known one is named. Elements that contain others (<ray>,
/// <noise>) are skipped.
template <class Config>
Config read_sdf_config(const sdf::ElementPtr& plugin, const std::string& place) {
  std::vector<std::string>
      booleans;  // names of boolean fields: SDF converts their values to 0 and 1
  Config config;
  Config::visit(config, [&](const char* name, auto& field, auto&&...) {
    if (std::is_same_v<decltype(field), bool&>) booleans.emplace_back(name);
  });
  std::string yaml;
  for (auto element = plugin->GetFirstElement(); element; element = element->GetNextElement("")) {
    if (element->GetFirstElement() || !element->GetValue()) continue;
    std::string value = element->GetValue()->GetAsString();
    if (std::find(booleans.begin(), booleans.end(), element->GetName()) != booleans.end()) {
      if (value == "1") value = "true";
      if (value == "0") value = "false";
    }
    for (std::size_t at = 0; (at = value.find('\'', at)) != std::string::npos; at += 2) {
      value.insert(at, 1, '\'');
    }
    yaml += element->GetName() + ": '" + value + "'\n";
  }
  if (!yaml.empty()) read_config(ConfigNode::parse(yaml, place), config);
  return config;
}

}  // namespace lidarena::gazebo_plugin
