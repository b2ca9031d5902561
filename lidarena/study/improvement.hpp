// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lidarena/sensor/sensor_config.hpp"
#include "lidarena/study/study_spec.hpp"

namespace lidarena::study {

/// Which values of a step are better than those of a sensor.
enum class BetterIf { kLess, kMore };
constexpr auto enum_names(BetterIf) {
  return std::array{std::pair{"less", BetterIf::kLess}, std::pair{"more", BetterIf::kMore}};
}

/// A realistic step by which a LiDAR can be better.
struct ImprovementStep {
  std::string name;
  std::string source;
  BetterIf better = BetterIf::kLess;
  Json set = Json::object();

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "its name in the results");
    v("source", self.source, "", "data sheet or product that has it");
    v("better", self.better, "", "whether less or more is better");
    v("set", self.set, "", "sensor.KEY or imu.KEY: NUMBER");
  }
};

struct ImprovementSteps {
  std::vector<ImprovementStep> steps;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("steps", self.steps, "", "from cheap to costly");
  }
};

/// Reads steps, as in configs/improve.yaml. Throws InputError naming the file if there are none, or
/// one has no name, no source, no settings, or a setting that is no number or not of the sensor.
std::vector<ImprovementStep> load_steps(const std::filesystem::path& file);

/// The steps that make this sensor better, each with those of its settings that do: fewer, or none,
/// if the sensor is as good. Settings of an IMU are none of a sensor without. A pattern's shots and
/// the height of its field of view are compared with those that the sensor has.
std::vector<VariedSet> steps_for(const std::vector<ImprovementStep>& steps,
                                 const sensor::SensorConfig& sensor);

/// What to improve, and where.
struct ImprovementRequest {
  std::string sensor, world, flight;
  std::string algorithm = "arena_lio";
  double seconds = 20.0;
  int seeds = 8;
  bool pairs = false;  ///< also any two steps together
};

/// The study that flies each step alone, on the same flights as the sensor itself.
StudySpec improvement_study(const ImprovementRequest& request, std::vector<VariedSet> steps);

}  // namespace lidarena::study
