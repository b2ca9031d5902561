// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/tasks.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lidarena/dataset/dataset_manifest.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/md5.hpp"

namespace lidarena::study {
namespace {

/// As `evaluate --score` takes them; empty for those of a study that names none.
std::string score_parts_text(const stages::ScoreParts& parts) {
  std::string text;
  for (const stages::ScorePart part : parts)
    text += (text.empty() ? "" : ",") + value_to_json(part).get<std::string>();
  return text;
}

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

/// The sensor's id in the dataset, whose LiDARs are in the order of `sensors`.
std::string lidar_id_of(const fs::path& dataset, const std::vector<std::string>& sensors,
                        const std::string& sensor) {
  const auto manifest = dataset::read_dataset_manifest(dataset);
  for (std::size_t i = 0; manifest && i < sensors.size(); ++i) {
    if (sensors[i] == sensor) return manifest->rig.lidars.at(i).id;
  }
  return sensor;
}

/// x,y,z,qx,qy,qz,qw
std::string text_of(const Pose& pose) {
  const std::string list = value_to_json(pose).dump();
  return list.substr(1, list.size() - 2);
}

std::vector<std::string> arguments_of(const StudyRecording& recording) {
  std::vector<std::string> call{recording.file, "--rate", fmt::format("{}", recording.rate_hz)};
  const auto add = [&](const char* name, const std::string& value) {
    if (!value.empty()) call.insert(call.end(), {name, value});
  };
  add("--sensor", recording.sensor);
  add("--imu-topic", recording.imu_topic);
  add("--layout", recording.layout);
  if (recording.body_from_lidar)
    add("--extrinsics", "body_from_lidar=" + text_of(*recording.body_from_lidar));
  return call;
}

std::vector<std::string> truth_arguments_of(const StudyRecording& recording) {
  std::vector<std::string> call{"--truth", recording.truth};
  if (!recording.truth_topic.empty())
    call.insert(call.end(), {"--truth-topic", recording.truth_topic});
  if (recording.truth_from_body)
    call.insert(call.end(), {"--lever", text_of(*recording.truth_from_body)});
  return call;
}

}  // namespace

std::size_t Task::first_open_step() const { return first_open(steps, request_of(folder)); }

std::string Task::key() const {
  Json keys = Json::object();
  for (const Step& step : steps) keys[step.name] = step.key;
  return dataset::md5_of(keys.dump());
}

TaskResult Task::result() const {
  const Json request = request_of(folder);
  const Json told = request.value("result", Json::object());
  const std::string state = told.value("state", "");
  TaskResult result;
  result.seconds = told.value("seconds", 0.0);
  result.attempt = told.value("attempt", 0);
  if (state == "failed") {
    result.state = TaskState::kFailed;
  } else if (first_open(steps, request) == steps.size()) {
    result.state = state == "diverged" ? TaskState::kDiverged : TaskState::kOk;
  }
  return result;
}

void Task::record(std::size_t step, double seconds, bool diverged) const {
  Json done = Json::object();
  for (std::size_t i = 0; i <= step; ++i) done[steps[i].name] = steps[i].key;
  if (step + 1 == steps.size()) {
    done["result"] = {
        {"state", diverged ? "diverged" : "ok"}, {"seconds", seconds}, {"key", key()}};
  }
  dataset::write_json(folder / kRequest, done);
}

void Task::record_failure(double seconds, int attempt) const {
  dataset::write_json(
      folder / kRequest,
      {{"result", {{"state", "failed"}, {"seconds", seconds}, {"attempt", attempt}}}});
}

Task Tasks::flight(const PlanUnit& unit, const stages::ConfigFolder& configs) const {
  const PlannedRun& cell = plan_.cells[unit.cells.front()];
  Task task;
  task.name = "flight " + unit.dataset;
  task.folder = root_ / "datasets" / unit.dataset;
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
                                task.folder.string(),
                                "--configs",
                                configs.root().string(),
                                "--hits",
                                stages::scores_maps(plan_.spec.score) ? "on" : "off",
                                "--example-scans"};
  for (const std::string& sensor : sensors_of(plan_, unit))
    call.insert(call.end(), {"--sensor", configs.resolve("sensors", sensor).string()});
  for (const std::string& set : cell.set) call.insert(call.end(), {"--set", set});
  if (plan_.spec.new_scenes) call.emplace_back("--new-scene");
  if (cell.allow_missing) call.emplace_back("--allow-missing");
  if (cell.mode) call.insert(call.end(), {"--mode", value_to_json(*cell.mode).get<std::string>()});
  task.steps.push_back(
      {"flight", unit.flight, task.folder / "manifest.json", [call] { return call; }});
  return task;
}

