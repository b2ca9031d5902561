// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <tuple>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/points/sweeps.hpp"
#include "lidarena/dataset/trajectories/kitti.hpp"
#include "lidarena/dataset/trajectories/trajectory_io.hpp"
#include "tests/dataset/event_matching.hpp"
#include "tests/dataset/file_helpers.hpp"
#include "tests/dataset/sample_events.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kScans = 4;
constexpr int kPoints = 60;

ScanTruth truth_of(const Scan& scan, const std::string& id) {
  ScanTruth truth{id, scan.stamp, {}};
  for (const Point& point : scan.points) {
    truth.points.push_back({point.position + Eigen::Vector3f(0.1F, 0.2F, 0.3F), 0.3F,
                            Eigen::Vector3f::UnitY(), static_cast<std::uint32_t>(point.dt_ns)});
  }
  return truth;
}

/// Two LiDARs of one rate, one IMU.
Rig rig() {
  Rig rig = sample::rig();
  rig.lidars.push_back(rig.lidars[0]);
  rig.lidars[1].id = "second";
  return rig;
}

std::vector<Event> events() {
  std::vector<Event> events;
  for (const Event& event : sample::events(kScans, kPoints)) {
    events.push_back(event);
    if (const auto* scan = std::get_if<Scan>(&event.data)) {
      Scan other = *scan;
      other.points.resize(kPoints / 2);
      other.points.back().dt_ns = scan->points.back().dt_ns;  // ends like the first
      events.push_back({"second", other});
    }
  }
  return events;
}

fs::path write_dataset(const fs::path& path, const WriteOptions& options) {
  DatasetWriter out(path, rig(), options);
  int next_truth = 0;
  for (const Event& event : events()) {
    if (const auto* scan = std::get_if<Scan>(&event.data)) {
      out.write(truth_of(*scan, event.sensor_id));
    } else {
      out.write_truth(sample::truth(next_truth++));
    }
    out.write(event);
  }
  out.finish({{"seed", 42}});
  return path;
}

/// An output: a folder of some format, or a single file.
struct Place {
  const char* name;
  DatasetFormat format;
};
constexpr Place kPlaces[] = {{"mcap", DatasetFormat::kMcap},   {"bag", DatasetFormat::kBag},
                             {"pcd", DatasetFormat::kPcd},     {"ply", DatasetFormat::kPly},
                             {"kitti", DatasetFormat::kKitti}, {"file.mcap", DatasetFormat::kMcap},
                             {"file.bag", DatasetFormat::kBag}};

bool is_kitti(const Place& place) { return place.format == DatasetFormat::kKitti; }
bool is_file(const Place& place) { return std::string(place.name).starts_with("file"); }

/// The part of a scan that KITTI keeps.
Scan as_kitti(Scan scan) {
  scan.timed = false;
  for (Point& point : scan.points) point = {point.position, point.intensity, 0, 0, 0};
  return scan;
}

std::vector<Event> stream_of(const std::vector<Event>& events, const std::string& id,
                             std::size_t kind) {
  std::vector<Event> stream;
  for (const Event& event : events) {
    if (event.sensor_id == id && event.data.index() == kind) stream.push_back(event);
  }
  return stream;
}

class CopyDataset : public testing::TestWithParam<std::tuple<Place, Place>> {
 protected:
  Place from_ = std::get<0>(GetParam());
  Place to_ = std::get<1>(GetParam());
  TemporaryFolder folder_;
};

