// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/results/expectation.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "lidarena/study/config_folder.hpp"

namespace lidarena::study {

/// One world and the flight through it.
struct StudyScene {
  std::string world;
  std::string flight;
  double seconds = 0.0;  ///< 0 = the whole flight
  bool allow_missing = false;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("world", self.world, "", "name in configs/worlds, or a file");
    v("flight", self.flight, "", "name in configs/flights, or a file");
    v("seconds", self.seconds, "s", "length of the flight, 0 = all of it", at_least(0));
    v("allow_missing", self.allow_missing, "",
      "load an SDF world without the models and meshes that cannot be found");
  }
};

/// The frame whose poses a program gives.
enum class PoseOf { kBody, kLidar, kImu };
constexpr auto enum_names(PoseOf) {
  return std::array{std::pair{"body", PoseOf::kBody}, std::pair{"lidar", PoseOf::kLidar},
                    std::pair{"imu", PoseOf::kImu}};
}

/// How a program that is a ROS 2 node is fed, and where its results are read: live topics. A node
/// has `odometry` or `path`, or both: then its live poses come from the first and its final ones
/// from the second. See docs/ros2.md.
struct NodeTopics {
  std::string odometry, path, points;
  double rate = 0.0;
  double answer_limit_s = 5.0;
  double start_limit_s = 60.0;

  bool is_used() const { return !odometry.empty() || !path.empty(); }
  /// The topic whose messages answer scans.
  const std::string& answer() const { return odometry.empty() ? path : odometry; }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("odometry", self.odometry, "", "topic of nav_msgs/msg/Odometry with a pose for each scan");
    v("path", self.path, "", "topic of nav_msgs/msg/Path, whose last message is the final one");
    v("points", self.points, "", "topic of the registered clouds, in the frame of the poses");
    v("rate", self.rate, "",
      "speed, times that of the sensor; 0 = each scan after the answer "
      "to the one before",
      at_least(0));
    v("answer_limit_s", self.answer_limit_s, "s", "how long an answer is waited for", above(0));
    v("start_limit_s", self.start_limit_s, "s", "how long the node's topics are waited for",
      above(0));
  }
};

/// A SLAM program that is not part of lidarena, run by a command line. See docs/external_slam.md.
struct ExternalProgram {
  std::string name;
  std::string command;
  dataset::DatasetFormat input = dataset::DatasetFormat::kMcap;
  dataset::Dialect dialect = dataset::Dialect::kSi;
  PoseOf pose_of = PoseOf::kLidar;
  NodeTopics node{};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "name in the tables");
    v("command", self.command, "", "command line, with {input}, {output}, {sensor}, {threads}");
    v("input", self.input, "", "format in which it gets the dataset");
    v("dialect", self.dialect, "", "units and layouts: SI or those of the sensors' drivers");
    v("pose_of", self.pose_of, "", "frame of its poses: of the body, the LiDAR or the IMU");
    v("node", self.node, "", "topics of a ROS 2 node; none = a program that reads files");
  }
};

/// Limits of one run; a run that exceeds one is stopped and becomes a failed row.
struct RunLimits {
  double minutes = 0.0;
  double memory_mb = 0.0;
  double stall_seconds = 600.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("minutes", self.minutes, "min", "maximum time of one run, 0 = no limit", at_least(0));
    v("memory_mb", self.memory_mb, "MB", "maximum memory of one run, 0 = no limit", at_least(0));
    v("stall_seconds", self.stall_seconds, "s", "maximum idle time, 0 = no limit", at_least(0));
  }
};

