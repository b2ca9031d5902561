// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/base/pose.hpp"

/// Configurations are plain structs whose fields are listed once, in a static template
///
///   template <class Self, class V> static void visit(Self& self, V&& v) {
///     v("voxel_size_m", self.voxel_size_m, "m", "edge of a map cell", above(0));
///   }
///
/// Loading (YAML), saving (JSON, see config_json.hpp), help, and the errors for unknown keys, wrong
/// types and values out of range all come from that list. Units are SI; a key names its unit.
namespace lidarena {

/// Allowed values of a numeric field (or of each element of a list).
struct Limits {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;  ///< `low` itself is not allowed
};
inline Limits at_least(double low) { return {low, std::numeric_limits<double>::infinity(), false}; }
inline Limits above(double low) { return {low, std::numeric_limits<double>::infinity(), true}; }
inline Limits between(double low, double high) { return {low, high, false}; }

/// Former name of a key and its name, for errors.
using RenamedKey = std::pair<std::string_view, std::string_view>;

template <class T>
concept ConfigStruct = std::is_class_v<T> && requires(T& t) {
  T::visit(t, [](auto&&...) {});
};

/// A parsed YAML value with its place in the file (only config.cpp uses yaml-cpp).
class ConfigNode {
 public:
  /// Throws InputError naming file and line when the file is missing or is not YAML.
  static ConfigNode load(const std::filesystem::path& file);
  /// Parses `text`; `name` stands in for the file in messages.
  static ConfigNode parse(const std::string& text, const std::string& name);

  bool is_map() const;
  bool is_list() const;
  bool is_null() const;
  /// Keys of a map, in file order.
  std::vector<std::string> keys() const;
  std::optional<ConfigNode> find(std::string_view key) const;
  std::vector<ConfigNode> items() const;          ///< of a list
  std::string text() const;                       ///< of a scalar; throws InputError otherwise
  std::string where() const;                      ///< "file:line", or "file:line: key" below a map
  std::string where(std::string_view key) const;  ///< place of a key of this map

  bool as_bool() const;
  double as_double() const;
  std::int64_t as_integer() const;

  /// Throws InputError when this map has a key that is not in `known`: with the key's name if it is
  /// a former name in `renamed`, else with the nearest known key.
  void reject_unknown(const std::vector<std::string>& known,
                      std::span<const RenamedKey> renamed = {}) const;
  /// Throws InputError when `value` is outside `limits`.
  void check(double value, const Limits& limits) const;
  /// Throws InputError that lists the allowed values.
  [[noreturn]] void reject_choice(const std::vector<std::string>& allowed) const;

  struct Impl;
  explicit ConfigNode(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

 private:
  std::shared_ptr<const Impl> impl_;
};

/// The word nearest to `word` by edit distance; empty if none is near.
std::string nearest_word(std::string_view word, const std::vector<std::string>& words);

void read_value(const ConfigNode& node, bool& out, const Limits&);
void read_value(const ConfigNode& node, double& out, const Limits& limits);
void read_value(const ConfigNode& node, std::string& out, const Limits&);
void read_value(const ConfigNode& node, Eigen::Vector3d& out, const Limits& limits);
/// A list x y z qx qy qz qw.
void read_value(const ConfigNode& node, Pose& out, const Limits&);

template <std::integral T>
void read_value(const ConfigNode& node, T& out, const Limits& limits) {
  const std::int64_t value = node.as_integer();
  node.check(static_cast<double>(value), limits);
  node.check(static_cast<double>(value),
             between(static_cast<double>(std::numeric_limits<T>::min()),
                     static_cast<double>(std::numeric_limits<T>::max())));
  out = static_cast<T>(value);
}

/// The names of an enum E are those of a function beside it, found by argument-dependent lookup:
/// `constexpr auto enum_names(E) { return std::array{std::pair{"rolling", E::kRolling}, ...}; }`
template <class E>
requires std::is_enum_v<E>
void read_value(const ConfigNode& node, E& out, const Limits&) {
  const std::string text = node.text();
  std::vector<std::string> allowed;
  for (const auto& [name, value] : enum_names(E{})) {
    if (text == name) {
      out = value;
      return;
    }
    allowed.emplace_back(name);
  }
  node.reject_choice(allowed);
}

template <ConfigStruct C>
void read_value(const ConfigNode& node, C& out, const Limits&);

template <class T>
void read_value(const ConfigNode& node, std::optional<T>& out, const Limits& limits) {
  if (node.is_null()) {
    out.reset();
    return;
  }
  T value{};
  read_value(node, value, limits);
  out = std::move(value);
}

template <class T>
void read_value(const ConfigNode& node, std::vector<T>& out, const Limits& limits) {
  if (!node.is_list()) throw InputError(node.where(), "a list is expected here", "write [a, b, c]");
  out.clear();
  for (const ConfigNode& item : node.items()) {
    T value{};
    read_value(item, value, limits);
    out.push_back(std::move(value));
  }
}

/// Overwrites the fields of `config` that the map `node` contains.
template <ConfigStruct C>
void read_config(const ConfigNode& node, C& config) {
  if (node.is_null()) return;  // an empty file means all defaults
  if (!node.is_map()) throw InputError(node.where(), "a map (key: value) is expected here");
  std::vector<std::string> known;
  C::visit(config, [&](std::string_view name, auto& member, std::string_view, std::string_view,
                       Limits limits = {}) {
    known.emplace_back(name);
    if (const auto child = node.find(name)) read_value(*child, member, limits);
  });
  if constexpr (requires { C::renamed_keys; }) {
    node.reject_unknown(known, C::renamed_keys);
  } else {
    node.reject_unknown(known);
  }
}

template <ConfigStruct C>
void read_value(const ConfigNode& node, C& out, const Limits&) {
  read_config(node, out);
}

/// The defaults, overwritten by the keys that the file contains.
template <ConfigStruct C>
C load_config(const std::filesystem::path& file) {
  C config;
  read_config(ConfigNode::load(file), config);
  return config;
}

/// "a.b=v" as the YAML text {a: {b: v}}; throws InputError when there is no '='.
std::string assignment_as_yaml(const std::string& assignment);

/// Applies "key=value" or "group.key=value" (as given to --set).
template <ConfigStruct C>
void set_field(C& config, const std::string& assignment) {
  read_config(ConfigNode::parse(assignment_as_yaml(assignment), "--set " + assignment), config);
}

}  // namespace lidarena
