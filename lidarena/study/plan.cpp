// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/plan.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "lidarena/base/config.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/md5.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPlan = "plan.json";

/// The values in `node` that are the name of a file, relative to `folder`.
void collect_files(const ConfigNode& node, const fs::path& folder, std::vector<fs::path>& files) {
  if (node.is_map()) {
    for (const std::string& key : node.keys()) collect_files(*node.find(key), folder, files);
  } else if (node.is_list()) {
    for (const ConfigNode& item : node.items()) collect_files(item, folder, files);
  } else if (!node.is_null()) {
    std::error_code no_such_file;
    const fs::path file = folder / node.text();
    if (fs::is_regular_file(file, no_such_file)) files.push_back(file);
  }
}

/// Digests of files, each read once. That of a YAML file is also that of the files that it names: a
/// mesh, a recorded flight and its IMU, a pattern.
class Digests {
 public:
  const std::string& of(const fs::path& file) {
    std::string& digest = known_[file];
    if (!digest.empty()) return digest;
    digest = dataset::md5_of(dataset::read_bytes(file));
    std::vector<fs::path> named;
    if (file.extension() == ".yaml")
      collect_files(ConfigNode::load(file), file.parent_path(), named);
    std::string all = digest;
    for (const fs::path& other : named) all += dataset::md5_of(dataset::read_bytes(other));
    if (!named.empty()) digest = dataset::md5_of(all);
    return digest;
  }

 private:
  std::map<fs::path, std::string> known_;
};

Json key_of_flight(const StudyPlan& plan, const PlanUnit& unit, const stages::ConfigFolder& configs,
                   const ProgramCode& code, Digests& digests) {
  const StudySpec& spec = plan.spec;
  const PlannedRun& cell = plan.cells[unit.cells.front()];
  if (const StudyRecording* recording = recording_of(spec, cell)) {
    Json read = to_json(*recording);
    read["file"] = fs::path(recording->file).filename().string();
    read["truth"] = digests.of(recording->truth);
    return {{"code", code.of("simulator")}, {"recording", read}, {"bytes", bytes_of(*recording)}};
  }
  Json sensors = Json::array();
  for (const std::string& sensor : sensors_of(plan, unit)) {
    for (const fs::path& file : configs.sensor_files(sensor)) sensors.push_back(digests.of(file));
  }
  return {{"code", code.of("simulator")},
          {"world", digests.of(configs.resolve("worlds", cell.world))},
          {"flight", digests.of(configs.resolve("flights", cell.flight))},
          {"sensors", sensors},
          {"set", cell.set},
          {"seed", cell.seed},
          {"new_scene", spec.new_scenes},
          {"seconds", cell.seconds},
          {"allow_missing", cell.allow_missing},
          {"hits", stages::scores_maps(spec.score)},
          {"mode", value_to_json(cell.mode)}};
}

/// Makes the path of a file absolute; a name in `configs` stays a name.
void make_absolute(std::string& name, const std::string& kind,
                   const stages::ConfigFolder& configs) {
  if (configs.resolve(kind, name) == fs::path(name)) name = fs::absolute(name).string();
}

void make_paths_absolute(StudySpec& spec, const stages::ConfigFolder& configs) {
  for (StudyScene& scene : spec.scenes) {
    make_absolute(scene.world, "worlds", configs);
    make_absolute(scene.flight, "flights", configs);
  }
  for (std::string& sensor : spec.sensors) make_absolute(sensor, "sensors", configs);
  for (StudyRecording& recording : spec.recordings) recording = resolved(recording, configs);
}

/// Expected seconds of each cell; cells of the same flight and sensor take the same.
std::vector<double> expected_seconds(const StudySpec& spec, const std::vector<PlannedRun>& cells,
                                     const stages::ConfigFolder& configs) {
  using Flown = std::tuple<std::string, std::string, double, std::string, std::vector<std::string>>;
  std::map<Flown, double> known;
  std::vector<double> seconds;
  for (const PlannedRun& cell : cells) {
    const auto [place, is_new] =
        known.try_emplace({cell.recording, cell.flight, cell.seconds, cell.sensor, cell.set}, 0.0);
    if (is_new) place->second = estimate(spec, cell, configs).seconds;
    seconds.push_back(place->second);
  }
  return seconds;
}

