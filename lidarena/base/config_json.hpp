// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config.hpp"

/// Structs with a list of fields (see config.hpp) as JSON. JSON is valid YAML, so read_config()
/// reads a configuration back; read_json() reads files of results, which may be large.
namespace lidarena {

using Json = nlohmann::ordered_json;

/// Any value of a configuration: a scalar is a boolean, a number or null if it can be read as one,
/// else a string.
Json json_of(const ConfigNode& node);
inline void read_value(const ConfigNode& node, Json& out, const Limits&) { out = json_of(node); }

/// The value of a key, which may be a path ("group.key"); null if there is none.
Json value_at(const Json& config, std::string_view key);

/// Null if the struct has a function empty() that is true. Fields with their default value are left
/// out if the struct has kOmitsDefaults.
template <ConfigStruct C>
Json to_json(const C& config);

template <class T>
Json value_to_json(const std::optional<T>& value);
template <class T>
Json value_to_json(const std::vector<T>& values);
template <class T, std::size_t size>
Json value_to_json(const std::array<T, size>& values);

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

template <class T, std::size_t size>
Json value_to_json(const std::array<T, size>& values) {
  Json list = Json::array();
  for (const T& value : values) list.push_back(value_to_json(value));
  return list;
}

template <ConfigStruct C>
Json to_json(const C& config) {
  if constexpr (requires {
                  { config.empty() } -> std::same_as<bool>;
                }) {
    if (config.empty()) return nullptr;
  }
  Json json = Json::object();
  C::visit(config,
           [&](std::string_view name, const auto& member, std::string_view, std::string_view,
               Limits = {}) { json[std::string(name)] = value_to_json(member); });
  if constexpr (requires { C::kOmitsDefaults; }) {
    const C defaults{};
    C::visit(defaults, [&](std::string_view name, const auto& member, auto&&...) {
      const auto field = json.find(std::string(name));
      if (*field == value_to_json(member)) json.erase(field);
    });
  }
  return json;
}

/// Overwrites the fields of `out` that `json` has; a null, and a key that `out` does not list,
/// change nothing. Throws InputError naming `place` and the key when a value has another type.
template <ConfigStruct C>
void read_json(const Json& json, C& out, const std::string& place);

template <class T>
void value_from_json(const Json& json, T& out, const std::string& place);
template <class T>
void value_from_json(const Json& json, std::optional<T>& out, const std::string& place);
template <class T>
void value_from_json(const Json& json, std::vector<T>& out, const std::string& place);
template <class T, std::size_t size>
void value_from_json(const Json& json, std::array<T, size>& out, const std::string& place);

template <class T>
void value_from_json(const Json& json, T& out, const std::string& place) {
  if (json.is_null()) return;
  if constexpr (ConfigStruct<T>) {
    read_json(json, out, place);
  } else if constexpr (std::is_enum_v<T>) {
    for (const auto& [name, candidate] : enum_names(T{})) {
      if (json == name) out = candidate;
    }
  } else {
    try {
      json.get_to(out);
    } catch (const Json::exception&) {
      throw InputError(place, "has a value of another type: " + json.dump().substr(0, 40));
    }
  }
}

inline void value_from_json(const Json& json, Pose& out, const std::string& place) {
  std::array<double, 7> v{};
  value_from_json(json, v, place);
  out = make_pose(Eigen::Quaterniond(v[6], v[3], v[4], v[5]), {v[0], v[1], v[2]});
}

template <class T>
void value_from_json(const Json& json, std::optional<T>& out, const std::string& place) {
  if (json.is_null()) return out.reset();
  value_from_json(json, out.emplace(), place);
}

template <class T>
void value_from_json(const Json& json, std::vector<T>& out, const std::string& place) {
  if (!json.is_array()) throw InputError(place, "is not a list");
  out.assign(json.size(), T{});
  for (std::size_t i = 0; i < json.size(); ++i) value_from_json(json[i], out[i], place);
}

template <class T, std::size_t size>
void value_from_json(const Json& json, std::array<T, size>& out, const std::string& place) {
  if (!json.is_array() || json.size() != size) {
    throw InputError(place, "is not a list of " + std::to_string(size) + " values");
  }
  for (std::size_t i = 0; i < size; ++i) value_from_json(json[i], out[i], place);
}

template <ConfigStruct C>
void read_json(const Json& json, C& out, const std::string& place) {
  if (json.is_null()) return;
  if (!json.is_object()) throw InputError(place, "is not an object with keys");
  C::visit(out, [&](std::string_view name, auto& member, auto&&...) {
    const auto found = json.find(std::string(name));
    if (found != json.end()) value_from_json(*found, member, place + ": " + std::string(name));
  });
}

}  // namespace lidarena
