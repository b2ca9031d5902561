// SPDX-License-Identifier: BSD-3-Clause
// Labels of SemanticKITTI of a simulated room whose surfaces are told apart by their places alone.
#include "lidarena/stages/semantic_labels.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>
#include <optional>

#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/points/sweep_dataset.hpp"
#include "lidarena/scenes/mesh_builder.hpp"
#include "lidarena/stages/simulate_dataset.hpp"
#include "lidarena/world/ply.hpp"
#include "tests/study/configs.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::stages {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using study::kConfigs;

TEST(SemanticLabels, HaveTheNumbersOfSemanticKitti) {
  for (const auto& [object, label] : std::map<std::string, int>{{"", 0},
                                                                {"floor", 49},
                                                                {"wall", 50},
                                                                {"stairs", 52},
                                                                {"leaves", 70},
                                                                {"trunk", 71},
                                                                {"terrain", 72},
                                                                {"rock", 72},
                                                                {"armchair", 99},
                                                                {"pallets", 99}}) {
    EXPECT_EQ(semantic_class(object), label) << object;
  }
  world::MoverConfig mover;
  mover.path = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_EQ(semantic_class(mover), 254);
  mover.kind = world::MoverKind::kBox;
  EXPECT_EQ(semantic_class(mover), 259);
  mover.kind = world::MoverKind::kDoor;
  EXPECT_EQ(semantic_class(mover), 99);
  mover.kind = world::MoverKind::kPerson;
  mover.path.pop_back();
  EXPECT_EQ(semantic_class(mover), 30) << "it stands still";
}

/// 8 x 6 x 3 m, the floor on z = 0; the ceiling has no name.
world::TriangleMesh room() {
  using world::materials::kPlaster;
  world::TriangleMesh mesh =
      scenes::shape::painted(scenes::shape::box({-4, -3, -0.1}, {4, 3, 0}), kPlaster.of("floor"));
  mesh.append(scenes::shape::painted(scenes::shape::box({-4, -3, 3}, {4, 3, 3.1}), kPlaster));
  for (const double x : {-4.1, 4.0})
    mesh.append(scenes::shape::painted(scenes::shape::box({x, -3.1, 0}, {x + 0.1, 3.1, 3}),
                                       kPlaster.of("wall")));
  for (const double y : {-3.1, 3.0})
    mesh.append(scenes::shape::painted(scenes::shape::box({-4, y, 0}, {4, y + 0.1, 3}),
                                       kPlaster.of("wall")));
  return mesh;
}

/// The label that the place of a hit asks for; empty on an edge, where two surfaces meet. The cart
/// is at x > 1, the person at x < -1.
std::optional<std::uint32_t> label_at(const Vector3d& hit) {
  constexpr double kRounding = 1e-4;  // m, of hits in single precision
  const bool on_floor = std::abs(hit.z()) < kRounding;
  const bool on_ceiling = std::abs(hit.z() - 3.0) < kRounding;
  const bool on_wall = std::abs(hit.x()) > 4.0 - kRounding || std::abs(hit.y()) > 3.0 - kRounding;
  if (on_floor + on_ceiling + on_wall > 1) return std::nullopt;
  if (on_floor) return 49;
  if (on_ceiling) return 0;
  if (on_wall) return 50;
  return hit.x() > 0 ? 1U << 16U | 259U : 2U << 16U | 30U;
}

std::vector<std::uint32_t> read_labels(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  std::vector<std::uint32_t> labels(bytes.size() / 4);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    labels[i / 4] |= std::uint32_t{static_cast<unsigned char>(bytes[i])} << 8 * (i % 4);
  return labels;
}