/// A matrix of scenes, timing modes, sensors, algorithms and seeds.
struct StudySpec {
  std::string base;  ///< file of a study beside this one whose values hold where this has none
  std::string title = "Study";
  std::vector<StudyScene> scenes;
  std::vector<std::string> sensors;
  std::vector<std::string> algorithms;  ///< NAME or NAME:PRESET, or the name of an external program
  std::vector<std::uint64_t> seeds = {1};
  bool new_scenes = false;
  std::vector<sensor::ScanMode> modes;  ///< of all sensors; empty = as in their files
  std::vector<ExternalProgram> external;
  std::string reference;  ///< CSV of published figures, see load_reference(); may be empty
  std::vector<results::Expectation> expect;
  RunLimits limits;
  bool keep_maps = true;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("base", self.base, "",
      "a study's file beside this one, whose values hold where this has none");
    v("title", self.title, "", "heading of the report");
    v("scenes", self.scenes, "", "worlds and the flights through them");
    v("sensors", self.sensors, "", "names in configs/sensors, or files");
    v("algorithms", self.algorithms, "", "NAME or NAME:PRESET, or an external program's name");
    v("seeds", self.seeds, "", "seeds of the noise");
    v("new_scenes", self.new_scenes, "",
      "each seed also has its own world (of a generated one), route and gusts");
    v("modes", self.modes, "", "timing modes of the sensors; none = as in their files");
    v("external", self.external, "", "external SLAM programs, run by a command line");
    v("reference", self.reference, "", "CSV of published figures, beside the study's own");
    v("expect", self.expect, "", "what the figures should show");
    v("limits", self.limits, "", "limits of one run");
    v("keep_maps", self.keep_maps, "", "off: delete a run's maps after scoring; metrics stay");
  }
};

/// One cell of the matrix.
struct PlannedRun {
  std::string name;     ///< folder below runs/
  std::string dataset;  ///< folder below datasets/
  std::string world, flight, sensor, algorithm, preset;
  std::uint64_t seed = 1;
  double seconds = 0.0;                  ///< of flight, 0 = all of it
  bool allow_missing = false;            ///< parts of the world
  std::optional<sensor::ScanMode> mode;  ///< of the sensors; empty = as in their files

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
    v("allow_missing", self.allow_missing, "", "");
    v("mode", self.mode, "", "");
  }
};

/// NAME or NAME:PRESET into its parts, with the algorithm's default preset if none is named.
odometry::OdometryRequest parse_algorithm(const std::string& text);

/// The external program of this name, or null.
const ExternalProgram* find_external(const StudySpec& spec, const std::string& name);

/// Reads a study's file, over the values of its base if it names one. Throws InputError also if the
/// base has a base.
StudySpec load_study(const std::filesystem::path& file);

/// All cells, in the order of scenes, seeds, modes, sensors, algorithms. Throws InputError if the
/// study is incomplete or contradictory, or a name in it does not exist.
std::vector<PlannedRun> planned_cells(const StudySpec& spec, const ConfigFolder& configs);

/// The published figures that a study names: a file, or a name in configs/studies. Columns world,
/// sensor, algorithm, figure, value; empty names stand for all. None without a name. Throws
/// InputError naming file and line.
std::vector<results::ReferenceFigure> load_reference(const StudySpec& spec,
                                                     const ConfigFolder& configs);

/// Part K of N of a plan, 1 <= K <= N.
struct Shard {
  int part = 1;
  int of = 1;
};
/// From "K/N"; throws InputError otherwise.
Shard parse_shard(const std::string& text);
/// Expected cost of a cell, from the length of its flight and its sensor's shots per second.
struct CellEstimate {
  double seconds = 0.0;    ///< on two cores; algorithms differ by a factor of 3
  double record_mb = 0.0;  ///< trajectories, metrics, its share of the flight
  double maps_mb = 0.0;    ///< in addition, if they are kept
};
CellEstimate estimate(const PlannedRun& cell, const ConfigFolder& configs);

/// Expected size of the measurements of a cell's flight, of all sensors of the study, with what
/// scoring needs, bytes.
std::uint64_t data_bytes(const StudySpec& spec, const PlannedRun& cell,
                         const ConfigFolder& configs);

}  // namespace lidarena::study
