// SPDX-License-Identifier: BSD-3-Clause
// Define a study: two sensors and one algorithm in your own room. Each run is a call of the program
// lidarena, which must be in PATH (or give StudyOptions::program); when called again, it does only
// the missing runs. `lidarena report FOLDER` writes the report.
// usage: example_07_own_study [FOLDER]
#include <cstdio>
#include <fstream>

#include "lidarena/results/run_metrics.hpp"
#include "lidarena/study/study.hpp"
#include "lidarena/world/export_world.hpp"
#include "lidarena/world/primitives.hpp"

int main(int argc, char** argv) {
  using namespace lidarena;
  const std::filesystem::path folder = argc > 1 ? argv[1] : "out/own_study";
  std::filesystem::create_directories(folder);
  world::save_world(folder / "room.ply", world::box_shape({8.0, 6.0, 3.0}));
  std::ofstream(folder / "path.yaml") << "kind: waypoints\n"
                                         "waypoints: [[-2, -1, 0], [0, 1, 0.2], [2, 0, 0]]\n";
  study::StudySpec spec;  // or load_config<StudySpec>("my_study.yaml"); the keys are the same
  spec.title = "Which sensor suits KISS-ICP here?";
  spec.scenes = {{(folder / "room.ply").string(), (folder / "path.yaml").string(), 3.0}};
  spec.sensors = {"livox_mid360", "velodyne_vlp16"};
  spec.algorithms = {"kiss_icp"};

  LogSink silent;
  const stages::ConfigFolder configs = stages::ConfigFolder::find(".");
  const study::StudyOutcome outcome = study::run_study(spec, configs, folder, {}, silent);
  for (const study::PlannedRun& planned : study::planned_cells(spec, configs)) {
    const auto metrics = results::read_metrics(folder / "runs" / planned.name);
    if (!metrics.live || !metrics.live->rpe) continue;
    std::printf("%-16s %.2f cm RPE over 1 s\n", planned.sensor.c_str(),
                100.0 * metrics.live->rpe->over_1s.translation.rmse);
  }
  return outcome.runs == 2 && outcome.failed == 0 ? 0 : 1;
}
