// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "lidarena/base/config_json.hpp"

/// Structs with a list of fields as JSON Schema (draft 2020-12), from the same lists that
/// read_config() and to_json() use. Editors use it to complete keys and to mark what read_config()
/// would reject.
namespace lidarena {

template <class T>
Json schema_of_value(const T& value, const Limits& limits);

/// JSON Schema of one struct: its keys with units, descriptions, defaults and limits; other keys
/// are not allowed. The title is the struct's kTitle, if it has one.
template <ConfigStruct C>
Json schema_of(const C& config = {}) {
  Json properties = Json::object();
  C::visit(config, [&](std::string_view name, const auto& member, std::string_view unit,
                       std::string_view doc, Limits limits = {}) {
    Json field = schema_of_value(member, limits);
    std::string text(doc);
    if (!unit.empty()) text += (text.empty() ? "[" : " [") + std::string(unit) + "]";
    if (!text.empty()) field["description"] = text;
    field["default"] = value_to_json(member);
    properties[std::string(name)] = std::move(field);
  });
  Json schema = Json::object();
  if constexpr (requires { C::kTitle; }) schema["title"] = C::kTitle;
  if constexpr (requires { C::kOmitsDefaults; })
    schema["$comment"] = "Keys with their default value are left out.";
  schema.update({{"type", "object"}, {"additionalProperties", false}, {"properties", properties}});
  return schema;
}

namespace schema {

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};

template <class T>
struct IsMap : std::false_type {};
template <class T>
struct IsMap<std::map<std::string, T>> : std::true_type {};

template <class T>
struct IsArray : std::false_type {};
template <class T, std::size_t size>
struct IsArray<std::array<T, size>> : std::true_type {};

inline Json number(const char* type, const Limits& limits) {
  Json json{{"type", type}};
  if (std::isfinite(limits.low))
    json[limits.low_open ? "exclusiveMinimum" : "minimum"] = limits.low;
  if (std::isfinite(limits.high)) json["maximum"] = limits.high;
  return json;
}

inline Json numbers(std::size_t count, const Limits& limits) {
  return {{"type", "array"},
          {"items", number("number", limits)},
          {"minItems", count},
          {"maxItems", count}};
}

}  // namespace schema

/// Schema of one value; only the type of `value` matters (and the defaults, if it is a struct).
template <class T>
Json schema_of_value(const T& value, const Limits& limits) {
  if constexpr (std::is_enum_v<T>) {
    Json names = Json::array();
    for (const auto& [name, candidate] : enum_names(T{})) names.push_back(name);
    return {{"enum", names}};
  } else if constexpr (schema::IsOptional<T>::value) {
    return {{"anyOf", {schema_of_value(typename T::value_type{}, limits), {{"type", "null"}}}}};
  } else if constexpr (schema::IsVector<T>::value) {
    return {{"type", "array"}, {"items", schema_of_value(typename T::value_type{}, limits)}};
  } else if constexpr (schema::IsArray<T>::value) {
    return {{"type", "array"},
            {"items", schema_of_value(typename T::value_type{}, limits)},
            {"minItems", value.size()},
            {"maxItems", value.size()}};
  } else if constexpr (ConfigStruct<T> && requires { value.empty(); }) {
    return {{"anyOf", {schema_of(value), {{"type", "null"}}}}};
  } else if constexpr (ConfigStruct<T>) {
    return schema_of(value);
  } else if constexpr (std::is_same_v<T, bool>) {
    return {{"type", "boolean"}};
  } else if constexpr (std::is_integral_v<T>) {
    Limits whole = limits;
    if (std::is_unsigned_v<T> && !(whole.low >= 0.0)) whole.low = 0.0;
    return schema::number("integer", whole);
  } else if constexpr (std::is_floating_point_v<T>) {
    return schema::number("number", limits);
  } else if constexpr (std::is_same_v<T, Eigen::Vector3d>) {
    return schema::numbers(3, limits);
  } else if constexpr (std::is_same_v<T, Pose>) {
    return schema::numbers(7, {});
  } else if constexpr (std::is_same_v<T, Json>) {
    return Json::object();  // anything
  } else if constexpr (schema::IsMap<T>::value) {
    return {{"type", "object"},
            {"additionalProperties", schema_of_value(typename T::mapped_type{}, limits)}};
  } else {
    static_assert(std::is_convertible_v<T, std::string>);
    return {{"type", "string"}};
  }
}

/// The schema of a struct as a complete document with `title`.
template <ConfigStruct C>
Json schema_document(const std::string& title, const C& config = {}) {
  Json document{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
  document.update(schema_of(config));
  return document;
}

}  // namespace lidarena
