// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/stages.hpp"

#include <fmt/format.h>

#include "lidarena/dataset/json_file.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRequest = "request.json";
constexpr const char* kExternal = "external.json";  ///< the external program that a run is of

/// What request.json of a folder holds; empty if it is missing or torn.
Json request_of(const fs::path& folder) {
  try {
    Json request = dataset::read_json(folder / kRequest);
    return request.is_object() ? request : Json::object();
  } catch (const Error&) {
    return Json::object();
  }
}

std::size_t first_open(const std::vector<Step>& steps, const Json& request) {
  std::size_t step = 0;
  while (step < steps.size() && request.value(steps[step].name, Json()) == steps[step].key) ++step;
  return step;
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

std::size_t Stage::first_open_step() const { return first_open(steps, request_of(folder)); }

StageResult Stage::result() const {
  const Json request = request_of(folder);
  const Json told = request.value("result", Json::object());
  const std::string state = told.value("state", "");
  StageResult result;
  result.seconds = told.value("seconds", 0.0);
  result.attempt = told.value("attempt", 0);
  if (state == "failed") {
    result.state = StageState::kFailed;
  } else if (first_open(steps, request) == steps.size()) {
    result.state = state == "diverged" ? StageState::kDiverged : StageState::kOk;
  }
  return result;
}

void Stage::record(std::size_t step, double seconds, bool diverged) const {
  Json done = Json::object();
  for (std::size_t i = 0; i <= step; ++i) done[steps[i].name] = steps[i].key;
  if (step + 1 == steps.size())
    done["result"] = {{"state", diverged ? "diverged" : "ok"}, {"seconds", seconds}};
  dataset::write_json(folder / kRequest, done);
}

void Stage::record_failure(double seconds, int attempt) const {
  dataset::write_json(
      folder / kRequest,
      {{"result", {{"state", "failed"}, {"seconds", seconds}, {"attempt", attempt}}}});
}

Stage Stages::flight(const PlanUnit& unit, const ConfigFolder& configs) const {
  const PlannedRun& cell = plan_.cells[unit.cells.front()];
  Stage stage;
  stage.name = "flight " + unit.dataset;
  stage.folder = root_ / "datasets" / unit.dataset;
  std::vector<std::string> call{"simulate",
                                "--world",
                                configs.resolve("worlds", cell.world).string(),
                                "--flight",
                                configs.resolve("flights", cell.flight).string(),
                                "--seed",
                                std::to_string(cell.seed),
                                "--seconds",
                                fmt::format("{}", cell.seconds),
                                "--out",
                                stage.folder.string(),
                                "--configs",
                                configs.root().string(),
                                "--example-scans"};
  for (const std::string& sensor : plan_.spec.sensors)
    call.insert(call.end(), {"--sensor", configs.resolve("sensors", sensor).string()});
  if (plan_.spec.new_scenes) call.emplace_back("--new-scene");
  if (cell.allow_missing) call.emplace_back("--allow-missing");
  if (cell.mode) call.insert(call.end(), {"--mode", value_to_json(*cell.mode).get<std::string>()});
  stage.steps.push_back(
      {"flight", unit.flight, stage.folder / "manifest.json", [call] { return call; }});
  return stage;
}

Step Stages::run_step(const PlanUnit& unit, const PlannedRun& cell, const fs::path& folder) const {
  Step step{"run", {}, folder / "manifest.json", {}};
  step.key = {
      {"flight", unit.flight}, {"code", code_.of_method(cell.algorithm)}, {"cell", to_json(cell)}};
  const ExternalProgram* external = find_external(plan_.spec, cell.algorithm);
  if (external != nullptr) step.key["external"] = to_json(*external);
  // Without its maps, a run cannot be scored again.
  if (!plan_.spec.keep_maps) step.key["maps_removed_after"] = code_.of("scorer");
  step.arguments = [this, &cell, external, folder] {
    const fs::path dataset = root_ / "datasets" / cell.dataset;
    std::vector<std::string> call{"run",
                                  cell.algorithm,
                                  dataset.string(),
                                  "--out",
                                  folder.string(),
                                  "--sensor",
                                  lidar_id_of(dataset, plan_.spec, cell.sensor)};
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

Stage Stages::run(const PlanUnit& unit, std::size_t index) const {
  const PlannedRun& cell = plan_.cells[index];
  Stage stage;
  stage.name = "run " + cell.name;
  stage.cell = &cell;
  stage.folder = root_ / "runs" / cell.name;
  stage.weight = plan_.seconds[index];
  stage.steps.push_back(run_step(unit, cell, stage.folder));
  stage.steps.push_back({"score", code_.of("scorer"), stage.folder / "metrics.json",
                         [folder = stage.folder.string()] {
                           return std::vector<std::string>{"evaluate", folder};
                         }});
  return stage;
}

}  // namespace lidarena::study