Step Tasks::run_step(const PlanUnit& unit, const PlannedRun& cell, const fs::path& folder) const {
  Step step{"run", {}, folder / "manifest.json", {}};
  Json named = to_json(cell);  // the content of its files is in the key of the flight
  const auto filename = [](const Json& path) {
    return fs::path(path.get<std::string>()).filename().string();
  };
  for (const char* file : {"world", "flight", "sensor"}) named[file] = filename(named[file]);
  for (Json& sensor : named["also"]) sensor = filename(sensor);
  // what the study calls its settings, which are in `set` and `settings`
  for (const char* title : {"variation", "varied", "differs"}) named.erase(title);
  if (cell.also.empty()) named.erase("also");  // keys are those of versions without it
  step.key = {{"flight", unit.flight}, {"code", code_.of_method(cell.algorithm)}, {"cell", named}};
  const stages::ExternalProgram* external = find_external(plan_.spec, cell.algorithm);
  if (external != nullptr) step.key["external"] = to_json(*external);
  // Without its maps, a run cannot be scored again.
  if (!plan_.spec.keep_maps) step.key["maps_removed_after"] = code_.of("scorer");
  if (!stages::scores_maps(plan_.spec.score)) step.key["maps"] = "none";
  step.arguments = [this, &cell, external, folder, sensors = sensors_of(plan_, unit)] {
    std::vector<std::string> call{"run", cell.algorithm};
    if (const StudyRecording* recording = recording_of(plan_.spec, cell)) {
      std::ranges::move(arguments_of(*recording), std::back_inserter(call));
    } else {
      const fs::path dataset = root_ / "datasets" / cell.dataset;
      call.insert(call.end(),
                  {dataset.string(), "--sensor", lidar_id_of(dataset, sensors, cell.sensor)});
      for (const std::string& sensor : cell.also)
        call.insert(call.end(), {"--also", lidar_id_of(dataset, sensors, sensor)});
    }
    call.insert(call.end(), {"--out", folder.string()});
    if (external != nullptr) {
      dataset::write_json(folder / kExternal, to_json(*external));
      call.insert(call.end(), {"--external", (folder / kExternal).string()});
    } else if (!cell.preset.empty()) {
      call.insert(call.end(), {"--preset", cell.preset});
    }
    for (const std::string& set : assignments_of(cell.settings))
      call.insert(call.end(), {"--set", set});
    if (external == nullptr && cell.parts != odometry::parts_of({cell.algorithm, cell.preset}))
      call.insert(call.end(), {"--parts", std::to_string(cell.parts)});
    if (!stages::scores_maps(plan_.spec.score)) call.insert(call.end(), {"--maps", "off"});
    return call;
  };
  return step;
}

Task Tasks::run(const PlanUnit& unit, std::size_t index) const {
  const PlannedRun& cell = plan_.cells[index];
  Task task;
  task.name = "run " + cell.name;
  task.cell = &cell;
  task.folder = root_ / "runs" / cell.name;
  task.weight = plan_.seconds[index];
  task.steps.push_back(run_step(unit, cell, task.folder));
  Json score_key = code_.of("scorer");
  const std::string parts = score_parts_text(plan_.spec.score);
  if (!parts.empty()) score_key["parts"] = parts;
  task.steps.push_back(
      {"score", score_key, task.folder / "metrics.json",
       [folder = task.folder.string(), parts, recording = recording_of(plan_.spec, cell)] {
         std::vector<std::string> call{"evaluate", folder};
         if (!parts.empty()) call.insert(call.end(), {"--score", parts});
         if (recording != nullptr)
           std::ranges::move(truth_arguments_of(*recording), std::back_inserter(call));
         return call;
       }});
  return task;
}

}  // namespace lidarena::study