class LabelsOfARoom : public testing::Test {
 protected:
  LabelsOfARoom() {
    world::save_ply(folder_.path() / "room.ply", room());
    request_.world = folder_.write(
        "room.yaml",
        "kind: mesh\nfile: room.ply\nmovers:\n"
        "  - {name: cart, kind: box, path: [[2, -1, 0], [2, 1, 0]], size: [1, 0.6, 1.2]}\n"
        "  - {name: guard, kind: person, path: [[-2, 1, 0]]}\n");
    request_.flight = folder_.write("flight.tum",
                                    "0 0 0 0.2 0 0 0 1\n0.5 0.1 0 0.2 0 0 0 1\n"
                                    "1 0.2 0 0.2 0 0 0 1\n1.5 0.3 0 0.2 0 0 0 1\n");
    request_.sensors = {kConfigs / "sensors/livox_mid360.yaml"};
    request_.seconds = 0.5;
    request_.write.format = dataset::DatasetFormat::kKitti;
  }
  fs::path simulated(const char* name) {
    const fs::path out = folder_.path() / name;
    simulate_dataset(request_, out, Parallel(2), log_);
    return out;
  }

  TemporaryFolder folder_;
  SimulateRequest request_;
  LogSink log_;
};

TEST_F(LabelsOfARoom, AreThoseOfThePlacesThatWereHit) {
  request_.truth = true;
  const fs::path lidar = simulated("with_truth") / "livox_mid360";
  std::map<std::uint32_t, std::size_t> counts, expected;
  std::size_t on_edges = 0;
  for (std::size_t scan = 0; scan < 5; ++scan) {
    const std::string number = "00000" + std::to_string(scan);
    const auto hits = dataset::read_hits(lidar / "hits" / (number + ".pcd"));
    const auto labels = read_labels(lidar / "labels" / (number + ".label"));
    ASSERT_EQ(labels.size(), hits.size());
    ASSERT_EQ(16 * labels.size(), fs::file_size(lidar / "velodyne" / (number + ".bin")));
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const auto label = label_at(hits[i].position.cast<double>());
      if (!label) {
        ++on_edges;
        continue;
      }
      ++counts[labels[i]];
      ++expected[*label];
    }
  }
  EXPECT_EQ(counts, expected);
  EXPECT_LT(on_edges, 100U);
  EXPECT_EQ(counts.size(), 5U);
  for (const auto& [label, count] : counts) EXPECT_GT(count, 100U) << label;
}

TEST_F(LabelsOfARoom, AreTheSameWhereADatasetIsSimulatedAgainToConvertIt) {
  request_.truth = true;
  const fs::path with_truth = simulated("with_truth") / "livox_mid360/labels";
  request_.truth = false;
  EXPECT_FALSE(fs::exists(simulated("without_truth") / "livox_mid360/labels"));
  request_.data = false;
  const fs::path bare = simulated("bare"), out = folder_.path() / "converted";
  dataset::WriteOptions write{.format = dataset::DatasetFormat::kKitti};
  write.labels = labels_of_dataset(bare);
  dataset::Dataset in = open_any_dataset(bare, {}, Parallel(2));
  const auto open_truth = [&](const std::string& lidar) {
    return open_simulated_truth(bare, lidar, Parallel(2));
  };
  EXPECT_EQ(dataset::copy_dataset(in, out, write, open_truth).truth_scans, 5U);
  for (std::size_t scan = 0; scan < 5; ++scan) {
    const std::string name = "00000" + std::to_string(scan) + ".label";
    const auto again = read_labels(out / "livox_mid360/labels" / name);
    EXPECT_GT(again.size(), 1000U);
    EXPECT_EQ(again, read_labels(with_truth / name));
  }
}

TEST(WriteLabels, AirAndGhostsAreOutliersAndWhatIsNotKnownIsUnlabeled) {
  const TemporaryFolder folder;
  std::vector<PointTruth> points(5);
  const std::uint32_t triangles[] = {1, kAir, kGhost, 2, 3};
  for (std::size_t i = 0; i < points.size(); ++i) points[i].triangle = triangles[i];
  const fs::path file = folder.path() / "000000.label";
  dataset::write_labels(file, points, {50, 49, 7U << 16U | 254U});
  EXPECT_EQ(read_labels(file), (std::vector<std::uint32_t>{49, 1, 1, 7U << 16U | 254U, 0}));
}

}  // namespace
}  // namespace lidarena::stages
