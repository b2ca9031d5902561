// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/grid_axes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/base/random.hpp"
#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::map {
namespace {

/// A wall of 8 m x 8 m, 1 cm away from a border of cells of 0.2 m, with 2 cm of noise across it.
std::vector<Eigen::Vector3f> noisy_wall(std::size_t count, std::uint64_t seed) {
  SequentialRandom random(seed);
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double across = 0.21 + 0.02 * random.normal();
    const double y = random.uniform(-4.0, 4.0), z = random.uniform(-4.0, 4.0);
    points.emplace_back(Eigen::Vector3d(across, y, z).cast<float>());
  }
  return points;
}

/// Position of the wall (m) as the mean of the cells' means, each of the same weight.
double seen_at(std::size_t count, GridAxes axes) {
  const std::vector<Eigen::Vector3f> means = voxel_means(noisy_wall(count, 1), 0.2, axes);
  double sum = 0.0;
  for (const Eigen::Vector3f& mean : means) sum += double{mean.x()};
  return sum / static_cast<double>(means.size());
}

TEST(GridAxes, AScanIsSeenWhereAMapOfManyIsOnlyIfTheGridIsRotated) {
  constexpr std::size_t kScan = 3000, kMap = 100'000;  // about 2 and 60 points per cell
  EXPECT_GT(std::abs(seen_at(kScan, GridAxes::kParallel) - seen_at(kMap, GridAxes::kParallel)),
            3e-3);
  // standard error: 2 cm / sqrt(3000) = 0.4 mm
  EXPECT_NEAR(seen_at(kScan, GridAxes::kRotated), seen_at(kMap, GridAxes::kRotated), 1.2e-3);
  EXPECT_NEAR(seen_at(kMap, GridAxes::kRotated), 0.21, 1e-3);
}

TEST(GridAxes, AreARotationFarFromTheFramesAxes) {
  EXPECT_EQ(grid_from_points(GridAxes::kParallel), Eigen::Matrix3d::Identity());
  const Eigen::Matrix3d turn = grid_from_points(GridAxes::kRotated);
  EXPECT_TRUE(turn.isUnitary(1e-12));
  EXPECT_GT(turn.determinant(), 0.0);
  EXPECT_LT(turn.cwiseAbs().maxCoeff(), std::cos(0.4))
      << "0.4 rad (23 degrees) between any two axes";
}

}  // namespace
}  // namespace lidarena::map
