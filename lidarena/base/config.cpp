// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/config.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numeric>
#include <sstream>

#include "lidarena/base/number.hpp"

namespace lidarena {

struct ConfigNode::Impl {
  YAML::Node node;
  std::string file;
  std::string key;  ///< dotted path from the file's root
};

namespace {

std::string place(const std::string& file, const YAML::Mark& mark) {
  return mark.is_null() ? file : file + ":" + std::to_string(mark.line + 1);
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string number(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, substitute}));
    }
  }
  return row.back();
}

/// YAML allows lists and maps as keys; here a key must be a single word.
std::string key_text(const YAML::Node& key, const std::string& file) {
  if (!key.IsScalar()) {
    throw InputError(place(file, key.Mark()), "a key must be a single word", "write 'key: value'");
  }
  return key.Scalar();
}

}  // namespace

ConfigNode ConfigNode::load(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in)
    throw InputError(file.string(), "cannot be opened", "check the name and its permissions");
  std::ostringstream text;
  text << in.rdbuf();
  return parse(text.str(), file.string());
}

ConfigNode ConfigNode::parse(const std::string& text, const std::string& name) {
  try {
    return ConfigNode(std::make_shared<const Impl>(Impl{YAML::Load(text), name, ""}));
  } catch (const YAML::Exception& e) {
    throw InputError(place(name, e.mark), "is not valid YAML: " + e.msg);
  }
}

bool ConfigNode::is_map() const { return impl_->node.IsMap(); }
bool ConfigNode::is_list() const { return impl_->node.IsSequence(); }
bool ConfigNode::is_null() const { return impl_->node.IsNull(); }

std::vector<std::string> ConfigNode::keys() const {
  std::vector<std::string> keys;
  for (const auto& entry : impl_->node) keys.push_back(key_text(entry.first, impl_->file));
  return keys;
}

std::optional<ConfigNode> ConfigNode::find(std::string_view key) const {
  const std::string name(key);
  std::optional<ConfigNode> found;
  for (const auto& entry : impl_->node) {
    if (key_text(entry.first, impl_->file) != name) continue;
    if (found)
      throw InputError(place(impl_->file, entry.first.Mark()),
                       "the key '" + name + "' is given a second time");
    const std::string path = impl_->key.empty() ? name : impl_->key + "." + name;
    found = ConfigNode(std::make_shared<const Impl>(Impl{entry.second, impl_->file, path}));
  }
  return found;
}

std::vector<ConfigNode> ConfigNode::items() const {
  std::vector<ConfigNode> items;
  std::size_t i = 0;
  for (const auto& entry : impl_->node) {
    const std::string path = impl_->key + "[" + std::to_string(i++) + "]";
    items.emplace_back(std::make_shared<const Impl>(Impl{entry, impl_->file, path}));
  }
  return items;
}

std::string ConfigNode::text() const {
  if (!impl_->node.IsScalar()) throw InputError(where(), "a single value is expected here");
  return impl_->node.Scalar();
}

std::string ConfigNode::where() const {
  const std::string file_line = place(impl_->file, impl_->node.Mark());
  return impl_->key.empty() ? file_line : file_line + ": " + impl_->key;
}

std::string ConfigNode::where(std::string_view key) const {
  for (const auto& entry : impl_->node) {
    if (key_text(entry.first, impl_->file) == key) return place(impl_->file, entry.first.Mark());
  }
  return where();
}

bool ConfigNode::as_bool() const {
  const std::string value = text();
  if (value == "true" || value == "on" || value == "yes") return true;
  if (value == "false" || value == "off" || value == "no") return false;
  throw InputError(where(), "'" + value + "' is not a boolean", "use true or false");
}

double ConfigNode::as_double() const {
  const std::string value = text();
  const auto number = parse_number(value);
  if (!number || !std::isfinite(*number)) {
    throw InputError(where(), "'" + value + "' is not a finite number");
  }
  return *number;
}

std::int64_t ConfigNode::as_integer() const {
  const std::string value = text();
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error != std::errc{} || end != value.data() + value.size()) {
    throw InputError(where(), "'" + value + "' is not an integer");
  }
  return number;
}

void ConfigNode::reject_unknown(const std::vector<std::string>& known,
                                std::span<const RenamedKey> renamed) const {
  for (const std::string& key : keys()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const auto former = std::find_if(renamed.begin(), renamed.end(),
                                     [&](const RenamedKey& names) { return names.first == key; });
    if (former != renamed.end()) {
      throw InputError(where(key), "the key '" + key + "' has another name",
                       "write '" + std::string(former->second) + "'");
    }
    const std::string nearest = nearest_word(key, known);
    throw InputError(
        where(key), "unknown key '" + key + "'",
        nearest.empty() ? "valid keys: " + joined(known) : "did you mean '" + nearest + "'?");
  }
}

void ConfigNode::check(double value, const Limits& limits) const {
  const bool low_ok = limits.low_open ? value > limits.low : value >= limits.low;
  if (low_ok && value <= limits.high) return;
  std::string allowed;
  if (std::isfinite(limits.low)) {
    allowed = (limits.low_open ? "above " : "at least ") + number(limits.low);
  }
  if (std::isfinite(limits.high)) {
    allowed += (allowed.empty() ? "" : " and ") + std::string("at most ") + number(limits.high);
  }
  throw InputError(where(), number(value) + " is out of range", "it must be " + allowed);
}

void ConfigNode::reject_choice(const std::vector<std::string>& allowed) const {
  throw InputError(where(), "'" + text() + "' is not a valid value",
                   "use one of " + joined(allowed));
}

std::string nearest_word(std::string_view word, const std::vector<std::string>& words) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : words) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

void read_value(const ConfigNode& node, bool& out, const Limits&) { out = node.as_bool(); }

void read_value(const ConfigNode& node, double& out, const Limits& limits) {
  const double value = node.as_double();
  node.check(value, limits);
  out = value;
}

void read_value(const ConfigNode& node, std::string& out, const Limits&) { out = node.text(); }

namespace {

std::vector<double> numbers(const ConfigNode& node, std::size_t count, const Limits& limits,
                            const char* meaning) {
  std::vector<double> values;
  read_value(node, values, limits);
  if (values.size() != count) {
    throw InputError(node.where(), std::to_string(values.size()) + " numbers are given here",
                     "write " + std::to_string(count) + " numbers: " + meaning);
  }
  return values;
}

}  // namespace

void read_value(const ConfigNode& node, Eigen::Vector3d& out, const Limits& limits) {
  const auto v = numbers(node, 3, limits, "[x, y, z]");
  out = {v[0], v[1], v[2]};
}

void read_value(const ConfigNode& node, Pose& out, const Limits&) {
  const auto v = numbers(node, 7, Limits{}, "[x, y, z, qx, qy, qz, qw]");
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (std::abs(q.norm() - 1.0) > 1e-3) {
    throw InputError(node.where(), "the quaternion has norm " + number(q.norm()),
                     "a rotation needs norm 1, in the order qx, qy, qz, qw");
  }
  out = make_pose(q, {v[0], v[1], v[2]});
}

std::string assignment_as_yaml(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError("--set " + assignment, "has no '='", "write --set key=value");
  }
  std::string yaml;
  std::string closing;
  std::stringstream path(assignment.substr(0, equals));
  for (std::string part; std::getline(path, part, '.');) {
    yaml += "{" + part + ": ";
    closing += "}";
  }
  return yaml + assignment.substr(equals + 1) + closing;
}

}  // namespace lidarena
