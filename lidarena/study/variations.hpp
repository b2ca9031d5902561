// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "lidarena/stages/config_folder.hpp"
#include "lidarena/study/study_spec.hpp"

namespace lidarena::study {

/// Settings that differ from the base together.
struct Variation {
  std::string name;                                    ///< of named sets; empty: its settings
  std::vector<std::string> sets;                       ///< the named sets that it combines
  std::vector<std::pair<std::string, Json>> settings;  ///< KIND.key and value
};

/// All variations of a study: the base, which has no settings, then those of its file in their
/// order. Throws InputError for an empty list, a value that is not a list, or a set without a name
/// of its own.
std::vector<Variation> variations_of(const StudySpec& spec);

/// Puts variations into cells. KIND is world, flight, sensor, imu (that inside the sensor), or
/// algorithm; or the name of one sensor or method of the study, of whose cells alone the setting is
/// then. Files are read once.
class CellSettings {
 public:
  /// Both must outlive this. `methods`: of the study, each with single values.
  CellSettings(const StudySpec& spec, const std::vector<StudyAlgorithm>& methods,
               const stages::ConfigFolder& configs)
      : spec_(spec), methods_(methods), configs_(configs) {}

  /// The base cell with the settings of the variation that change it: `set` those of its flight,
  /// `settings` those of its method. Its `varied` has each key that the study varies (not those
  /// of named sets), with the value that holds in this cell. Throws InputError for an unknown KIND
  /// or key, and for a value out of range.
  PlannedRun varied(const PlannedRun& base, const Variation& variation,
                    const std::vector<Variation>& all);

 private:
  bool applies_to(const PlannedRun& base, const std::string& kind) const;
  const Json& configuration(const PlannedRun& base, const std::string& kind,
                            const std::vector<std::string>& set);
  Json load(const PlannedRun& base, const std::string& kind,
            const std::vector<std::string>& set) const;
  std::vector<std::string> assignments(const PlannedRun& base, const std::string& kind,
                                       const Variation& variation) const;
  bool changes(const PlannedRun& base, const std::string& key, const Json& value,
               const Variation& variation);

  const StudySpec& spec_;
  const std::vector<StudyAlgorithm>& methods_;
  const stages::ConfigFolder& configs_;
  std::map<std::string, Json> loaded_;
};

}  // namespace lidarena::study
