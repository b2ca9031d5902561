// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/room.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "lidarena/base/so3.hpp"
#include "tests/dataset/file_helpers.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kMeta =
    R"({"columns": ["x", "y", "z", "t", "ring"], "body_from_lidar": [-0.011, -0.02329, 0.04412,
        0, 0, 0, 1], "time": "absolute seconds", "truth": "imu frame"})";

/// Two scans of two points from 1000 s on, and an IMU at 50 Hz.
class Room : public testing::Test {
 protected:
  Room() {
    put("meta.json", kMeta);
    put("scans.txt", "0 1000.000000000 1000.100000000\n1 1000.100000000 1000.200000000\n");
    put("scans/000000.bin", packed(1.0, 2.0, 3.0, 1000.0, 4.0, 2.0, 2.0, 3.0, 1000.0625, 5.0));
    put("scans/000001.bin", packed(1.0, 2.0, 3.0, 1000.125, 4.0, 2.0, 2.0, 3.0, 1000.1875, 5.0));
    std::string imu;
    for (int i = 0; i < 12; ++i)
      imu += fmt::format("{:.9f} 0.1 0.2 0.3 1 2 9.81\n", 1000 + 0.02 * i);
    put("imu.txt", imu);
    put("gt.tum", "1000.0 1 2 3 0 0 0 1\n1000.2 2 2 3 0 0 0.6 0.8\n");
  }
  std::filesystem::path put(const std::string& name, std::string_view bytes) const {
    return folder_.write(name, bytes);
  }
  const std::filesystem::path& path() const { return folder_.path(); }
  std::string error_with(const std::string& name, std::string_view bytes) const {
    put(name, bytes);
    return input_error([&] {
      const Dataset dataset = open_room(path());
      while (dataset.events->next()) {
      }
    });
  }
  TemporaryFolder folder_;
};

TEST_F(Room, ScansStartWhereTheirIndexSaysAndPointsCountFromThere) {
  EXPECT_TRUE(is_room(path()));
  const Dataset dataset = open_room(path());
  EXPECT_EQ(dataset.scan_count, 2U);
  EXPECT_EQ(dataset.rig.lidars[0].body_from_lidar.translation(),
            Eigen::Vector3d(-0.011, -0.02329, 0.04412));
  EXPECT_DOUBLE_EQ(dataset.rig.lidars[0].rate_hz, 10.0);
  EXPECT_DOUBLE_EQ(dataset.rig.imus[0].rate_hz, 50.0);
  EXPECT_EQ(dataset.rig.imus[0].body_from_imu.matrix(), Eigen::Matrix4d::Identity());
  std::vector<Scan> scans;
  while (auto event = dataset.events->next()) {
    if (auto* scan = std::get_if<Scan>(&event->data)) {
      EXPECT_EQ(event->sensor_id, "lidar");
      scans.push_back(*scan);
    }
  }
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[1].stamp, Time{1'000'100'000'000});
  EXPECT_TRUE(scans[1].timed);
  EXPECT_EQ(scans[1].points[0].dt_ns, 25'000'000);
  EXPECT_EQ(scans[1].points[1].dt_ns, 87'500'000);
  EXPECT_EQ(scans[1].points[1].ring, 5);
  EXPECT_EQ(scans[1].points[1].position, Eigen::Vector3f(2, 2, 3));
}

TEST_F(Room, AScanComesAfterExactlyTheImuSamplesUpToItsLastPoint) {
  const Dataset dataset = open_room(path());
  std::vector<int> imu_before_scan;
  int imu = 0;
  Time last{0};
  while (auto event = dataset.events->next()) {
    if (auto* sample = std::get_if<ImuSample>(&event->data)) {
      EXPECT_EQ(event->sensor_id, "imu");
      EXPECT_GT(sample->stamp, last);
      EXPECT_EQ(sample->gyro, Eigen::Vector3d(0.1, 0.2, 0.3));
      EXPECT_EQ(sample->accel, Eigen::Vector3d(1, 2, 9.81));
      last = sample->stamp;
      ++imu;
    } else {
      imu_before_scan.push_back(imu);
    }
  }
  // ends at 62.5 and 187.5 ms, samples each 20 ms from 0; those after the last scan follow too
  EXPECT_THAT(imu_before_scan, ElementsAre(4, 10));
  EXPECT_EQ(imu, 12);
}

TEST_F(Room, WithoutAnImuThereAreScansAlone) {
  std::filesystem::remove(path() / "imu.txt");
  const Dataset dataset = open_room(path());
  EXPECT_TRUE(dataset.rig.imus.empty());
  int events = 0;
  while (dataset.events->next()) ++events;
  EXPECT_EQ(events, 2);
}

