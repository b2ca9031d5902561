// SPDX-License-Identifier: BSD-3-Clause
// Run an odometry on your bag. usage: example_05_odometry_on_a_bag [BAG_OR_MCAP [ALGORITHM]]
// Without a bag (or with a folder) it first simulates one: 3 s in the House, as a ROS 1 bag.
#include <cstdio>
#include <filesystem>

#include "lidarena/dataset/trajectories/tum.hpp"
#include "lidarena/flight/make_flight.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/scenes/load_world.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "lidarena/stages/config_folder.hpp"
#include "lidarena/stages/recorder.hpp"
#include "lidarena/stages/simulate_dataset.hpp"

namespace {

using namespace lidarena;

void record(const std::filesystem::path& bag) {
  LogSink silent;
  const stages::ConfigFolder configs = stages::ConfigFolder::find(".");
  world::WorldModel model = scenes::load_world(configs.resolve("worlds", "house"), {}, silent);
  const world::World world(std::move(model.mesh), model.name);
  const auto flight =
      flight::make_flight(configs.resolve("flights", "house"), model, world, silent);
  const std::vector sensors{sensor::load_sensor(configs.resolve("sensors", "livox_mid360"))};
  sensor::SimulationOptions options;
  options.duration = std::chrono::seconds(3);
  const auto events = sensor::simulate(world, *flight, sensors, options, Parallel());
  dataset::DatasetWriter writer(bag, sensor::make_rig(sensors));
  while (const auto event = events->next()) writer.write(*event);
  writer.close();
}

}  // namespace

int main(int argc, char** argv) {
  std::filesystem::path bag = argc > 1 ? argv[1] : "out";
  if (!bag.has_extension()) {
    std::filesystem::create_directories(bag);
    bag /= "my.bag";
    record(bag);
  }
  dataset::Dataset dataset = dataset::open_dataset(bag);
  for (const std::string& note : dataset.notes) std::printf("note: %s\n", note.c_str());
  odometry::OdometryRequest request;
  request.algorithm = argc > 2 ? argv[2] : "kiss_icp";
  const odometry::MadeOdometry made = odometry::make_odometry(request, dataset.rig, "", Parallel());
  LogSink silent;
  const stages::RunResult result = stages::record_run(*made.odometry, *dataset.events, {}, silent);
  std::printf("%s: %zu scans, %.2f m, %.1f times real time, a map of %zu points\n",
              request.algorithm.c_str(), result.summary.scans,
              result.files.trajectory.path_length(),
              result.summary.sensor_seconds / result.summary.compute_seconds,
              result.files.map.points.size());
  dataset::write_tum(bag.replace_extension(".tum"), result.files.trajectory, "world_from_body");
  return result.summary.scans > 0 && !result.summary.diverged ? 0 : 1;
}
