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

std::vector<Point> points_of(const fs::path& folder) {
  const dataset::Dataset dataset = open_any_dataset(folder, {}, Parallel(1));
  std::vector<Point> points;
  while (const auto event = dataset.events->next()) {
    const auto* scan = std::get_if<Scan>(&event->data);
    if (scan != nullptr) points.insert(points.end(), scan->points.begin(), scan->points.end());
  }
  return points;
}

std::size_t differing(const std::vector<Point>& a, const std::vector<Point>& b) {
  if (a.size() != b.size()) return std::max(a.size(), b.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i].position != b[i].position ? 1 : 0;
  return count;
}

TEST(SimulateDataset, ShowsWhatMovesAndSimulatesItAgainFromTheManifest) {
  const TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  const std::string house = "kind: house\nseed: 1\n";
  temporary.write("still.yaml", house);
  temporary.write("living.yaml", house +
                                     "people: 4\nmovers:\n  - {name: cart, kind: box, path: "
                                     "[[4, 4, 0], [8, 4, 0]], size: [1, 0.6, 1.2]}\n");
  SimulateRequest request;
  request.flight = kConfigs / "flights/house.yaml";
  request.sensors = {kConfigs / "sensors/livox_mid360.yaml"};
  request.seconds = 1.0;
  LogSink log;
  const auto simulated = [&](const char* world, const char* name, bool data) {
    request.world = folder / world;
    request.data = data;
    simulate_dataset(request, folder / name, Parallel(2), log);
    return points_of(folder / name);
  };
  const auto still = simulated("still.yaml", "still", true);
  const auto living = simulated("living.yaml", "living", true);
  EXPECT_EQ(differing(living, simulated("living.yaml", "again", false)), 0U);
  const Json manifest = dataset::read_json(folder / "again/manifest.json");
  EXPECT_EQ(manifest["simulation"]["movers"].size(), 5U);
  EXPECT_GT(differing(still, living), 200U);
}

}  // namespace
}  // namespace lidarena::stages
