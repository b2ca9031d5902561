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
#include "lidarena/stages/config_folder.hpp"
#include "lidarena/stages/external_program.hpp"
#include "lidarena/stages/score_run.hpp"
#include "lidarena/study/study_algorithm.hpp"
#include "lidarena/study/study_recording.hpp"

namespace lidarena::study {

/// One world and the flight through it.
struct StudyScene {
  std::string world;
  std::string flight;
  double seconds = 0.0;  ///< 0 = the whole flight
  bool allow_missing = false;
  std::vector<std::uint64_t> seeds{};  ///< empty = those of the study

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("world", self.world, "", "name in configs/worlds, or a file");
    v("flight", self.flight, "", "name in configs/flights, or a file");
    v("seconds", self.seconds, "s", "length of the flight, 0 = all of it", at_least(0));
    v("allow_missing", self.allow_missing, "",
      "load an SDF world without the models and meshes that cannot be found");
    v("seeds", self.seeds, "", "seeds of this scene alone; none = those of the study");
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

/// How the values of `vary` are combined.
enum class VaryAs {
  kEach,  ///< each value alone, with all else as in the base
  kGrid,  ///< all combinations
};
constexpr auto enum_names(VaryAs) {
  return std::array{std::pair{"each", VaryAs::kEach}, std::pair{"grid", VaryAs::kGrid}};
}

/// How the named sets are combined.
enum class SetsAs {
  kEach,   ///< each set alone
  kPairs,  ///< each set alone, and any two of them together
  kAll,    ///< all combinations of the sets
};
constexpr auto enum_names(SetsAs) {
  return std::array{std::pair{"each", SetsAs::kEach}, std::pair{"pairs", SetsAs::kPairs},
                    std::pair{"all", SetsAs::kAll}};
}

/// Settings that are varied together.
struct VariedSet {
  std::string name;
  Json set = Json::object();

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "its name in the results");
    v("set", self.set, "", "KIND.KEY: VALUE, as in vary");
  }
};

/// A matrix of scenes, timing modes, sensors, algorithms and seeds.
struct StudySpec {
  std::string base;  ///< file of a study beside this one whose values hold where this has none
  std::string title = "Study";
  std::vector<StudyScene> scenes;
  std::vector<StudyRecording> recordings;
  std::vector<std::string> sensors;
  std::vector<StudyAlgorithm> algorithms;
  std::vector<std::uint64_t> seeds = {1};
  bool new_scenes = false;
  Json vary = Json::object();  ///< KIND.key: list of values
  VaryAs vary_as = VaryAs::kEach;
  std::vector<VariedSet> sets;
  SetsAs sets_as = SetsAs::kEach;
  std::vector<sensor::ScanMode> modes;  ///< of all sensors; empty = as in their files
  std::vector<stages::ExternalProgram> external;
  std::string reference;  ///< CSV of published figures, see load_reference(); may be empty
  std::vector<results::Expectation> expect;
  RunLimits limits;
  bool keep_maps = true;
  stages::ScoreParts score;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("base", self.base, "",
      "a study's file beside this one, whose values hold where this has none");
    v("title", self.title, "", "heading of the report");
    v("scenes", self.scenes, "", "worlds and the flights through them");
    v("recordings", self.recordings, "", "recordings with their true trajectories");
    v("sensors", self.sensors, "", "names in configs/sensors, or files");
    v("algorithms", self.algorithms, "",
      "NAME or NAME:PRESET, an external program's name, or a map");
    v("seeds", self.seeds, "", "seeds of the noise");
    v("new_scenes", self.new_scenes, "",
      "each seed also has its own world (of a generated one), route and gusts");
    v("vary", self.vary, "",
      "KIND.KEY: [VALUE, ...] where KIND is world, flight, sensor, imu, algorithm, or the name of "
      "a "
      "sensor or method of the study");
    v("vary_as", self.vary_as, "",
      "each: each value alone; grid: all combinations of the values; the base is always flown");
    v("sets", self.sets, "", "named sets of such settings, beside the base");
    v("sets_as", self.sets_as, "",
      "each: each set alone; pairs: also any two together; all: all combinations of the sets, "
      "for the contribution of each");
    v("modes", self.modes, "", "timing modes of the sensors; none = as in their files");
    v("external", self.external, "", "external SLAM programs, run by a command line");
    v("reference", self.reference, "", "CSV of published figures, beside the study's own");
    v("expect", self.expect, "", "what the figures should show");
    v("limits", self.limits, "", "limits of one run");
    v("keep_maps", self.keep_maps, "", "off: delete a run's maps after scoring; metrics stay");
    v("score", self.score, "",
      "trajectory, map, vertices (the distance to the mesh's vertices, too); none = trajectory and "
      "map. A map takes most of the time");
  }
};

