// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <sdf/sdf.hh>
#include <string>
#include <type_traits>
#include <vector>

#include "adapters/gazebo/plugin/plugin_config.hpp"
#include "lidarena/base/config.hpp"

namespace lidarena::gazebo_plugin {

/// Reads the elements inside a <plugin> like a configuration file over the values of `config`, with
/// the same errors: for an unknown element the most similar known one is named. Elements that
/// contain others (<ray>, <noise>) are skipped. `plugin`: a pointer to an sdf::Element, const or
/// not.
template <class Config, class ElementPointer>
Config read_sdf_config(const ElementPointer& plugin, const std::string& place, Config config = {}) {
  std::vector<std::string>
      booleans;  // names of boolean fields: SDF converts their values to 0 and 1
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

/// The first element of this name inside `owner`; nullptr if there is none.
template <class ElementPointer>
sdf::ElementPtr find_child(const ElementPointer& owner, const std::string& name) {
  sdf::ElementPtr child = owner->GetFirstElement();
  while (child && child->GetName() != name) child = child->GetNextElement("");
  return child;
}

/// Takes the limits (m) of the <range> of the <ray> or <lidar> inside `owner`, if it has one.
template <class ElementPointer>
void read_range(const ElementPointer& owner, SensorElement& element) {
  sdf::ElementPtr ray = find_child(owner, "ray");
  if (!ray) ray = find_child(owner, "lidar");
  const sdf::ElementPtr range = ray ? find_child(ray, "range") : nullptr;
  if (!range) return;
  const auto read = [&](const char* name, double& limit) {
    const sdf::ElementPtr value = find_child(range, name);
    if (value) limit = std::stod(value->GetValue()->GetAsString());
  };
  read("min", element.min_range);
  read("max", element.max_range);
}

}  // namespace lidarena::gazebo_plugin