TEST_P(CopyDataset, KeepsEverythingThatTheFormatsCanHold) {
  fs::create_directories(folder_.path() / "in");
  const fs::path in = write_dataset(folder_.path() / "in" / from_.name, {.format = from_.format});
  const fs::path out = folder_.path() / to_.name;
  Dataset source = open_dataset(in);
  const CopySummary summary = copy_dataset(source, out, {.format = to_.format});
  EXPECT_EQ(summary.scans, 2U * kScans);
  EXPECT_EQ(summary.truth_scans, 2U * kScans);
  EXPECT_EQ(summary.points, static_cast<std::size_t>(kScans * (kPoints + kPoints / 2)));

  Dataset copy = open_dataset(out);
  EXPECT_THAT(copy.notes, testing::IsEmpty());
  EXPECT_EQ(to_json(copy.rig), to_json(rig()));
  if (!is_file(from_) && !is_file(to_)) {
    EXPECT_EQ(copy.manifest.at("seed"), 42);
  }
  const std::vector<Event> found = drain(*copy.events);
  std::vector<Event> expected = events();
  if (is_kitti(from_) || is_kitti(to_)) {
    for (Event& event : expected) {
      if (auto* scan = std::get_if<Scan>(&event.data)) *scan = as_kitti(std::move(*scan));
    }
    // a scan without point times has an unknown end and may come earlier among the IMU samples
    for (const char* id : {"mid360", "second"}) {
      for (const std::size_t kind : {0U, 1U}) {
        expect_same(stream_of(found, id, kind), stream_of(expected, id, kind));
      }
    }
  } else {
    expect_same(found, expected);
  }

  const auto path = load_truth(out);
  ASSERT_TRUE(path.has_value());
  EXPECT_EQ(path->size(), summary.poses);
  EXPECT_TRUE(path->poses()[7].world_from_body.isApprox(sample::truth(7).world_from_body, 1e-8));
  const auto hits = open_scan_truth(out, "second");
  ASSERT_NE(hits, nullptr);
  const std::vector<Event> scans = stream_of(events(), "second", 1);
  for (int i = 0; i < kScans; ++i) {
    const auto truth = hits->next();
    ASSERT_TRUE(truth.has_value());
    const Scan& scan = std::get<Scan>(scans[static_cast<std::size_t>(i)].data);
    const ScanTruth wanted = truth_of(scan, "second");
    EXPECT_EQ(truth->stamp, wanted.stamp);
    ASSERT_EQ(truth->points.size(), wanted.points.size());
    EXPECT_EQ(std::memcmp(truth->points.data(), wanted.points.data(),
                          wanted.points.size() * sizeof(PointTruth)),
              0);
  }
  EXPECT_FALSE(hits->next().has_value());
}

INSTANTIATE_TEST_SUITE_P(AllPairs, CopyDataset,
                         testing::Combine(testing::ValuesIn(kPlaces), testing::ValuesIn(kPlaces)),
                         [](const auto& param) {
                           std::string name = std::string(std::get<0>(param.param).name) + "_to_" +
                                              std::get<1>(param.param).name;
                           std::ranges::replace(name, '.', '_');
                           return name;
                         });

class SweepDatasets : public testing::Test {
 protected:
  TemporaryFolder folder_;
  fs::path path_ = folder_.path() / "flight";
};

TEST_F(SweepDatasets, AreFoldersOfSweepsForOthersToo) {
  write_dataset(path_, {.format = DatasetFormat::kPly});
  const Dataset sweeps = open_sweep_folder(path_ / "mid360");
  const std::vector<Event> found = drain(*sweeps.events);
  ASSERT_EQ(found.size(), static_cast<std::size_t>(kScans));
  expect_same(std::get<Scan>(found[2].data), sample::scan(2, kPoints));
}

TEST_F(SweepDatasets, WithoutManifestAreUnfinished) {
  {
    DatasetWriter out(path_, rig(), {.format = DatasetFormat::kPcd});
    for (const Event& event : events()) out.write(event);
  }
  EXPECT_THAT(input_error([&] { open_dataset(path_); }), HasSubstr("unfinished"));
  EXPECT_FALSE(has_measurements(path_));
}

