// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/point_truth.hpp"

#include <gmock/gmock.h>

#include <cstring>
#include <fstream>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/mcap/mcap_writer.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "tests/dataset/event_matching.hpp"
#include "tests/dataset/file_helpers.hpp"
#include "tests/dataset/sample_events.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Synthetic ground truth of a scan: every value is a function of the point's index.
ScanTruth truth_of(const Scan& scan, const std::string& id) {
  ScanTruth truth{id, scan.stamp, {}};
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const auto value = static_cast<float>(i);
    truth.points.push_back({scan.points[i].position + Eigen::Vector3f(1, 2, 3), 0.5F * value,
                            Eigen::Vector3f(0, 0, i % 2 == 0 ? 1.0F : -1.0F),
                            static_cast<std::uint32_t>(4'000'000'000U + i)});
  }
  return truth;
}

void expect_same_truth(const ScanTruth& a, const ScanTruth& b) {
  EXPECT_EQ(a.sensor_id, b.sensor_id);
  EXPECT_EQ(a.stamp, b.stamp);
  ASSERT_EQ(a.points.size(), b.points.size());
  EXPECT_EQ(std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(PointTruth)), 0);
}

/// Writes the ground truth of each scan just before the scan, as the simulator does.
void write_with_truth(DatasetWriter& out, const std::vector<Event>& events) {
  for (const Event& event : events) {
    if (const auto* scan = std::get_if<Scan>(&event.data)) {
      out.write(truth_of(*scan, event.sensor_id));
    }
    out.write(event);
  }
}

class PointTruthFiles : public testing::Test {
 protected:
  TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path() / "flight";
  std::vector<Event> events_ = sample::events(4, 200);
};

TEST_F(PointTruthFiles, ComesBackBitByBitScanAfterScan) {
  DatasetWriter out(folder_, sample::rig());
  write_with_truth(out, events_);
  out.close();
  for (const fs::path& path : {folder_, folder_ / "data.mcap"}) {
    const auto source = open_scan_truth(path);
    ASSERT_NE(source, nullptr);
    for (const Event& event : events_) {
      const auto* scan = std::get_if<Scan>(&event.data);
      if (scan == nullptr) continue;
      const auto truth = source->next();
      ASSERT_TRUE(truth.has_value());
      expect_same_truth(*truth, truth_of(*scan, "mid360"));
    }
    EXPECT_FALSE(source->next().has_value());
  }
}

TEST_F(PointTruthFiles, IsNeverAmongTheEventsThatAnEstimatorGets) {
  DatasetWriter out(folder_, sample::rig());
  write_with_truth(out, events_);
  out.close();
  expect_same(drain(*open_dataset(folder_).events), events_);
  expect_same(drain(*open_dataset(folder_ / "data.mcap").events), events_);
  ReadOptions by_topic;
  by_topic.sensor = "/truth/mid360/hits";
  EXPECT_THROW(open_dataset(folder_ / "data.mcap", by_topic), InputError);
}

TEST_F(PointTruthFiles, IsNotTakenForScansInAFileThatDoesNotDescribeItself) {
  const fs::path file = temporary_.path() / "bare.mcap";
  McapWriter out(file);
  const std::uint16_t schema = out.add_schema(std::string(ros::kPointCloud2), "ros2msg",
                                              ros::definition_of(ros::kPointCloud2));
  const std::uint16_t hits = out.add_channel("/truth/mid360/hits", schema, "cdr");
  MessageWriter message;
  ros::encode_scan_truth(truth_of(sample::scan(0, 5), "mid360"), "world", message);
  out.write(hits, Time{0}, Time{0}, message.bytes());
  out.close();
  EXPECT_THAT(input_error([&] { open_dataset(file); }), HasSubstr("holds no scans"));
  ReadOptions by_topic;
  by_topic.sensor = "/truth/mid360/hits";
  EXPECT_THAT(input_error([&] { open_dataset(file, by_topic); }), HasSubstr("holds no scans"));
}

TEST_F(PointTruthFiles, DatasetsWithoutItGiveNone) {
  DatasetWriter out(folder_, sample::rig());
  for (const Event& event : events_) out.write(event);
  out.close();
  EXPECT_EQ(open_scan_truth(folder_), nullptr);
  EXPECT_EQ(open_scan_truth(folder_, "mid360"), nullptr);
  EXPECT_THAT(input_error([&] { open_scan_truth(folder_, "os0"); }), HasSubstr("mid360"));
}

TEST_F(PointTruthFiles, OfALidarOutsideTheRigIsBadInput) {
  DatasetWriter out(folder_, sample::rig());
  EXPECT_THROW(out.write(truth_of(sample::scan(0, 5), "os0")), InputError);
}

TEST_F(PointTruthFiles, ACloudOfMeasurementsIsNotTakenForTruth) {
  MessageWriter message;
  ros::encode_scan(sample::scan(0, 5), "lidar", message);
  EXPECT_THAT(input_error([&] { ros::decode_scan_truth(message.bytes(), "here"); }),
              HasSubstr("is not a cloud of ground-truth points"));
}

/// Resident memory of this process, bytes.
std::size_t resident_bytes() {
  std::ifstream status("/proc/self/statm");
  std::size_t total = 0;
  std::size_t resident = 0;
  status >> total >> resident;
  return resident * 4096;
}

// Ten minutes of ground truth at 1 kHz are 600,000 poses, some 86 MB in memory; the test writes a
// tenth of them, which would take 8 MB if they were kept.
TEST_F(PointTruthFiles, PosesAreWrittenAsTheyComeAndNotKept) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers use memory themselves: resident memory is not measured";
#endif
  DatasetWriter out(folder_, sample::rig());
  auto write_until = [&, next = 0](int end) mutable {
    for (; next < end; ++next) {
      out.write_truth({Time{std::chrono::milliseconds(next)}, sample::truth(next).world_from_body});
    }
  };
  write_until(30'000);  // buffers, chunk and compressor have reached their final sizes
  const std::size_t before = resident_bytes();
  write_until(90'000);
  const std::size_t after = resident_bytes();
  EXPECT_LT(after, before + 2'000'000);
  out.close();
  EXPECT_EQ(load_truth(folder_)->size(), 90'000U);
}

TEST_F(PointTruthFiles, PosesOutOfOrderAreRefused) {
  DatasetWriter out(folder_, sample::rig());
  out.write_truth(sample::truth(2));
  EXPECT_THAT(input_error([&] { out.write_truth(sample::truth(2)); }), HasSubstr("comes after"));
  StampedPose broken = sample::truth(3);
  broken.world_from_body.translation().x() = std::nan("");
  EXPECT_THAT(input_error([&] { out.write_truth(broken); }), HasSubstr("not finite"));
}

}  // namespace
}  // namespace lidarena::dataset
