// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/study_algorithm.hpp"

#include <algorithm>

#include "lidarena/odometry/factory.hpp"
#include "lidarena/stages/scene_settings.hpp"
#include "lidarena/study/study_spec.hpp"

namespace lidarena::study {
namespace {

/// Whether the method takes this value of the key.
bool takes(const StudyAlgorithm& method, const std::string& key, const Json& value) {
  odometry::OdometryRequest request = parse_algorithm(method.name);
  request.overrides = {stages::assignment_of(key, value)};
  try {
    odometry::configuration_of(request);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// One method for each value of the first key that has several.
std::vector<StudyAlgorithm> split_by_values(const StudyAlgorithm& method) {
  for (const auto& [key, value] : method.set.items()) {
    if (!value.is_array() || takes(method, key, value)) continue;
    if (value.empty())
      throw InputError("study", "sets " + key + " of " + method.name + " to an empty list",
                       "give at least one value");
    std::vector<StudyAlgorithm> methods;
    for (const Json& single : value) {
      StudyAlgorithm one = method;
      one.set[key] = single;
      one.as = (method.as.empty() ? parse_algorithm(method.name).algorithm : method.as) + "-" +
               key + "=" + text_of_value(single);
      std::ranges::move(split_by_values(one), std::back_inserter(methods));
    }
    return methods;
  }
  return {method};
}

void check(const StudyAlgorithm& method) {
  odometry::OdometryRequest request = parse_algorithm(method.name);
  odometry::check_algorithm(request);
  if (!method.also.empty()) odometry::check_takes_several_lidars(request.algorithm);
  for (const std::string& assignment : assignments_of(method.set)) {
    request.overrides = {assignment};
    odometry::configuration_of(request);
  }
}

}  // namespace

StudyAlgorithm StudyAlgorithm::from(const ConfigNode& node) {
  if (!node.is_map()) return {node.text()};
  StudyAlgorithm algorithm;
  read_config(node, algorithm);
  if (algorithm.name.empty())
    throw InputError(node.where(), "a method has no name", "add name: NAME");
  if (!algorithm.set.is_object())
    throw InputError(node.where("set"), "is not a map", "write set: {KEY: VALUE}");
  return algorithm;
}

StudyAlgorithm StudyAlgorithm::from(const Json& json, const std::string& place) {
  if (json.is_string()) return {json.get<std::string>()};
  StudyAlgorithm algorithm;
  read_json(json, algorithm, place);
  return algorithm;
}

Json StudyAlgorithm::json() const { return is_plain() ? Json(name) : to_json(*this); }

Json StudyAlgorithm::schema() {
  Json map = schema_of<StudyAlgorithm>();
  map["properties"]["set"]["type"] = "object";
  map["required"] = {"name"};
  return {{"anyOf", {{{"type", "string"}}, map}}};
}

std::vector<StudyAlgorithm> with_single_values(const std::vector<StudyAlgorithm>& algorithms,
                                               const std::vector<std::string>& outside) {
  std::vector<StudyAlgorithm> methods;
  for (const StudyAlgorithm& algorithm : algorithms) {
    if (std::ranges::find(outside, algorithm.name) != outside.end()) {
      if (!algorithm.set.empty() || algorithm.parts > 1 || !algorithm.also.empty())
        throw InputError("study", "gives settings to the external program " + algorithm.name,
                         "write them into its command line");
      methods.push_back(algorithm);
      continue;
    }
    odometry::check_algorithm(parse_algorithm(algorithm.name));
    for (StudyAlgorithm& single : split_by_values(algorithm)) {
      check(single);
      methods.push_back(std::move(single));
    }
  }
  return methods;
}

std::vector<std::string> assignments_of(const Json& set) {
  std::vector<std::string> assignments;
  for (const auto& [key, value] : set.items())
    assignments.push_back(stages::assignment_of(key, value));
  return assignments;
}

std::string text_of_value(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

}  // namespace lidarena::study
