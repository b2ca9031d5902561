// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/variations.hpp"

#include <algorithm>
#include <filesystem>

#include "lidarena/dataset/md5.hpp"
#include "lidarena/flight/make_flight.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/scenes/load_world.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "lidarena/stages/scene_settings.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxNameLength = 80;  // of a part of a folder's name

std::string kind_of(const std::string& key) { return key.substr(0, key.find('.')); }

/// The key within the configuration of its kind.
std::string key_in(const std::string& kind, const std::string& key) {
  return kind == "imu" ? key : key.substr(std::min(kind.size() + 1, key.size()));
}

bool is_of_method(const PlannedRun& cell, const std::string& kind) {
  return kind == "algorithm" || kind == cell.label();
}

std::string text_of(const std::string& key, const Json& value) {
  return key + "=" + text_of_value(value);
}

/// As a part of a folder's name.
std::string name_part(const std::string& name, const std::vector<std::string>& settings) {
  if (settings.empty()) return {};
  std::string all;
  for (const std::string& setting : settings) all += (all.empty() ? "" : ",") + setting;
  std::string part = name.empty() ? all : name + "-" + dataset::md5_of(all).substr(0, 6);
  if (part.size() > kMaxNameLength)
    part = part.substr(0, kMaxNameLength - 7) + "-" + dataset::md5_of(part).substr(0, 6);
  std::ranges::replace_if(
      part,
      [](unsigned char c) {
        return std::isalnum(c) == 0 &&
               std::string_view("._-+=,").find(static_cast<char>(c)) == std::string_view::npos;
      },
      '_');
  return "-" + part;
}

const Json& values_of(const std::string& key, const Json& values) {
  if (values.is_array() && !values.empty()) return values;
  throw InputError("study: vary: " + key, "is not a list of values", "write " + key + ": [A, B]");
}

/// All combinations of the values of all keys, the last key fastest.
std::vector<Variation> grid_of(const Json& vary) {
  std::vector<Variation> grid(1);
  for (const auto& [key, values] : vary.items()) {
    std::vector<Variation> longer;
    for (const Variation& before : grid) {
      for (const Json& value : values_of(key, values)) {
        longer.push_back(before);
        longer.back().settings.emplace_back(key, value);
      }
    }
    grid = std::move(longer);
  }
  return grid;
}

/// Whether a key is set twice.
bool contradicts_itself(const Variation& variation) {
  for (std::size_t i = 0; i < variation.settings.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (variation.settings[i].first == variation.settings[j].first) return true;
  return false;
}

/// Combinations of two (and, if all are wanted, more) of the sets, each set before those after it;
/// of two that set the same key there is no pair. Throws InputError if all are wanted and two set
/// the same key, or there are too many.
std::vector<Variation> combinations_of(const std::vector<Variation>& sets, SetsAs as) {
  constexpr std::size_t kMaxSets = 10;  // 1024 combinations
  if (as == SetsAs::kEach) return {};
  if (sets.size() > kMaxSets)
    throw InputError("study: sets_as", "is for at most 10 sets", "leave some out");
  for (std::size_t a = 0; a < sets.size(); ++a) {
    for (std::size_t b = a + 1; b < sets.size(); ++b) {
      for (const auto& [key, value] : sets[a].settings) {
        for (const auto& [other, other_value] : sets[b].settings) {
          if (key == other && as == SetsAs::kAll)
            throw InputError("study: sets: " + sets[b].name,
                             "sets " + key + ", as " + sets[a].name + " does",
                             "give each key to one set, so that sets can be combined");
        }
      }
    }
  }
  std::vector<Variation> combinations;
  for (std::size_t chosen = 1; chosen < std::size_t{1} << sets.size(); ++chosen) {
    Variation together;
    for (std::size_t i = 0; i < sets.size(); ++i) {
      if ((chosen >> i & 1U) == 0) continue;
      together.name += (together.name.empty() ? "" : " + ") + sets[i].name;
      together.sets.push_back(sets[i].name);
      together.settings.insert(together.settings.end(), sets[i].settings.begin(),
                               sets[i].settings.end());
    }
    const bool is_wanted = as == SetsAs::kAll || together.sets.size() == 2;
    if (together.sets.size() > 1 && is_wanted && !contradicts_itself(together))
      combinations.push_back(std::move(together));
  }
  return combinations;
}

}  // namespace

