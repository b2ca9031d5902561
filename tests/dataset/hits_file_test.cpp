// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/hits_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "lidarena/base/error.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

ScanTruth truth_of(const std::string& sensor, int index, int returns) {
  ScanTruth truth{sensor, Time{index * 100'000'000LL}, {}};
  for (int i = 0; i < returns; ++i) {
    PointTruth hit;
    hit.position = {static_cast<float>(index), static_cast<float>(i), 0.5F};
    hit.normal = Eigen::Vector3f::UnitZ();
    truth.points.push_back(hit);
  }
  return truth;
}

constexpr std::size_t kTriangles = 100;

Rig two_lidars() {
  Rig rig;
  for (const char* id : {"front", "rear"}) rig.lidars.emplace_back().id = id;
  return rig;
}

void write_hits(const std::filesystem::path& folder) {
  HitsWriter writer(folder, two_lidars(), kTriangles);
  for (int scan = 0; scan < 3; ++scan) writer.write(truth_of("front", scan, scan * 10));
  writer.write(truth_of("rear", 7, 1));
  writer.commit();
}

TEST(HitsFile, KeepsTheClassesOfAScanAndTakesFourBytesPerReturnForThemOnlyThere) {
  const TemporaryFolder folder, plain;
  HitsWriter writer(folder.path(), two_lidars(), kTriangles),
      without(plain.path(), two_lidars(), kTriangles);
  for (int scan = 0; scan < 3; ++scan) {
    ScanTruth truth = truth_of("front", scan, 5);
    without.write(truth);
    if (scan == 1) truth.points[2].triangle = kAir;
    if (scan == 1) truth.points[4].triangle = kGhost;
    if (scan == 2) truth.points[0].triangle = kTriangles + 3;  // a mover
    writer.write(truth);
  }
  writer.commit();
  without.commit();
  const auto read = open_hits(folder.path(), "front");
  for (int scan = 0; scan < 3; ++scan) {
    const std::optional<ScanTruth> truth = read->next();
    ASSERT_TRUE(truth.has_value());
    ASSERT_EQ(truth->points.size(), 5U);
    for (std::size_t i = 0; i < 5; ++i) {
      const bool of_world = is_of_world(truth->points[i].triangle, kTriangles);
      EXPECT_EQ(of_world, scan == 1 ? i != 2 && i != 4 : scan == 0 || i != 0);
    }
    EXPECT_EQ(truth->points[2].triangle, scan == 1 ? kAir : 0U);
    EXPECT_EQ(truth->points[4].triangle, scan == 1 ? kGhost : 0U);
    EXPECT_EQ(truth->points[0].triangle, scan == 2 ? kTriangles + 3 : 0U);
  }
  EXPECT_FALSE(read->next().has_value());
  const auto size = [](const TemporaryFolder& in) {
    return std::filesystem::file_size(in.path() / ("front" + std::string(kHitsEnding)));
  };
  EXPECT_EQ(size(folder), size(plain) + 2 * 5 * 4);
}

TEST(HitsFile, ReadsBackWhatWasWrittenForEachLidar) {
  const TemporaryFolder folder;
  write_hits(folder.path());
  const auto front = open_hits(folder.path(), "front");
  ASSERT_NE(front, nullptr);
  for (int scan = 0; scan < 3; ++scan) {
    const ScanTruth expected = truth_of("front", scan, scan * 10);
    const std::optional<ScanTruth> read = front->next();
    ASSERT_TRUE(read.has_value());
    EXPECT_EQ(read->sensor_id, "front");
    EXPECT_EQ(read->stamp, expected.stamp);
    ASSERT_EQ(read->points.size(), expected.points.size());
    for (std::size_t i = 0; i < read->points.size(); ++i) {
      EXPECT_EQ(read->points[i].position, expected.points[i].position);
      EXPECT_EQ(read->points[i].normal, expected.points[i].normal);
    }
  }
  EXPECT_FALSE(front->next().has_value());
  EXPECT_EQ(open_hits(folder.path(), "rear")->next()->stamp, Time{700'000'000});
  EXPECT_EQ(open_hits(folder.path(), "other"), nullptr);
}

TEST(HitsFile, AFileThatIsCutOffIsAnErrorThatNamesIt) {
  const TemporaryFolder folder;
  write_hits(folder.path());
  const std::filesystem::path file = folder.path() / "front_hits.bin";
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 10);
  const auto source = open_hits(folder.path(), "front");
  const auto read_all = [&] {
    while (source->next()) {
    }
  };
  EXPECT_THAT(read_all, testing::ThrowsMessage<InputError>(testing::AllOf(
                            testing::HasSubstr("front_hits.bin"), testing::HasSubstr("cut off"))));
}

TEST(HitsFile, AnotherFileIsRefused) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "front_hits.bin") << "something else, longer than the header";
  EXPECT_THROW(open_hits(folder.path(), "front"), InputError);
}

TEST(HitsFile, WithoutCommitThereIsNone) {
  const TemporaryFolder folder;
  { HitsWriter(folder.path(), two_lidars(), kTriangles).write(truth_of("front", 0, 5)); }
  EXPECT_EQ(open_hits(folder.path(), "front"), nullptr);
}

}  // namespace
}  // namespace lidarena::dataset
