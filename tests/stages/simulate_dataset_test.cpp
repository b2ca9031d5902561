// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/simulate_dataset.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "lidarena/dataset/json_file.hpp"
#include "tests/study/configs.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::stages {
namespace {

namespace fs = std::filesystem;
using study::kConfigs;

TEST(SimulateDataset, TakesASensorsOwnTableAlongSoThatItCanBeFlownElsewhere) {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  std::ofstream table(folder / "table.csv");
  table << "Time/s,Azimuth/deg,Zenith/deg\n";
  for (int i = 0; i < 500; ++i) table << i << ',' << i % 360 << ',' << 60 + i % 60 << '\n';
  table.close();
  temporary.write("sensor.yaml",
                  "model: livox_csv\npattern_file: table.csv\nrow_rate_hz: 5000\nlines: 4\n");

  SimulateRequest request;
  request.world = kConfigs / "worlds/house.yaml";
  request.flight = kConfigs / "flights/house.yaml";
  request.sensors = {folder / "sensor.yaml"};
  request.seconds = 0.3;
  request.data = false;
  LogSink log;
  simulate_dataset(request, folder / "made", Parallel(1), log);
  const Json manifest = dataset::read_json(folder / "made/manifest.json");
  EXPECT_EQ(manifest["simulation"]["sensors"][0]["pattern_file"], "pattern_0.csv");

  fs::rename(folder / "made", folder / "moved");
  fs::remove(folder / "table.csv");
  const dataset::Dataset dataset = open_any_dataset(folder / "moved", {}, Parallel(1));
  std::size_t points = 0;
  while (const auto event = dataset.events->next()) {
    if (const auto* scan = std::get_if<Scan>(&event->data)) points += scan->points.size();
  }
  EXPECT_EQ(points, 1500U);  // three scans in a closed house: every shot hits
}

}  // namespace
}  // namespace lidarena::stages
