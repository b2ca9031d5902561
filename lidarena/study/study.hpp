// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/log.hpp"
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

/// A matrix of scenes, sensors, algorithms and seeds.
struct StudySpec {
  std::string title = "Study";
  std::vector<StudyScene> scenes;
  std::vector<std::string> sensors;
  std::vector<std::string> algorithms;  ///< NAME or NAME:PRESET
  std::vector<std::uint64_t> seeds = {1};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("title", self.title, "", "heading of the report");
    v("scenes", self.scenes, "", "worlds and the flights through them");
    v("sensors", self.sensors, "", "names in configs/sensors, or files");
    v("algorithms", self.algorithms, "", "NAME or NAME:PRESET");
    v("seeds", self.seeds, "", "seeds of the noise");
  }
};

/// One cell of the matrix.
struct PlannedRun {
  std::string name;     ///< folder below runs/
  std::string dataset;  ///< folder below datasets/
  std::string world, flight, sensor, algorithm, preset;
  std::uint64_t seed = 1;

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
  }
};

/// All cells, in the order of scenes, seeds, sensors, algorithms. Throws InputError for names that
/// do not exist, before any work starts.
std::vector<PlannedRun> plan(const StudySpec& spec, const ConfigFolder& configs);

struct StudyOutcome {
  std::size_t runs = 0;
  std::size_t reused = 0;  ///< found complete in the folder
  std::size_t failed = 0;  ///< crashed or refused
  std::size_t diverged = 0;
};

/// Flies, runs and scores every cell, each in a process of its own, below `out`: datasets/, runs/
/// and study.json. Cells that are complete there already are kept. A failed cell is recorded with
/// its reason and does not stop the others. The caller must not have started threads.
StudyOutcome run_study(const StudySpec& spec, const ConfigFolder& configs,
                       const std::filesystem::path& out, int threads, LogSink& log);

}  // namespace lidarena