/// The units of the plan's cells, longest first.
std::vector<PlanUnit> units_of_cells(const StudyPlan& plan, const stages::ConfigFolder& configs,
                                     const ProgramCode& code) {
  Digests digests;
  std::map<std::pair<std::string, double>, std::uint64_t> data;  // by flight and its length
  std::map<std::string, std::size_t> places;
  std::vector<PlanUnit> units;
  for (std::size_t i = 0; i < plan.cells.size(); ++i) {
    const PlannedRun& cell = plan.cells[i];
    const auto [place, is_new] = places.emplace(cell.dataset, units.size());
    if (is_new) {
      const auto [bytes, is_unknown] =
          data.try_emplace({cell.recording + cell.flight, cell.seconds}, 0U);
      if (is_unknown) bytes->second = data_bytes(plan.spec, cell, configs);
      units.push_back(
          {.dataset = cell.dataset, .cells = {}, .data_bytes = bytes->second, .flight = {}});
    }
    units[place->second].cells.push_back(i);
    units[place->second].seconds += plan.seconds[i];
  }
  for (PlanUnit& unit : units) unit.flight = key_of_flight(plan, unit, configs, code, digests);
  std::ranges::stable_sort(units, std::ranges::greater{}, &PlanUnit::seconds);
  return units;
}

/// Gives each unit to the shard that has the least to do so far.
void assign_shards(StudyPlan& plan) {
  std::vector<double> seconds(static_cast<std::size_t>(plan.shards), 0.0);
  for (PlanUnit& unit : plan.units) {
    const auto least = std::ranges::min_element(seconds);
    *least += unit.seconds;
    unit.shard = 1 + static_cast<int>(least - seconds.begin());
  }
}

}  // namespace

StudyPlan make_plan(StudySpec spec, const stages::ConfigFolder& configs, const ProgramCode& code,
                    int shards) {
  planned_cells(spec, configs);  // names every mistake in the user's own words
  make_paths_absolute(spec, configs);
  StudyPlan plan;
  plan.cells = planned_cells(spec, configs);
  plan.reference = load_reference(spec, configs);
  plan.spec = std::move(spec);
  plan.code = code.json();
  plan.shards = shards;
  plan.seconds = expected_seconds(plan.spec, plan.cells, configs);
  plan.units = units_of_cells(plan, configs, code);
  assign_shards(plan);
  return plan;
}

std::vector<std::string> sensors_of(const StudyPlan& plan, const PlanUnit& unit) {
  std::vector<std::string> sensors = plan.spec.sensors;
  std::erase_if(sensors, [&](const std::string& sensor) {
    return std::ranges::none_of(unit.cells, [&](std::size_t index) {
      const PlannedRun& cell = plan.cells[index];
      return cell.sensor == sensor || std::ranges::find(cell.also, sensor) != cell.also.end();
    });
  });
  return sensors;
}

Json flight_key(const StudyPlan& plan, const PlanUnit& unit, const stages::ConfigFolder& configs) {
  Digests digests;
  return key_of_flight(plan, unit, configs, ProgramCode(plan.code), digests);
}

std::vector<std::size_t> units_of(const StudyPlan& plan, const Shard& shard) {
  std::vector<std::size_t> all(plan.units.size());
  std::iota(all.begin(), all.end(), 0U);
  if (shard.of > 1)
    std::erase_if(all, [&](std::size_t i) { return plan.units[i].shard != shard.part; });
  return all;
}

StudyPlan read_plan(const fs::path& study) {
  const fs::path file = study / kPlan;
  if (!fs::exists(file)) {
    throw InputError(study.string(), "is not the folder of a study: it holds no plan.json",
                     "plan one: lidarena study STUDY --out " + study.string());
  }
  StudyPlan plan;
  read_json(dataset::read_json(file), plan, file.string());
  for (const PlanUnit& unit : plan.units) {
    for (const std::size_t cell : unit.cells) {
      if (cell >= plan.cells.size() || plan.seconds.size() != plan.cells.size())
        throw InputError(file.string(), "is damaged", "plan the study again");
    }
  }
  return plan;
}

void write_plan(const fs::path& study, const StudyPlan& plan) {
  Json json = {{"kind", "study"}};
  json.update(to_json(plan));
  dataset::write_json(study / kPlan, json);
}

}  // namespace lidarena::study