TEST_F(SweepDatasets, ThatLackSomethingSaySo) {
  write_dataset(path_, {.format = DatasetFormat::kPcd});
  EXPECT_TRUE(has_measurements(path_));
  fs::remove(path_ / "mid360" / "000002.pcd");
  EXPECT_THAT(input_error([&] { drain(*open_dataset(path_).events); }), HasSubstr("000002.pcd"));
  write_file(path_ / "second" / "times.txt", "1.0\n2.0\n");
  EXPECT_THAT(input_error([&] { open_dataset(path_); }), HasSubstr("holds 2 times"));
}

TEST_F(SweepDatasets, WrittenAnewForgetTheSweepsOfBefore) {
  write_dataset(path_, {.format = DatasetFormat::kPcd});
  DatasetWriter out(path_, rig(), {.format = DatasetFormat::kPcd});
  for (const Event& event : events()) {
    if (std::get_if<Scan>(&event.data) == nullptr) continue;
    out.write(event);
    break;
  }
  out.close();
  EXPECT_EQ(drain(*open_dataset(path_).events).size(), 1U);
  EXPECT_FALSE(fs::exists(path_ / "mid360" / "000001.pcd"));
}

TEST_F(SweepDatasets, TakeNoSensorThatCannotBeAFolder) {
  Rig odd = rig();
  odd.lidars[0].id = "../mid360";
  EXPECT_THAT(input_error([&] { DatasetWriter(path_, odd, {.format = DatasetFormat::kPcd}); }),
              HasSubstr("cannot be the name of a folder"));
}

TEST_F(SweepDatasets, OneLidarOfSeveralCanBeAskedFor) {
  write_dataset(path_, {.format = DatasetFormat::kPcd});
  ReadOptions options;
  options.sensor = "second";
  const Dataset dataset = open_dataset(path_, options);
  EXPECT_EQ(dataset.rig.lidars.size(), 1U);
  EXPECT_EQ(dataset.scan_count, static_cast<std::size_t>(kScans));
  options.sensor = "third";
  EXPECT_THROW(open_dataset(path_, options), InputError);
}

TEST(CopyingADataset, OntoItselfIsRefused) {
  const TemporaryFolder folder;
  const fs::path path = write_dataset(folder.path() / "flight", {});
  Dataset whole = open_dataset(path);
  EXPECT_THAT(input_error([&] { copy_dataset(whole, path); }), HasSubstr("is to be converted"));
  Dataset file = open_dataset(path / "data.mcap");
  EXPECT_THAT(input_error([&] { copy_dataset(file, path, {.format = DatasetFormat::kBag}); }),
              HasSubstr("is to be converted"));
  EXPECT_NO_THROW(open_dataset(path));
}

TEST(CopyingADataset, ThatIsCutLeavesNothingThatLooksWhole) {
  const TemporaryFolder folder;
  const fs::path path = write_dataset(folder.path() / "flight", {});
  fs::resize_file(path / "data.mcap", fs::file_size(path / "data.mcap") * 2 / 3);
  Dataset cut = open_dataset(path);
  const fs::path out = folder.path() / "copy";
  EXPECT_THAT(input_error([&] { copy_dataset(cut, out, {.format = DatasetFormat::kPcd}); }),
              HasSubstr("cut off"));
  EXPECT_FALSE(fs::exists(out / "manifest.json"));
}

TEST(KittiPoses, ComeBackToNineDigits) {
  const TemporaryFolder folder;
  std::vector<StampedPose> poses;
  std::vector<Time> times;
  for (int i = 0; i < 20; ++i) {
    poses.push_back(sample::truth(10 * i));
    times.push_back(poses.back().stamp);
  }
  write_kitti_poses(folder.path() / "poses.txt", Trajectory(poses));
  write_times(folder.path() / "times.txt", times);
  const Trajectory back = read_trajectory(folder.path() / "poses.txt");
  ASSERT_EQ(back.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(back.poses()[i].stamp, poses[i].stamp);
    EXPECT_TRUE(back.poses()[i].world_from_body.isApprox(poses[i].world_from_body, 1e-8));
  }
}

}  // namespace
}  // namespace lidarena::dataset