std::vector<Variation> variations_of(const StudySpec& spec) {
  if (!spec.vary.is_object())
    throw InputError("study: vary", "is not a map",
                     "write vary: {sensor.range_noise_m: [0, 0.01]}");
  std::vector<Variation> all(1);
  if (spec.vary_as == VaryAs::kGrid && !spec.vary.empty()) {
    std::ranges::move(grid_of(spec.vary), std::back_inserter(all));
  } else {
    for (const auto& [key, values] : spec.vary.items())
      for (const Json& value : values_of(key, values)) all.push_back({"", {}, {{key, value}}});
  }
  std::vector<Variation> sets;
  for (const VariedSet& set : spec.sets) {
    if (set.name.empty() || set.name.find('/') != std::string::npos)
      throw InputError("study: sets", "a set has the name '" + set.name + "'",
                       "give each a name without '/', since a folder is named after it");
    if (std::ranges::find(sets, set.name, &Variation::name) != sets.end())
      throw InputError("study: sets", "two sets have the name '" + set.name + "'",
                       "give each a name of its own, since tables tell them apart by it");
    if (!set.set.is_object())
      throw InputError("study: sets: " + set.name, "has no settings",
                       "write set: {sensor.range_noise_m: 0.01}");
    Variation variation{set.name, {set.name}, {}};
    for (const auto& [key, value] : set.set.items()) variation.settings.emplace_back(key, value);
    sets.push_back(std::move(variation));
  }
  all.insert(all.end(), sets.begin(), sets.end());
  std::ranges::move(combinations_of(sets, spec.sets_as), std::back_inserter(all));
  return all;
}

/// Whether settings of this kind are settings of the cell. Throws InputError if they are of none.
bool CellSettings::applies_to(const PlannedRun& base, const std::string& kind) const {
  if (kind == "world" || kind == "flight" || kind == "sensor" || kind == "imu")
    return base.recording.empty();
  if (kind == "algorithm") return true;
  std::vector<std::string> known{"world", "flight", "sensor", "imu", "algorithm"};
  for (const std::string& sensor : spec_.sensors) known.push_back(fs::path(sensor).stem());
  for (const StudyAlgorithm& method : methods_)
    known.push_back(method.as.empty() ? parse_algorithm(method.name).algorithm : method.as);
  if (std::ranges::find(known, kind) == known.end()) {
    const std::string nearest = nearest_word(kind, known);
    throw InputError("study: vary: " + kind, "is not what a study can vary",
                     nearest.empty()
                         ? "a key begins with world, flight, sensor, imu, algorithm, or "
                           "the name of a sensor or method of the study"
                         : "did you mean '" + nearest + "'?");
  }
  return kind == fs::path(base.sensor).stem() || kind == base.label();
}

Json CellSettings::load(const PlannedRun& base, const std::string& kind,
                        const std::vector<std::string>& set) const {
  if (kind == "world") return scenes::world_config(configs_.resolve("worlds", base.world), set);
  if (kind == "flight")
    return to_json(flight::load_flight(configs_.resolve("flights", base.flight), set));
  const bool is_recorded = !base.recording.empty();
  const fs::path sensor = is_recorded ? fs::path() : configs_.resolve("sensors", base.sensor);
  const fs::path shipped = configs_.root() / "sensors";
  if (!is_of_method(base, kind)) return to_json(sensor::load_sensor(sensor, shipped, set));
  if (base.preset == "external")
    throw InputError("study: vary: " + kind, base.label() + " is an external program",
                     "vary the settings of Lidarena's own methods by name: METHOD.KEY");
  odometry::OdometryRequest request{base.algorithm, base.preset, {}, assignments_of(base.settings)};
  request.overrides.insert(request.overrides.end(), set.begin(), set.end());
  if (is_recorded) return odometry::configuration_of(request);
  const Rig rig = sensor::make_rig({sensor::load_sensor(sensor, shipped)});
  return odometry::configuration_of(request, rig.lidars.front());
}

