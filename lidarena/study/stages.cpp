// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/stages.hpp"

#include <fmt/format.h>

#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/md5.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRequest = "request.json";
constexpr const char* kExternal = "external.json";  ///< the external program that a run is of

std::string digest_of(const fs::path& file) { return dataset::md5_of(dataset::read_bytes(file)); }

/// The keys of the steps that are done in a folder; empty if none is.
Json done_in(const fs::path& folder) {
  if (!fs::exists(folder / kRequest)) return Json::object();
  try {
    return dataset::read_json(folder / kRequest);
  } catch (const Error&) {
    return Json::object();
  }
}

/// The sensor's id in the dataset, whose LiDARs are in the order of the study's sensors.
std::string lidar_id_of(const fs::path& dataset, const StudySpec& spec, const std::string& sensor) {
  const Json manifest = dataset::read_json(dataset / "manifest.json");
  for (std::size_t i = 0; i < spec.sensors.size(); ++i) {
    if (spec.sensors[i] == sensor) return manifest.at("rig").at("lidars").at(i).at("id");
  }
  return sensor;
}

}  // namespace

std::size_t Stage::first_open_step() const {
  const Json done = done_in(folder);
  std::size_t step = 0;
  while (step < steps.size() && done.value(steps[step].name, Json()) == steps[step].key) ++step;
  return step;
}

void Stage::record(std::size_t step) const {
  Json done = Json::object();
  for (std::size_t i = 0; i <= step; ++i) done[steps[i].name] = steps[i].key;
  dataset::write_json(folder / kRequest, done);
}

Json Stages::flight_key(const PlannedRun& cell) const {
  Json sensors = Json::array();
  for (const std::string& sensor : spec_.sensors)
    sensors.push_back(digest_of(configs_.resolve("sensors", sensor)));
  return {{"code", code_.of("simulator")},
          {"world", digest_of(configs_.resolve("worlds", cell.world))},
          {"flight", digest_of(configs_.resolve("flights", cell.flight))},
          {"sensors", sensors},
          {"seed", cell.seed},
          {"seconds", cell.seconds},
          {"mode", value_to_json(cell.mode)}};
}

Stage Stages::flight(const PlannedRun& cell) const {
  Stage stage;
  stage.name = "flight " + cell.dataset;
  stage.dataset = cell.dataset;
  stage.folder = out_ / "datasets" / cell.dataset;
  std::vector<std::string> call{"simulate",
                                "--world",
                                configs_.resolve("worlds", cell.world).string(),
                                "--flight",
                                configs_.resolve("flights", cell.flight).string(),
                                "--seed",
                                std::to_string(cell.seed),
                                "--seconds",
                                fmt::format("{}", cell.seconds),
                                "--out",
                                stage.folder.string(),
                                "--configs",
                                configs_.root().string(),
                                "--example-scans"};
  for (const std::string& sensor : spec_.sensors)
    call.insert(call.end(), {"--sensor", configs_.resolve("sensors", sensor).string()});
  if (cell.mode) call.insert(call.end(), {"--mode", value_to_json(*cell.mode).get<std::string>()});
  stage.steps.push_back(
      {"flight", flight_key(cell), stage.folder / "manifest.json", [call] { return call; }});
  return stage;
}

Step Stages::run_step(const PlannedRun& cell, const fs::path& folder) const {
  Step step{"run", {}, folder / "manifest.json", {}};
  step.key = {{"flight", flight_key(cell)},
              {"code", code_.of_method(cell.algorithm)},
              {"cell", to_json(cell)}};
  const ExternalProgram* external = find_external(spec_, cell.algorithm);
  if (external != nullptr) step.key["external"] = to_json(*external);
  // Without its maps, a run cannot be scored again.
  if (!spec_.keep_maps) step.key["maps_removed_after"] = code_.of("scorer");
  step.arguments = [this, &cell, external, folder] {
    const fs::path dataset = out_ / "datasets" / cell.dataset;
    std::vector<std::string> call{"run",
                                  cell.algorithm,
                                  dataset.string(),
                                  "--out",
                                  folder.string(),
                                  "--sensor",
                                  lidar_id_of(dataset, spec_, cell.sensor)};
    if (external != nullptr) {
      dataset::write_json(folder / kExternal, to_json(*external));
      call.insert(call.end(), {"--external", (folder / kExternal).string()});
    } else if (!cell.preset.empty()) {
      call.insert(call.end(), {"--preset", cell.preset});
    }
    return call;
  };
  return step;
}

Stage Stages::run(const PlannedRun& cell) const {
  Stage stage;
  stage.name = "run " + cell.name;
  stage.cell = &cell;
  stage.dataset = cell.dataset;
  stage.folder = out_ / "runs" / cell.name;
  stage.weight = estimate(cell, configs_).seconds;
  stage.steps.push_back(run_step(cell, stage.folder));
  stage.steps.push_back({"score", code_.of("scorer"), stage.folder / "metrics.json",
                         [folder = stage.folder.string()] {
                           return std::vector<std::string>{"evaluate", folder};
                         }});
  return stage;
}

}  // namespace lidarena::study
