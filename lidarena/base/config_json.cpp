// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/config_json.hpp"

#include <cmath>
#include <sstream>

#include "lidarena/base/number.hpp"

namespace lidarena {
namespace {

Json scalar_of(const std::string& text) {
  if (text == "true") return true;
  if (text == "false") return false;
  const std::optional<double> number = parse_number(text);
  if (!number || !std::isfinite(*number)) return text;
  Json value = Json::parse(text, nullptr, false);  // keeps whole numbers whole
  return value.is_number() ? value : Json(*number);
}

}  // namespace

Json json_of(const ConfigNode& node) {
  if (node.is_null()) return nullptr;
  if (node.is_map()) {
    Json map = Json::object();
    for (const std::string& key : node.keys()) map[key] = json_of(*node.find(key));
    return map;
  }
  if (!node.is_list()) return scalar_of(node.text());
  Json list = Json::array();
  for (const ConfigNode& item : node.items()) list.push_back(json_of(item));
  return list;
}

Json value_at(const Json& config, std::string_view key) {
  Json value = config;
  std::stringstream path{std::string(key)};
  for (std::string part; std::getline(path, part, '.');) {
    if (!value.is_object() || !value.contains(part)) return nullptr;
    value = Json(value[part]);
  }
  return value;
}

}  // namespace lidarena