TEST_F(Room, ExtrinsicsGivenByTheUserGoFirst) {
  ReadOptions options;
  options.body_from_lidar = make_pose(Eigen::Matrix3d::Identity(), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(open_room(path(), options).rig.lidars[0].body_from_lidar.translation().x(), 1.0);
}

TEST_F(Room, TheTruthOfTheImuFrameIsTheBodys) {
  const auto truth = room_truth(path());
  ASSERT_TRUE(truth.has_value());
  EXPECT_EQ(truth->poses()[0].world_from_body.translation(), Eigen::Vector3d(1, 2, 3));
  std::filesystem::remove(path() / "gt.tum");
  EXPECT_EQ(room_truth(path()), std::nullopt);
}

TEST_F(Room, TheTruthOfTheLidarFrameIsMovedToTheBody) {
  // the lidar sits 1 m ahead of the body and looks left (+90 degrees about z)
  put("meta.json", R"({"columns": ["x", "y", "z", "t", "ring"], "truth": "lidar frame",
      "body_from_lidar": [1, 0, 0, 0, 0, 0.70710678118654757, 0.70710678118654757]})");
  const auto truth = room_truth(path());
  // a lidar level at (1,2,3) with x ahead: the body looks right, so its center is 1 m to the left
  const Pose body = truth->poses()[0].world_from_body;
  EXPECT_LT((body.translation() - Eigen::Vector3d(1, 3, 3)).norm(), 1e-12);
  EXPECT_LT((body.linear() * Eigen::Vector3d::UnitX() - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12);
}

TEST_F(Room, BrokenFilesAreNamed) {
  EXPECT_THAT(error_with("imu.txt", "1000 1 2 3 4 5\n"), HasSubstr("imu.txt:1: holds 6 columns"));
  EXPECT_THAT(error_with("imu.txt", "2 0 0 0 0 0 0\n1 0 0 0 0 0 0\n"),
              HasSubstr("imu.txt:2: the time is not later"));
  EXPECT_THAT(error_with("imu.txt", "2 0 0 nan 0 0 0\n"), HasSubstr("imu.txt:1: 'nan' is not fin"));
  std::filesystem::remove(path() / "imu.txt");
  EXPECT_THAT(error_with("scans/000001.bin", "cut"),
              HasSubstr("000001.bin: its 3 bytes are no whole number of points of 40 bytes"));
  EXPECT_THAT(error_with("scans/000001.bin", packed(1.0, 2.0, 3.0, 1000.05, 4.0)),
              HasSubstr("its points begin at 1000.050000000 s, the scan at 1000.100000000 s"));
  std::filesystem::remove(path() / "scans/000001.bin");
  EXPECT_THAT(error_with("scans/000000.bin", ""), HasSubstr("000001.bin: there is no such file"));
  EXPECT_THAT(error_with("scans.txt", ""), HasSubstr("scans.txt: names no scan"));
  EXPECT_THAT(error_with("scans.txt", "0 1\n"), HasSubstr("scans.txt:1: holds 2 columns"));
  EXPECT_THAT(error_with("scans.txt", "-1 1 2\n"), HasSubstr("'-1' is no index"));
  EXPECT_THAT(error_with("scans.txt", "0 1 2\n1 1 2\n"), HasSubstr("scans.txt:2: the scan does"));
}

TEST_F(Room, BrokenMetaIsNamed) {
  EXPECT_THAT(error_with("meta.json", "{"), HasSubstr("meta.json: byte 2: is not valid JSON"));
  EXPECT_THAT(error_with("meta.json", "{}"), AllOf(HasSubstr("meta.json"), HasSubstr("columns")));
  EXPECT_THAT(error_with("meta.json", "[]"), HasSubstr("meta.json"));
  EXPECT_THAT(error_with("meta.json", R"({"columns": [], "body_from_lidar": [0,0,0,0,0,0,1]})"),
              HasSubstr("columns is empty"));
  EXPECT_THAT(error_with("meta.json", R"({"columns": ["x"], "body_from_lidar": [0,0,0]})"),
              HasSubstr("body_from_lidar holds 3 numbers, not 7"));
  EXPECT_THAT(error_with("meta.json", R"({"columns": ["x"], "body_from_lidar": [0,0,0,0,0,0,2]})"),
              HasSubstr("body_from_lidar: the quaternion's norm is 2"));
  EXPECT_THAT(
      error_with("meta.json", R"({"columns": ["x","y"], "body_from_lidar": [0,0,0,0,0,0,1]})"),
      HasSubstr("has no field 'z'"));
  put("meta.json", R"({"columns": ["x"], "truth": "map", "body_from_lidar": [0,0,0,0,0,0,1]})");
  EXPECT_THAT(input_error([&] { room_truth(path()); }),
              AllOf(HasSubstr("truth of the 'map' is not known"), HasSubstr("'lidar frame'")));
}

TEST_F(Room, CutAnywhereItIsReadInPartOrRefused) {
  for (const std::string name : {"meta.json", "scans.txt", "imu.txt", "scans/000001.bin"}) {
    const std::string whole = file_text(path() / name);
    for (std::size_t n = 0; n < whole.size(); ++n) {
      put(name, whole.substr(0, n));
      try {
        const Dataset dataset = open_room(path());
        int events = 0;
        while (dataset.events->next()) ++events;
        EXPECT_LE(events, 14) << name << " cut to " << n;
      } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr(path().string()));
      }
    }
    put(name, whole);
  }
}

}  // namespace
}  // namespace lidarena