/// One cell of the matrix.
struct PlannedRun {
  std::string name;     ///< folder below runs/
  std::string dataset;  ///< folder below datasets/
  std::string world, flight, sensor, algorithm, preset;
  std::string as;                  ///< name of the method in the results; empty: algorithm
  Json settings = Json::object();  ///< of the method, over its preset
  int parts = 1;                   ///< scans in which each sweep is handed over
  std::vector<std::string> also;   ///< sensors whose points are added to the scans
  std::vector<std::string> set;    ///< "KIND.key=value" of the flight, over its files
  std::string variation;           ///< what differs from the base, in words; empty: nothing
  Json varied = Json::object();    ///< each key that the study varies, with its value here
  /// Keys of `varied` whose value is not that of the base; of named sets, their names.
  std::vector<std::string> differs;
  std::string method_part;  ///< of the name: settings of the method
  std::string recording;    ///< name of the recording; empty: the flight is simulated
  std::uint64_t seed = 1;
  double seconds = 0.0;                  ///< of flight, 0 = all of it
  bool allow_missing = false;            ///< parts of the world
  std::optional<sensor::ScanMode> mode;  ///< of the sensors; empty = as in their files

  const std::string& label() const { return as.empty() ? algorithm : as; }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "folder below runs/");
    v("dataset", self.dataset, "", "folder below datasets/");
    v("world", self.world, "", "");
    v("flight", self.flight, "", "");
    v("sensor", self.sensor, "", "");
    v("algorithm", self.algorithm, "", "");
    v("preset", self.preset, "", "");
    v("as", self.as, "", "");
    v("settings", self.settings, "", "");
    v("parts", self.parts, "", "");
    v("also", self.also, "", "");
    v("set", self.set, "", "");
    v("variation", self.variation, "", "");
    v("varied", self.varied, "", "");
    v("differs", self.differs, "", "");
    v("recording", self.recording, "", "");
    v("seed", self.seed, "", "");
    v("seconds", self.seconds, "s", "");
    v("allow_missing", self.allow_missing, "", "");
    v("mode", self.mode, "", "");
  }
};

/// NAME or NAME:PRESET into its parts, with the algorithm's default preset if none is named.
odometry::OdometryRequest parse_algorithm(const std::string& text);

/// The recording of a cell, or null if its flight is simulated.
const StudyRecording* recording_of(const StudySpec& spec, const PlannedRun& cell);

/// The external program of this name, or null.
const stages::ExternalProgram* find_external(const StudySpec& spec, const std::string& name);

/// Reads a study's file, over the values of its base if it names one. Throws InputError also if the
/// base has a base.
StudySpec load_study(const std::filesystem::path& file);

/// All cells, in the order of scenes, seeds, modes, variations, sensors, algorithms. A cell in
/// which no setting of a variation changes anything is that of the base, planned once. Throws
/// InputError if the study is incomplete or contradictory, a name in it does not exist, or a key or
/// value of a variation is not allowed.
std::vector<PlannedRun> planned_cells(const StudySpec& spec, const stages::ConfigFolder& configs);

/// The published figures that a study names: a file, or a name in configs/studies. Columns world,
/// sensor, algorithm, figure, value; empty names stand for all. None without a name. Throws
/// InputError naming file and line.
std::vector<results::ReferenceFigure> load_reference(const StudySpec& spec,
                                                     const stages::ConfigFolder& configs);

/// Part K of N of a plan, 1 <= K <= N.
struct Shard {
  int part = 1;
  int of = 1;
};
/// From "K/N"; throws InputError otherwise.
Shard parse_shard(const std::string& text);
/// Expected cost of a cell, from the length of its flight and its sensor's shots per second, or
/// from the size of its recording.
struct CellEstimate {
  double seconds = 0.0;    ///< on two cores; algorithms differ by a factor of 3
  double record_mb = 0.0;  ///< trajectories, metrics, its share of the flight
  double maps_mb = 0.0;    ///< in addition, if they are kept
};
CellEstimate estimate(const StudySpec& spec, const PlannedRun& cell,
                      const stages::ConfigFolder& configs);

/// Expected size of the measurements of a cell's flight, of all sensors of the study, with what
/// scoring needs, bytes.
std::uint64_t data_bytes(const StudySpec& spec, const PlannedRun& cell,
                         const stages::ConfigFolder& configs);

}  // namespace lidarena::study
