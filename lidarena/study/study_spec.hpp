// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "lidarena/study/config_folder.hpp"

namespace lidarena {

/// One world and the flight through it.
struct StudyScene {
  std::string world;
  std::string flight;
  double seconds = 0.0;  ///< 0 = the whole flight

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("world", self.world, "", "name in configs/worlds, or a file");
    v("flight", self.flight, "", "name in configs/flights, or a file");
    v("seconds", self.seconds, "s", "length of the flight, 0 = all of it", at_least(0));
  }
};

/// What moves along the poses that a program gives.
enum class PoseOf { kBody, kLidar, kImu };
template <>
struct EnumNames<PoseOf> {
  static constexpr std::array names{std::pair{"body", PoseOf::kBody},
                                    std::pair{"lidar", PoseOf::kLidar},
                                    std::pair{"imu", PoseOf::kImu}};
};

/// A program of someone else's, run by a command line. See docs/external_slam.md.
struct ExternalProgram {
  std::string name;
  std::string command;
  DatasetFormat input = DatasetFormat::kMcap;
  Dialect dialect = Dialect::kSi;
  PoseOf pose_of = PoseOf::kLidar;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "what the tables call it");
    v("command", self.command, "", "command line, with {input}, {output}, {sensor}, {threads}");
    v("input", self.input, "", "form in which it gets the dataset");
    v("dialect", self.dialect, "", "units and layouts: ours or those of the sensors' drivers");
    v("pose_of", self.pose_of, "", "what its poses are of: the body, the LiDAR or the IMU");
  }
};

/// What one run may use; a run beyond it is stopped and becomes a failed row.
struct RunLimits {
  double minutes = 0.0;
  double memory_mb = 0.0;
  double stall_seconds = 600.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("minutes", self.minutes, "min", "longest time of one run, 0 = no limit", at_least(0));
    v("memory_mb", self.memory_mb, "MB", "most memory of one run, 0 = no limit", at_least(0));
    v("stall_seconds", self.stall_seconds, "s", "longest idle time, 0 = no limit", at_least(0));
  }
};

/// A matrix of scenes, timing modes, sensors, algorithms and seeds.
struct StudySpec {
  std::string title = "Study";
  std::vector<StudyScene> scenes;
  std::vector<std::string> sensors;
  std::vector<std::string> algorithms;  ///< NAME or NAME:PRESET, or the name of an external program
  std::vector<std::uint64_t> seeds = {1};
  std::vector<ScanMode> modes;  ///< of all sensors; none = as their files say
  std::vector<ExternalProgram> external;
  RunLimits limits;
  bool keep_maps = true;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("title", self.title, "", "heading of the report");
    v("scenes", self.scenes, "", "worlds and the flights through them");
    v("sensors", self.sensors, "", "names in configs/sensors, or files");
    v("algorithms", self.algorithms, "", "NAME or NAME:PRESET, or an external program's name");
    v("seeds", self.seeds, "", "seeds of the noise");
    v("modes", self.modes, "", "timing modes of the sensors; none = as their files say");
    v("external", self.external, "", "programs of others that run by a command line");
    v("limits", self.limits, "", "what one run may use");
    v("keep_maps", self.keep_maps, "", "off: a run's maps go once they are scored, figures stay");
  }
};

/// One cell of the matrix.
struct PlannedRun {
  std::string name;     ///< folder below runs/
  std::string dataset;  ///< folder below datasets/
  std::string world, flight, sensor, algorithm, preset;
  std::uint64_t seed = 1;
  double seconds = 0.0;          ///< of flight, 0 = all of it
  std::optional<ScanMode> mode;  ///< of the sensors; none = as their files say

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "folder below runs/");
    v("dataset", self.dataset, "", "folder below datasets/");
    v("world", self.world, "", "");
    v("flight", self.flight, "", "");
    v("sensor", self.sensor, "", "");
    v("algorithm", self.algorithm, "", "");
    v("preset", self.preset, "", "");
    v("seed", self.seed, "", "");
    v("seconds", self.seconds, "s", "");
    v("mode", self.mode, "", "");
  }
};

/// The program of this name, or none.
const ExternalProgram* find_external(const StudySpec& spec, const std::string& name);

/// All cells, in the order of scenes, seeds, modes, sensors, algorithms. Throws InputError for
/// names that do not exist, before any work starts.
std::vector<PlannedRun> plan(const StudySpec& spec, const ConfigFolder& configs);

/// Part K of N of a plan, 1 <= K <= N.
struct Shard {
  int part = 1;
  int of = 1;
};
/// From "K/N"; throws InputError otherwise.
Shard parse_shard(const std::string& text);
/// What a cell is expected to take, from the length of its flight and its sensor's shots.
struct CellEstimate {
  double seconds = 0.0;  ///< of two processor cores, as seen once; algorithms differ by times three
  double record_mb = 0.0;  ///< trajectories, figures, its share of the flight
  double maps_mb = 0.0;    ///< on top, where they are kept
};
CellEstimate estimate(const PlannedRun& cell, const ConfigFolder& configs);

/// The cells of a part: neighbors, so that few flights are flown by two parts, and as many as are
/// expected to take an N-th of the time.
std::vector<PlannedRun> cells_of(const std::vector<PlannedRun>& cells, const Shard& shard,
                                 const ConfigFolder& configs);

}  // namespace lidarena
