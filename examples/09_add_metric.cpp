// SPDX-License-Identifier: BSD-3-Clause
// Add a metric: how flat are the floor and walls of a map? A metric is a function of a run's
// results (trajectory, map) and of the truth (trajectory, mesh). usage: example_09_add_metric
#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>

#include "lidarena/world/primitives.hpp"
#include "lidarena/world/world.hpp"

namespace {

using namespace lidarena;

/// RMS distance (m) of points to the best-fit plane of each face. `cloud` is in the mesh's frame;
/// uses points within `reach` meters of a face, and faces that have `min_points` points or more.
double flatness(const std::vector<Eigen::Vector3d>& cloud, const world::World& world,
                double reach = 0.2, std::size_t min_points = 100) {
  std::vector<world::ClosestPoint> nearest(cloud.size());
  world.closest_points(cloud, reach, nearest, Parallel());
  std::map<std::uint32_t, std::vector<Eigen::Vector3d>> faces;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (nearest[i].valid()) faces[nearest[i].triangle].push_back(cloud[i]);
  }
  double squares = 0.0;
  std::size_t count = 0;
  for (const auto& [face, points] : faces) {
    if (points.size() < min_points) continue;
    const Eigen::Map<const Eigen::Matrix3Xd> rows(points[0].data(), 3,
                                                  static_cast<Eigen::Index>(points.size()));
    const Eigen::Matrix3Xd centered = rows.colwise() - rows.rowwise().mean();
    squares += Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(centered * centered.transpose())
                   .eigenvalues()[0];
    count += points.size();
  }
  return std::sqrt(squares / static_cast<double>(count));
}

}  // namespace

int main() {
  // A floor sampled with 1 cm of noise must come out as 1 cm.
  const world::World floor(world::plane_shape(Eigen::Vector3d::UnitZ(), {10.0, 10.0}), "floor");
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> place(-5.0, 5.0);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<Eigen::Vector3d> cloud;
  for (int i = 0; i < 20'000; ++i) {
    cloud.emplace_back(place(generator), place(generator), noise(generator));
  }
  const double value = flatness(cloud, floor);
  std::printf("flatness of a floor with 1 cm of noise: %.3f cm\n", 100.0 * value);
  return std::abs(value - 0.01) < 3 * 0.01 / std::sqrt(2.0 * 20'000) ? 0 : 1;  // 3 sigma of an RMS
}
