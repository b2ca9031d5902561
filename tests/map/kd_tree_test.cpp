// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/kd_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "lidarena/base/random.hpp"
#include "tests/map/sorted.hpp"

namespace lidarena::map {
namespace {

/// Summed in the tree's order; Eigen's differs from processor to processor, in the last bit.
float squared_distance(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  const Eigen::Vector3f d = a - b;
  return d.x() * d.x() + (d.y() * d.y() + d.z() * d.z());
}

/// Reference: the same operations on a list, implemented in the simplest way.
class SlowPoints {
 public:
  void insert(const Eigen::Vector3f& point) { points_.push_back(point); }

  bool insert_downsampled(const Eigen::Vector3f& point, float voxel) {
    const auto cell = [voxel](const Eigen::Vector3f& p) -> Eigen::Vector3f {
      return (p / voxel).array().floor();
    };
    const Eigen::Vector3f center = (cell(point).array() + 0.5F) * voxel;
    const auto to_center = [&](const Eigen::Vector3f& p) { return (p - center).squaredNorm(); };
    Eigen::Vector3f best = point;
    bool is_new = true;
    for (const Eigen::Vector3f& other : points_) {
      if (cell(other) != cell(point) || to_center(other) > to_center(best)) continue;
      best = other;
      is_new = false;
    }
    std::erase_if(points_, [&](const auto& other) { return cell(other) == cell(point); });
    points_.push_back(best);
    return is_new;
  }

  std::size_t remove(const Eigen::AlignedBox3f& box) {
    return std::erase_if(points_, [&](const auto& point) { return box.contains(point); });
  }

  std::vector<float> nearest_squared(const Eigen::Vector3f& query, std::size_t count) const {
    std::vector<float> distances;
    for (const Eigen::Vector3f& point : points_) distances.push_back(squared_distance(point, query));
    std::sort(distances.begin(), distances.end());
    distances.resize(std::min(count, distances.size()));
    return distances;
  }

  std::size_t size() const { return points_.size(); }
  const std::vector<Eigen::Vector3f>& points() const { return points_; }

