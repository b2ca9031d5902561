// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "lidarena/base/config_schema.hpp"

namespace lidarena::study {

/// A method of a study. In a file: NAME or NAME:PRESET, or a map with the keys below.
struct StudyAlgorithm {
  std::string name;
  std::string as;
  Json set = Json::object();
  int parts = 0;
  std::vector<std::string> sensors;
  std::vector<std::string> also;

  StudyAlgorithm() = default;
  StudyAlgorithm(std::string text) : name(std::move(text)) {}
  StudyAlgorithm(const char* text) : name(text) {}

  /// Whether it is a name alone.
  bool is_plain() const {
    return as.empty() && set.empty() && parts == 0 && sensors.empty() && also.empty();
  }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "NAME or NAME:PRESET, or an external program's name");
    v("as", self.as, "", "its name in the results; needed if the method is flown several times");
    v("set", self.set, "",
      "KEY: VALUE of its settings; a list where one value is expected makes a method of each "
      "value");
    v("parts", self.parts, "",
      "scans in which each sweep is handed over, as run --parts; 0: as the preset has it",
      between(0, 100));
    v("sensors", self.sensors, "",
      "sensors of the study with which it is flown; none = all. Settings that differ from sensor "
      "to "
      "sensor are two such methods with one name (as)");
    v("also", self.also, "",
      "further sensors of the study, whose points are added to the scans, as run --also");
  }

  static StudyAlgorithm from(const ConfigNode& node);
  static StudyAlgorithm from(const Json& json, const std::string& place);
  Json json() const;
  static Json schema();

  // The names by which lists of fields are read and written; friends, so that they hide no others.
  friend void read_value(const ConfigNode& node, StudyAlgorithm& out, const Limits&) {
    out = from(node);
  }
  friend void value_from_json(const Json& json, StudyAlgorithm& out, const std::string& place) {
    out = from(json, place);
  }
  friend Json value_to_json(const StudyAlgorithm& algorithm) { return algorithm.json(); }
  friend Json schema_of_value(const StudyAlgorithm&, const Limits&) { return schema(); }
};

/// The methods with one value for each key: a list is kept where the key takes a list, else it
/// makes a method of each of its values, named AS-KEY=VALUE. Throws InputError for a key or value
/// that a method does not have, and for an empty list. Names of programs outside are left as they
/// are.
std::vector<StudyAlgorithm> with_single_values(const std::vector<StudyAlgorithm>& algorithms,
                                               const std::vector<std::string>& outside);

/// "key=value" of each setting.
std::vector<std::string> assignments_of(const Json& set);

/// A value as a reader writes it: a text without quotes.
std::string text_of_value(const Json& value);

}  // namespace lidarena::study
