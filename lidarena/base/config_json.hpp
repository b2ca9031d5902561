// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include "lidarena/base/config.hpp"

/// Configuration structs as JSON. JSON is valid YAML, so read_config() reads the output back.
namespace lidarena {

using Json = nlohmann::ordered_json;

template <ConfigStruct C>
Json to_json(const C& config);

template <class T>
Json value_to_json(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    for (const auto& [name, candidate] : enum_names(T{})) {
      if (candidate == value) return name;
    }
    return nullptr;
  } else if constexpr (ConfigStruct<T>) {
    return to_json(value);
  } else {
    return value;
  }
}

inline Json value_to_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

inline Json value_to_json(const Pose& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const Eigen::Vector3d t = pose.translation();
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

template <class T>
Json value_to_json(const std::optional<T>& value) {
  return value ? value_to_json(*value) : Json(nullptr);
}

template <class T>
Json value_to_json(const std::vector<T>& values) {
  Json list = Json::array();
  for (const T& value : values) list.push_back(value_to_json(value));
  return list;
}

template <ConfigStruct C>
Json to_json(const C& config) {
  Json json = Json::object();
  C::visit(config,
           [&](std::string_view name, const auto& member, std::string_view, std::string_view,
               Limits = {}) { json[std::string(name)] = value_to_json(member); });
  return json;
}

}  // namespace lidarena
