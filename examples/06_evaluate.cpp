// SPDX-License-Identifier: BSD-3-Clause
// Score the trajectory and map of any program.
// usage: example_06_evaluate [ESTIMATE TRUTH [MAP MESH]]
// Trajectories are TUM, KITTI or EuRoC files; the map is PLY or PCD in the estimate's frame.
// Without files it uses a generated estimate with a drift of 1 %, so that the result is known.
#include <cmath>
#include <cstdio>

#include "lidarena/dataset/trajectories/trajectory_io.hpp"
#include "lidarena/evaluation/evaluate_run.hpp"
#include "lidarena/evaluation/map/map_error.hpp"
#include "lidarena/world/mesh_io.hpp"

namespace {

using namespace lidarena;

/// Along a circle of 5 m radius, scaled about its first pose.
Trajectory circle(double scale) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < 400; ++i) {
    const double angle = 0.01 * i;
    Pose pose = Pose::Identity();
    pose.translation() = 5.0 * scale * Eigen::Vector3d(std::sin(angle), 1.0 - std::cos(angle), 0);
    poses.push_back({std::chrono::milliseconds(50 * i), pose});
  }
  return Trajectory(std::move(poses));
}

}  // namespace

int main(int argc, char** argv) {
  const bool given = argc > 2;
  const Trajectory estimate = given ? dataset::read_trajectory(argv[1]) : circle(1.01);
  const Trajectory truth = given ? dataset::read_trajectory(argv[2]) : circle(1.0);
  const results::TrajectoryMetrics metrics = evaluation::evaluate_trajectory(estimate, truth);
  const results::Summary one_meter =
      metrics.rpe ? metrics.rpe->lengths[0].translation : results::SummaryInMeters();
  std::printf("relative error over 1 m: %.2f cm RMSE of %zu pieces\n", 100.0 * one_meter.rmse,
              one_meter.count);
  if (argc > 4) {
    const dataset::Cloud map = dataset::read_cloud(argv[3]);
    const world::World world(world::load_mesh(argv[4]), argv[4]);
    const evaluation::MapError error =
        evaluation::map_error(map.points, Pose::Identity(), world, Parallel());
    std::printf("map: %zu points, %.2f cm from the mesh on average, %.1f %% beyond 20 cm\n",
                error.points, 100.0 * error.distance_m.mean, error.outliers_percent.value_or(0.0));
  }
  if (given) return 0;
  // 1 % of a piece of 1 m
  return std::abs(one_meter.rmse - 0.01) < 2e-4 ? 0 : 1;
}