/// The cell's configuration of this kind with the assignments over it.
const Json& CellSettings::configuration(const PlannedRun& base, const std::string& kind,
                                        const std::vector<std::string>& set) {
  std::string file = "sensor|" + base.sensor;
  if (kind == "world") file = "world|" + base.world;
  if (kind == "flight") file = "flight|" + base.flight;
  if (is_of_method(base, kind))
    file = "algorithm|" + base.sensor + "|" + base.label() + "|" + base.preset;
  for (const std::string& assignment : set) file += "|" + assignment;
  const auto [place, is_new] = loaded_.try_emplace(file);
  if (!is_new) return place->second;
  try {
    place->second = load(base, kind, set);
  } catch (const InputError& error) {
    loaded_.erase(place);
    throw InputError("study: vary", error.what());
  }
  return place->second;
}

/// The assignments of the variation to the configuration that `kind` is of, in their order.
std::vector<std::string> CellSettings::assignments(const PlannedRun& base, const std::string& kind,
                                                   const Variation& variation) const {
  const auto file_of = [&](const std::string& of) {
    if (of == "world" || of == "flight") return of;
    return std::string(is_of_method(base, of) ? "algorithm" : "sensor");
  };
  std::vector<std::string> set;
  for (const auto& [key, value] : variation.settings) {
    const std::string other = kind_of(key);
    if (applies_to(base, other) && file_of(other) == file_of(kind))
      set.push_back(stages::assignment_of(key_in(other, key), value));
  }
  return set;
}

/// Whether the cell is another one without this setting of its variation. What the seed draws is
/// never the same.
bool CellSettings::changes(const PlannedRun& base, const std::string& key, const Json& value,
                           const Variation& variation) {
  const std::string kind = kind_of(key);
  std::vector<std::string> set = assignments(base, kind, variation);
  const Json with = configuration(base, kind, set);
  if (kind == "world" && value_at(configuration(base, kind, {}), "vary") == true) return true;
  std::erase(set, stages::assignment_of(key_in(kind, key), value));
  try {
    return configuration(base, kind, set) != with;
  } catch (const InputError&) {
    return true;  // the others are valid with this one only
  }
}

PlannedRun CellSettings::varied(const PlannedRun& base, const Variation& variation,
                                const std::vector<Variation>& all) {
  PlannedRun cell = base;
  for (const Variation& other : all) {
    if (!other.name.empty()) continue;
    for (const auto& [key, value] : other.settings) {
      const std::string kind = kind_of(key);
      if (!applies_to(base, kind) || cell.varied.contains(key)) continue;
      cell.varied[key] = value_at(configuration(base, kind, {}), key_in(kind, key));
    }
  }
  std::vector<std::string> of_flight, of_method;
  for (const auto& [key, value] : variation.settings) {
    const std::string kind = kind_of(key);
    if (!applies_to(base, kind) || !changes(base, key, value, variation)) continue;
    if (variation.name.empty()) {
      cell.varied[key] = value;
      cell.differs.push_back(key);
    }
    if (is_of_method(base, kind)) {
      cell.settings[key_in(kind, key)] = value;
      of_method.push_back(text_of(key, value));
    } else {
      cell.set.push_back(stages::assignment_of(key, value));
      of_flight.push_back(text_of(key, value));
    }
    cell.variation += (cell.variation.empty() ? "" : ", ") + text_of(key, value);
  }
  if (!cell.variation.empty() && !variation.name.empty()) {
    cell.variation = variation.name;
    cell.differs = variation.sets;
  }
  cell.dataset += name_part(variation.name, of_flight);
  cell.method_part = name_part(variation.name, of_method);
  return cell;
}

}  // namespace lidarena::study
