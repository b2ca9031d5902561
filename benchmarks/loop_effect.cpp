// SPDX-License-Identifier: BSD-3-Clause
// Effect of each loop on the map: runs arena_lio+loop without and with loops on a dataset and
// prints the error of both maps against the mesh after each scan that added a loop, and at the end
// (SE(3) gauge on the flight up to then, at most 200,000 points). Usage:
//   loop_effect DATASET [KEY=VALUE ...]
#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/evaluation/map/map_error.hpp"
#include "lidarena/evaluation/trajectory/alignment.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/study/simulate_dataset.hpp"
#include "lidarena/world/mesh_io.hpp"

namespace lidarena {
namespace {

evaluation::MapError error_of(const odometry::Odometry& odometry, const Trajectory& truth,
                              const world::World& world, const Parallel& parallel) {
  constexpr std::size_t kMaxPoints = 200'000;
  const std::vector<Eigen::Vector3f> map = odometry.map();
  std::vector<Eigen::Vector3f> sample;
  const std::size_t stride = map.size() / kMaxPoints + 1;
  for (std::size_t i = 0; i < map.size(); i += stride) sample.push_back(map[i]);
  const evaluation::Alignment alignment =
      evaluation::align(odometry.trajectory(), truth, evaluation::Gauge::kSe3);
  return evaluation::map_error(sample, alignment.truth_from_estimate, world, parallel);
}

struct Contest {
  std::unique_ptr<odometry::Odometry> without, with;
  const Trajectory& truth;
  const world::World& world;
  const Parallel& parallel;

  void print(Time stamp, std::uint64_t loops, std::uint64_t tried) const {
    const evaluation::MapError a = error_of(*without, truth, world, parallel);
    const evaluation::MapError b = error_of(*with, truth, world, parallel);
    fmt::print("| {:.1f} | {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n",
               to_seconds(stamp - truth.begin_time()), loops, tried, 100.0 * a.distance_m.rmse,
               a.outliers_percent.value_or(0.0), 100.0 * b.distance_m.rmse,
               b.outliers_percent.value_or(0.0));
    std::fflush(stdout);
  }
};

int show(const std::string& path, const std::vector<std::string>& overrides) {
  const Parallel parallel(0);
  dataset::Dataset dataset = study::open_any_dataset(path, {}, parallel);
  const std::optional<Trajectory> truth = dataset::load_truth(path);
  if (!truth) throw InputError(path, "has no ground truth", "use a simulated dataset");
  const world::World world(world::load_mesh(path + "/world.ply"));
  const LidarInfo* lidar = dataset.rig.find_lidar("");
  const auto made = [&](const std::vector<std::string>& settings) {
    return odometry::make_odometry({"arena_lio+loop", "", "", settings}, dataset.rig, lidar->id,
                                   parallel)
        .odometry;
  };
  std::vector<std::string> no_loops = overrides;
  no_loops.insert(no_loops.end(),
                  {"loops.loop.search_radius_m=0", "loops.loop.descriptor_candidates=0"});
  const Contest contest{made(no_loops), made(overrides), *truth, world, parallel};
  fmt::print(
      "| s | loops | tried | RMSE cm | > 20 cm % | with loops: RMSE cm | > 20 cm % |\n"
      "|---|---|---|---|---|---|---|\n");
  std::uint64_t loops = 0;
  std::uint64_t tried = 0;
  Time last{0};
  while (const auto event = dataset.events->next()) {
    if (const auto* sample = std::get_if<ImuSample>(&event->data)) {
      contest.without->register_imu(*sample);
      contest.with->register_imu(*sample);
      continue;
    }
    const auto* scan = std::get_if<Scan>(&event->data);
    if (scan == nullptr || event->sensor_id != lidar->id) continue;
    contest.without->register_scan(*scan);
    const odometry::ScanResult result = contest.with->register_scan(*scan);
    last = scan->stamp;
    tried = result.counters.loops_tried.value_or(tried);
    if (result.counters.loops.value_or(loops) <= loops) continue;
    loops = *result.counters.loops;
    contest.print(last, loops, tried);
  }
  contest.without->finish();
  contest.with->finish();
  contest.print(last, loops, tried);
  return 0;
}

}  // namespace
}  // namespace lidarena

int main(int argc, char** argv) {
  try {
    if (argc < 2) throw lidarena::InputError("arguments", "one is needed", "give DATASET");
    return lidarena::show(argv[1], {argv + 2, argv + argc});
  } catch (const std::exception& error) {
    fmt::print(stderr, "loop_effect: {}\n", error.what());
    return 2;
  }
}
