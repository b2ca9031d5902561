// SPDX-License-Identifier: BSD-3-Clause
// Each loop that ALGORITHM+loop verified on a dataset with truth: when, how it was found, what it
// would correct, and how far its measurement is from the truth. Usage:
//   loop_errors ALGORITHM+loop DATASET [KEY=VALUE ...]
#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/odometry/with_loop.hpp"
#include "lidarena/study/simulate_dataset.hpp"

namespace lidarena {
namespace {

void print(const loop::LoopRecord& loop, const std::vector<Time>& stamps, const Trajectory& truth) {
  const std::optional<Pose> first = truth.at(stamps[loop.first]);
  const std::optional<Pose> second = truth.at(stamps[loop.second]);
  if (!first || !second) return;
  const Pose error = (first->inverse() * *second).inverse() * loop.first_from_second;
  fmt::print(
      "| {:.1f} | {:.1f} | {} | {} | {:.4f} | {:.2f} | {:.4f} | {:.1f} | {:.1f} | {:.2f} | {:.2f} "
      "|\n",
      to_seconds(stamps[loop.first] - stamps.front()),
      to_seconds(stamps[loop.second] - stamps.front()),
      loop.by_appearance ? "appearance" : "distance", loop::to_string(loop.verdict), loop.fitness,
      loop.overlap, loop.constraint, 100.0 * loop.translation_m, 1e3 * loop.rotation_rad,
      100.0 * error.translation().norm(), 1e3 * so3::angle(error.linear()));
}

int show(const std::string& algorithm, const std::string& path,
         const std::vector<std::string>& overrides) {
  const Parallel parallel(1);
  dataset::Dataset dataset = study::open_any_dataset(path, {}, parallel);
  const std::optional<Trajectory> truth = dataset::load_truth(path);
  if (!truth) throw InputError(path, "has no ground truth", "use a simulated dataset");
  const LidarInfo* lidar = dataset.rig.find_lidar("");
  const auto odometry =
      odometry::make_odometry({algorithm, "", "", overrides}, dataset.rig, lidar->id, parallel)
          .odometry;
  const auto* with_loop = dynamic_cast<const odometry::WithLoop*>(odometry.get());
  if (with_loop == nullptr) throw InputError(algorithm, "has no loop closure", "use NAME+loop");
  std::vector<Time> stamps;  // of keyframes
  while (const auto event = dataset.events->next()) {
    if (const auto* sample = std::get_if<ImuSample>(&event->data)) odometry->register_imu(*sample);
    const auto* scan = std::get_if<Scan>(&event->data);
    if (scan == nullptr || event->sensor_id != lidar->id) continue;
    const odometry::ScanResult result = odometry->register_scan(*scan);
    if (result.counters.keyframes.value_or(0) > stamps.size())
      stamps.push_back(result.estimate.stamp);
  }
  odometry->finish();
  fmt::print(
      "| first, s | second, s | by | verdict | fitness m^2 | overlap | constraint | corrects cm | "
      "mrad | error cm | mrad |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const loop::LoopRecord& loop : with_loop->loops().records()) print(loop, stamps, *truth);
  return 0;
}

}  // namespace
}  // namespace lidarena

int main(int argc, char** argv) {
  try {
    if (argc < 3)
      throw lidarena::InputError("arguments", "two are needed", "give ALGORITHM+loop and DATASET");
    return lidarena::show(argv[1], argv[2], {argv + 3, argv + argc});
  } catch (const std::exception& error) {
    fmt::print(stderr, "loop_errors: {}\n", error.what());
    return 2;
  }
}
