// SPDX-License-Identifier: BSD-3-Clause
// Fly a Mid-360 through the House and write its data. usage: example_02_simulate_flight [FOLDER]
#include <cstdio>

#include "lidarena/stages/config_folder.hpp"
#include "lidarena/stages/simulate_dataset.hpp"

int main(int argc, char** argv) {
  using namespace lidarena;
  const std::string folder = argc > 1 ? argv[1] : "out/house_flight";
  const stages::ConfigFolder configs = stages::ConfigFolder::find(".");
  stages::SimulateRequest request;
  request.world = configs.resolve("worlds", "house");
  request.flight = configs.resolve("flights", "house");
  request.sensors = {configs.resolve("sensors", "livox_mid360")};
  request.seconds = 2.0;
  LogSink silent;
  const stages::SimulateSummary done =
      stages::simulate_dataset(request, folder, Parallel(), silent);
  std::printf("%zu scans, %zu points, %zu IMU samples along %.2f m, in %s\n", done.scans,
              done.points, done.imu_samples, done.path_m, folder.c_str());

  // Events are read in order, each scan after the IMU samples that span it.
  dataset::Dataset dataset = dataset::open_dataset(folder);
  while (const auto event = dataset.events->next()) {
    const auto* scan = std::get_if<Scan>(&event->data);
    if (scan == nullptr) continue;
    std::printf("first scan of %s: %zu points\n", event->sensor_id.c_str(), scan->points.size());
    break;
  }
  return done.scans == 20 && dataset.scan_count == 20 ? 0 : 1;
}