 private:
  std::vector<Eigen::Vector3f> points_;
};

Eigen::Vector3f random_point(SequentialRandom& random, float half_side) {
  const auto coordinate = [&] {
    return half_side * static_cast<float>(2.0 * random.uniform() - 1.0);
  };
  const float x = coordinate();
  const float y = coordinate();
  return {x, y, coordinate()};
}

std::vector<float> squared(const KdTree& tree, const Eigen::Vector3f& query, std::size_t count) {
  std::array<Neighbor, 8> found;
  const std::size_t n = tree.nearest(query, std::span(found).first(count));
  std::vector<float> distances;
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_EQ(found[i].squared_distance, squared_distance(found[i].point, query));
    distances.push_back(found[i].squared_distance);
  }
  return distances;
}

/// Maximum depth of a tree in which no child has more than 0.7 of its parent's points, down to
/// subtrees of 64 points, which are not balanced: at worst a chain that loses half a leaf of 16 per
/// level.
std::size_t allowed_depth(std::size_t points) {
  return static_cast<std::size_t>(std::log(static_cast<double>(points) / 64.0) /
                                  std::log(1 / 0.7)) +
         1 + 64 / 8;
}

void expect_same(const KdTree& tree, const SlowPoints& slow) {
  ASSERT_EQ(tree.size(), slow.size());
  EXPECT_EQ(sorted(tree.points()), sorted(slow.points()));
}

/// Number of operations; LIDARENA_KD_TREE_OPERATIONS sets it for long tests (2,000,000 take
/// minutes).
int random_operations() {
  const char* given = std::getenv("LIDARENA_KD_TREE_OPERATIONS");
  return given == nullptr ? 120'000 : std::max(2, std::atoi(given));
}

TEST(KdTree, DoesAsAListDoesUnderRandomOperations) {
  const int operations = random_operations() / 2;
  for (const float half_side : {0.8F, 4.0F}) {  // many points in a cell, few in a cell
    SequentialRandom random(7, 1);
    KdTree tree;
    SlowPoints slow;
    for (int i = 0; i < operations; ++i) {
      const double choice = random.uniform();
      const Eigen::Vector3f point = random_point(random, half_side);
      if (choice < 0.25) {
        tree.insert(point);
        slow.insert(point);
      } else if (choice < 0.6) {
        ASSERT_EQ(tree.insert_downsampled(point, 0.5F), slow.insert_downsampled(point, 0.5F)) << i;
      } else if (choice < 0.62 || slow.size() > 600) {
        const Eigen::Vector3f half = half_side * random_point(random, 0.6F).cwiseAbs();
        const Eigen::AlignedBox3f box(point - half, point + half);
        ASSERT_EQ(tree.remove(box), slow.remove(box)) << i;
      } else {
        ASSERT_EQ(squared(tree, point, 5), slow.nearest_squared(point, 5)) << i;
      }
      ASSERT_EQ(tree.size(), slow.size()) << i;
      if (i % 5000 == 0) expect_same(tree, slow);
    }
    expect_same(tree, slow);
  }
}

TEST(KdTree, StaysBalancedWhateverTheOrderOfInsertion) {
  constexpr int kCount = 20'000;
  KdTree along_a_line;
  KdTree random_order;
  SequentialRandom random(3, 1);
  for (int i = 0; i < kCount; ++i) {
    along_a_line.insert({0.01F * static_cast<float>(i), 0.0F, 0.0F});
    random_order.insert(random_point(random, 10.0F));
  }
  EXPECT_EQ(along_a_line.size(), static_cast<std::size_t>(kCount));
  EXPECT_LE(along_a_line.depth(), allowed_depth(kCount));
  EXPECT_LE(random_order.depth(), allowed_depth(kCount));
}

TEST(KdTree, EqualPointsAreKeptApart) {
  KdTree tree;
  for (int i = 0; i < 1000; ++i) tree.insert({1.0F, 2.0F, 3.0F});
  EXPECT_EQ(tree.size(), 1000U);
  EXPECT_LE(tree.depth(), allowed_depth(1000));
  EXPECT_EQ(squared(tree, {1.0F, 2.0F, 3.0F}, 5), std::vector<float>(5, 0.0F));
  EXPECT_EQ(tree.remove(Eigen::AlignedBox3f(Eigen::Vector3f(1.0F, 2.0F, 3.0F))), 1000U);
  EXPECT_TRUE(tree.empty());
}

TEST(KdTree, ABuiltTreeAnswersAsAGrownOne) {
  SequentialRandom random(11, 1);
  std::vector<Eigen::Vector3f> points;
  KdTree grown;
  for (int i = 0; i < 3000; ++i) {
    points.push_back(random_point(random, 5.0F));
    grown.insert(points.back());
  }
  KdTree built;
  built.build(points);
  EXPECT_EQ(sorted(built.points()), sorted(grown.points()));
  EXPECT_EQ(built.depth(), 9U) << "3000 < 16 * 2^8: eight splits and a leaf";
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3f query = random_point(random, 6.0F);
    EXPECT_EQ(squared(built, query, 5), squared(grown, query, 5));
  }
}

TEST(KdTree, SearchEndsAtTheLargestDistance) {
  KdTree tree;
  for (int i = 0; i < 10; ++i) tree.insert({static_cast<float>(i), 0.0F, 0.0F});
  std::array<Neighbor, 5> found;
  EXPECT_EQ(tree.nearest({0.0F, 0.0F, 0.0F}, found, 2.5F), 3U);
  EXPECT_EQ(tree.nearest({-9.0F, 0.0F, 0.0F}, found, 2.5F), 0U);
  EXPECT_EQ(KdTree().nearest({0.0F, 0.0F, 0.0F}, found), 0U);
}

TEST(KdTree, RemovedPointsGiveTheirMemoryBack) {
  SequentialRandom random(5, 1);
  KdTree tree;
  for (int i = 0; i < 5000; ++i) tree.insert(random_point(random, 5.0F));
  const std::uint64_t once = tree.memory_bytes();
  for (int round = 0; round < 20; ++round) {  // a map that moves with the sensor
    const Eigen::Vector3f far = Eigen::Vector3f::Constant(100.0F);
    tree.remove(Eigen::AlignedBox3f(-far, far));
    for (int i = 0; i < 5000; ++i) tree.insert(random_point(random, 5.0F));
  }
  EXPECT_EQ(tree.size(), 5000U);
  EXPECT_LT(tree.memory_bytes(), 2 * once);
}

}  // namespace
}  // namespace lidarena::map
