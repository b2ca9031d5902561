// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/improvement.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <set>

#include "lidarena/base/error.hpp"

namespace lidarena::study {
namespace {

bool is_of_imu(const std::string& key) { return key.starts_with("imu."); }

/// Throws InputError unless the step is complete.
void check_step(const ImprovementStep& step, const std::string& file) {
  const std::string place = file + ": " + (step.name.empty() ? "a step" : step.name);
  if (step.name.empty() || step.name.find('/') != std::string::npos)
    throw InputError(place, "has no name, or one with '/'", "give it a name: of its own");
  if (step.source.empty())
    throw InputError(place, "has no source", "name the data sheet or product that has it");
  if (!step.set.is_object() || step.set.empty())
    throw InputError(place, "sets nothing", "write set: {sensor.range_noise_m: 0.005}");
  for (const auto& [key, value] : step.set.items()) {
    if (!key.starts_with("sensor.") && !is_of_imu(key))
      throw InputError(place, "sets " + key + ", which is no key of a sensor",
                       "begin the key with sensor. or imu.");
    if (!value.is_number())
      throw InputError(place, "sets " + key + " to what is no number", "give a number");
  }
}

/// The sensor's own value of a key; empty if it has none.
std::optional<double> own_value(const sensor::SensorConfig& sensor, const std::string& key) {
  if (key == "sensor.shape.shots_per_second") {
    const auto pattern = make_pattern(sensor);
    return static_cast<double>(pattern->beams_per_scan()) / to_seconds(pattern->period());
  }
  if (key == "sensor.shape.fov_height_deg") {
    const auto fov = field_of_view(sensor);
    if (!fov) return std::nullopt;
    return fov->elevation_max_deg - fov->elevation_min_deg;
  }
  if (is_of_imu(key) && !sensor.imu) return std::nullopt;
  const Json value = value_at(to_json(sensor), is_of_imu(key) ? key : key.substr(7));
  if (value.is_number()) return value.get<double>();
  throw InputError("step: " + key, "is no number of a sensor",
                   "see: lidarena schema sensor; keys of the IMU begin with imu.");
}

bool is_better(BetterIf better, double value, double own) {
  return better == BetterIf::kLess ? value < own : value > own;
}

}  // namespace

std::vector<ImprovementStep> load_steps(const std::filesystem::path& file) {
  const auto read = load_config<ImprovementSteps>(file);
  if (read.steps.empty())
    throw InputError(file.string(), "has no steps",
                     "list them under steps:, see configs/improve.yaml");
  std::set<std::string> names;
  for (const ImprovementStep& step : read.steps) {
    check_step(step, file.string());
    if (!names.insert(step.name).second)
      throw InputError(file.string() + ": " + step.name, "is the name of two steps",
                       "give each a name of its own");
  }
  return read.steps;
}

std::vector<VariedSet> steps_for(const std::vector<ImprovementStep>& steps,
                                 const sensor::SensorConfig& sensor) {
  std::vector<VariedSet> sets;
  for (const ImprovementStep& step : steps) {
    VariedSet set{step.name, Json::object()};
    for (const auto& [key, value] : step.set.items()) {
      const std::optional<double> own = own_value(sensor, key);
      if (own && is_better(step.better, value.get<double>(), *own)) set.set[key] = value;
    }
    if (!set.set.empty()) sets.push_back(std::move(set));
  }
  return sets;
}

StudySpec improvement_study(const ImprovementRequest& request, std::vector<VariedSet> steps) {
  StudySpec spec;
  spec.title =
      "What would make the " + std::filesystem::path(request.sensor).stem().string() + " better";
  spec.scenes = {{request.world, request.flight, request.seconds}};
  spec.sensors = {request.sensor};
  spec.algorithms = {request.algorithm};
  spec.seeds.clear();
  for (int seed = 1; seed <= request.seeds; ++seed)
    spec.seeds.push_back(static_cast<std::uint64_t>(seed));
  spec.new_scenes = true;
  spec.keep_maps = false;
  spec.sets = std::move(steps);
  spec.sets_as = request.pairs ? SetsAs::kPairs : SetsAs::kEach;
  return spec;
}

}  // namespace lidarena::study
