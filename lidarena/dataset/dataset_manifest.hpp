// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/rig.hpp"

namespace lidarena::dataset {

/// How a dataset was simulated: all that is needed to simulate it again, beside its files.
struct SimulationRecord {
  std::string world, flight, flight_source;
  std::uint64_t seed = 1;
  bool new_scene = false;
  double seconds = 0.0;
  bool noise = true;
  std::string mode;
  bool allow_missing = false;
  std::vector<std::string> set;
  std::vector<std::string> sensor_sources;
  std::vector<Json> sensors;
  Json routes;
  std::vector<Json> movers;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("world", self.world, "", "file from which world.ply was made");
    v("flight", self.flight, "", "file of the flight in this folder");
    v("flight_source", self.flight_source, "", "its name when it was flown");
    v("seed", self.seed, "", "of all noise");
    v("new_scene", self.new_scene, "", "the seed also drew world, start and gusts");
    v("seconds", self.seconds, "s", "length of the flight");
    v("noise", self.noise, "", "");
    v("mode", self.mode, "", "timing mode of all sensors; empty: as in their files");
    v("allow_missing", self.allow_missing, "",
      "parts of the world that cannot be found are left out");
    v("set", self.set, "", "KIND.key=value: settings over the files of world, flight and sensors");
    v("sensor_sources", self.sensor_sources, "", "files of the sensors");
    v("sensors", self.sensors, "", "complete settings of each sensor, see the schema of a sensor");
    v("routes", self.routes, "", "the world's routes");
    v("movers", self.movers, "",
      "what moves in the world, with what was drawn, see the schema of a world");
  }
};

/// What the manifest of a dataset says that was written by `lidarena simulate`.
struct DatasetManifest {
  std::string kind = "dataset";
  Rig rig;
  std::optional<SimulationRecord> simulation;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("kind", self.kind, "", "dataset");
    v("rig", self.rig, "", "sensors and their mounting");
    v("simulation", self.simulation, "", "null: the dataset was recorded");
  }
};

/// Empty if the folder has no manifest. Throws InputError when it is damaged.
std::optional<DatasetManifest> read_dataset_manifest(const std::filesystem::path& folder);

}  // namespace lidarena::dataset
