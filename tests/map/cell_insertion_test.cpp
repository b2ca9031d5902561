// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/cell_insertion.hpp"

#include <gtest/gtest.h>

#include <array>
#include <span>
#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/map/kd_tree.hpp"

namespace lidarena::map {
namespace {

/// Adds `points` to `map` as the shortcuts say.
void add_with_shortcuts(std::span<const Eigen::Vector3f> points, float voxel, KdTree& map) {
  std::vector<CellInsertion> how;  // by the map before the scan
  for (const Eigen::Vector3f& point : points) {
    std::array<Neighbor, 5> neighbors;
    const std::size_t found = map.nearest(point, neighbors, 2.0F);
    how.push_back(cell_insertion(point, std::span(neighbors).first(found), voxel));
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (how[i] == CellInsertion::kPlain) map.insert(points[i]);
    if (how[i] == CellInsertion::kThinned) map.insert_downsampled(points[i], voxel);
  }
}

TEST(CellInsertion, ShortcutsHardlyChangeWhatACellKeeps) {
  SequentialRandom random(8, 1);
  KdTree with_shortcuts;
  KdTree without;
  for (int scan = 0; scan < 30; ++scan) {
    std::vector<Eigen::Vector3f> points(100);
    for (Eigen::Vector3f& point : points)
      for (float& x : point) x = 0.7F * static_cast<float>(random.normal());
    add_with_shortcuts(points, 0.5F, with_shortcuts);
    for (const Eigen::Vector3f& point : points) without.insert_downsampled(point, 0.5F);
  }
  // The neighbors are those of the map before the scan and also from other cells, so a few better
  // points are rejected and a few extra ones inserted.
  EXPECT_NEAR(static_cast<double>(with_shortcuts.size()), static_cast<double>(without.size()),
              0.2 * static_cast<double>(without.size()));
}

TEST(CellInsertion, DependsOnTheNeighborsPlaceInTheCell) {
  const Eigen::Vector3f point(0.1F, 0.1F, 0.1F);  // cell 0 to 0.5 m, center 0.25 m
  const auto by = [&](const Eigen::Vector3f& neighbor) {
    const std::array<Neighbor, 1> neighbors{{{neighbor, 0.0F}}};
    return cell_insertion(point, neighbors, 0.5F);
  };
  EXPECT_EQ(cell_insertion(point, {}, 0.5F), CellInsertion::kThinned);
  EXPECT_EQ(by({0.2F, 0.2F, 0.2F}), CellInsertion::kNone) << "nearer to the center";
  EXPECT_EQ(by({0.0F, 0.1F, 0.1F}), CellInsertion::kThinned);
  EXPECT_EQ(by({-0.1F, -0.1F, -0.1F}), CellInsertion::kPlain) << "outside on every axis";
  EXPECT_EQ(by({-0.1F, 0.1F, 0.1F}), CellInsertion::kThinned) << "outside on one axis only";
}

}  // namespace
}  // namespace lidarena::map
