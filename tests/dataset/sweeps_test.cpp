// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/points/sweeps.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

#include "lidarena/dataset/points/sweep_file.hpp"
#include "tests/dataset/file_helpers.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<Scan> all_scans(const Dataset& dataset) {
  std::vector<Scan> scans;
  while (auto event = dataset.events->next()) scans.push_back(std::get<Scan>(event->data));
  return scans;
}

/// A table of float64 columns by name, for scan_from().
PointTable table_of(std::vector<std::string> names, const std::vector<std::vector<double>>& rows,
                    ScalarType time_type = ScalarType::kFloat64) {
  PointTable table{"table", {}, rows.size(), {}};
  std::size_t stride = 0;
  for (const std::string& name : names) {
    const bool time = name.starts_with("t");
    table.columns.push_back({name, time ? time_type : ScalarType::kFloat64, stride, 0});
    stride += size_of(table.columns.back().type);
  }
  for (Column& column : table.columns) column.stride = stride;
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      append_scalar(table.bytes, table.columns[i].type, fmt::format("{}", row[i]));
    }
  }
  return table;
}

class Sweeps : public testing::Test {
 protected:
  std::filesystem::path put(const std::string& name, std::string_view bytes) const {
    return folder_.write(name, bytes);
  }
  void put_untimed(const std::string& name, float x) const { put(name, packed(x, 0.0F, 0.0F)); }
  std::string open_error(const ReadOptions& options = {}) const {
    return input_error([&] { open_sweep_folder(folder_.path(), options); });
  }
  TemporaryFolder folder_;
};

TEST(NaturalOrder, ComparesRunsOfDigitsAsNumbers) {
  std::vector<std::string> names{"s10.ply", "s2.ply", "s1.ply", "s02.ply", "a", "s2b", "s"};
  std::sort(names.begin(), names.end(), natural_less);
  EXPECT_THAT(names, ElementsAre("a", "s", "s1.ply", "s2.ply", "s2b", "s02.ply", "s10.ply"));
  EXPECT_FALSE(natural_less("7", "7"));
  EXPECT_TRUE(natural_less("18446744073709551616", "18446744073709551617"));
}

TEST(SweepTimes, Of32BitsCountFromTheStamp) {
  const auto scan = scan_from(
      table_of({"x", "y", "z", "t"}, {{1, 0, 0, 2000}, {2, 0, 0, 5000}}, ScalarType::kUint32),
      Time{1'000'000});
  EXPECT_TRUE(scan.timed);
  EXPECT_EQ(scan.stamp, Time{1'000'000});  // earlier firings may have no return
  EXPECT_EQ(scan.points[0].dt_ns, 2000);
  EXPECT_EQ(scan.points[1].dt_ns, 5000);
}

TEST(SweepTimes, OfDriversThatStampTheEndCountBackwards) {
  const auto scan = scan_from(
      table_of({"x", "y", "z", "time"}, {{1, 0, 0, -0.09375}, {2, 0, 0, 0}}, ScalarType::kFloat32),
      Time{1'000'000'000});
  EXPECT_EQ(scan.stamp, Time{906'250'000});
  EXPECT_EQ(scan.points[0].dt_ns, 0);
  EXPECT_EQ(scan.points[1].dt_ns, 93'750'000);
}

TEST(SweepTimes, Of64BitsAreAbsoluteSecondsOrNanoseconds) {
  const auto seconds = scan_from(
      table_of({"x", "y", "z", "timestamp"}, {{1, 0, 0, 1.6e9 + 0.25}, {2, 0, 0, 1.6e9 + 0.3125}}),
      Time{77});
  EXPECT_EQ(seconds.stamp, Time{1'600'000'000'250'000'000});
  EXPECT_EQ(seconds.points[1].dt_ns, 62'500'000);
  const auto nanoseconds = scan_from(
      table_of({"x", "y", "z", "timestamp"}, {{1, 0, 0, 1.6e18}, {2, 0, 0, 1.6e18 + 1'024'000}}),
      Time{77});
  EXPECT_EQ(nanoseconds.stamp, Time{1'600'000'000'000'000'000});
  EXPECT_EQ(nanoseconds.points[1].dt_ns, 1'024'000);
  const auto integers = scan_from(table_of({"x", "y", "z", "time_stamp"},
                                           {{1, 0, 0, 4096}, {2, 0, 0, 8192}}, ScalarType::kUint64),
                                  Time{77});
  EXPECT_EQ(integers.stamp, Time{4096});
  EXPECT_EQ(integers.points[1].dt_ns, 4096);
}

TEST(SweepTimes, ThatSpanMoreThanTwoSecondsAreRefused) {
  EXPECT_THAT(input_error([] {
                scan_from(table_of({"x", "y", "z", "t"}, {{1, 0, 0, 0}, {2, 0, 0, 3}}), Time{0});
              }),
              HasSubstr("span more than two seconds"));
  EXPECT_THAT(input_error([] {
                scan_from(table_of({"x", "y", "z", "t"}, {{1, 0, 0, 0}, {2, 0, 0, 3e9}},
                                   ScalarType::kUint32),
                          Time{0});
              }),
              HasSubstr("span more than two seconds"));
  EXPECT_THAT(input_error([] {
                scan_from(table_of({"x", "y", "z", "t"},
                                   {{1, 0, 0, std::numeric_limits<double>::quiet_NaN()}}),
                          Time{0});
              }),
              HasSubstr("point 1 has the time nan"));
}

TEST(SweepPoints, NoReturnsAreLeftOutAndTheRestIsInFiringOrder) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto scan =
      scan_from(table_of({"x", "y", "z", "t", "ring", "intensity"}, {{1, 0, 0, 0.3, 2, 9},
                                                                     {0, 0, 0, 0, 0, 0},
                                                                     {2, 0, 0, 0.1, 1, 8},
                                                                     {nan, nan, nan, nan, 0, 0},
                                                                     {3, 0, 0, 0.1, 5, 7}}),
                Time{0});
  ASSERT_EQ(scan.points.size(), 3U);
  EXPECT_EQ(scan.stamp, Time{100'000'000});
  EXPECT_EQ(scan.points[0].position.x(), 2.0F);
  EXPECT_EQ(scan.points[1].position.x(), 3.0F);  // same time: order as stored
  EXPECT_EQ(scan.points[2].position.x(), 1.0F);
  EXPECT_EQ(scan.points[2].ring, 2);
  EXPECT_EQ(scan.points[2].intensity, 9.0F);
}

TEST(SweepPoints, RingsThatAreNoIndexAreRefused) {
  for (const double ring : {-1.0, 65536.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(input_error([&] {
                  scan_from(table_of({"x", "y", "z", "ring"}, {{1, 0, 0, ring}}), Time{0});
                }),
                HasSubstr("point 1 has the ring"));
  }
}

TEST_F(Sweeps, WrittenAsPlyOrPcdComeBackAsTheyWere) {
  Scan scan{Time{1690309709285305601}, {}, true};
  for (int i = 0; i < 1000; ++i) {
    Point point;
    point.position = {static_cast<float>(i) + 0.1F, -2.5F, 1e-3F};
    point.intensity = static_cast<float>(i % 256);
    point.dt_ns = 100'000 * i;
    point.ring = static_cast<std::uint16_t>(i % 128);
    point.echo = static_cast<std::uint8_t>(i % 3);
    scan.points.push_back(point);
  }
  for (const bool timed : {true, false}) {
    scan.timed = timed;
    for (Point& point : scan.points) point.dt_ns = timed ? point.dt_ns : 0;
    for (const std::string ending : {".ply", ".pcd"}) {
      const auto file = folder_.path() / sweep_file_name(scan.stamp, ending);
      ending == ".ply" ? write_sweep_ply(file, scan) : write_sweep_pcd(file, scan);
      const auto back = all_scans(open_sweep_files({file}));
      ASSERT_EQ(back.size(), 1U);
      EXPECT_EQ(back[0].stamp, scan.stamp);
      EXPECT_EQ(back[0].timed, timed);
      ASSERT_EQ(back[0].points.size(), scan.points.size());
      for (std::size_t i = 0; i < scan.points.size(); ++i) {
        const Point& a = scan.points[i];
        const Point& b = back[0].points[i];
        ASSERT_EQ(a.position, b.position);
        ASSERT_EQ(std::tie(a.intensity, a.dt_ns, a.ring, a.echo),
                  std::tie(b.intensity, b.dt_ns, b.ring, b.echo));
      }
    }
  }
}

TEST_F(Sweeps, WithoutTimesComeAtTheRateInNaturalOrder) {
  put_untimed("10.bin", 10);
  put_untimed("2.bin", 2);
  put("LICENSE.txt", "text");
  ReadOptions options;
  options.layout = "xyz";
  options.rate_hz = 20.0;
  options.body_from_lidar = make_pose(Eigen::Matrix3d::Identity(), Eigen::Vector3d(1, 2, 3));
  const Dataset dataset = open_sweep_folder(folder_.path(), options);
  EXPECT_EQ(dataset.scan_count, 2U);
  ASSERT_EQ(dataset.rig.lidars.size(), 1U);
  EXPECT_EQ(dataset.rig.lidars[0].id, "lidar");
  EXPECT_EQ(dataset.rig.lidars[0].rate_hz, 20.0);
  EXPECT_EQ(dataset.rig.lidars[0].body_from_lidar.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_THAT(dataset.notes, ElementsAre(HasSubstr("20 Hz")));
  const auto scans = all_scans(dataset);
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[0].points[0].position.x(), 2.0F);
  EXPECT_FALSE(scans[0].timed);
  EXPECT_EQ(scans[1].stamp, Time{50'000'000});
}

TEST_F(Sweeps, TakeTheirTimesFromTimesTxt) {
  put_untimed("velodyne/000000.bin", 1);
  put_untimed("velodyne/000001.bin", 2);
  put("times.txt", "5.000000001\n5.1\n");
  ReadOptions options;
  options.layout = "xyz";
  EXPECT_TRUE(has_sweeps(folder_.path()));
  const auto scans = all_scans(open_sweep_folder(folder_.path(), options));
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[0].stamp, Time{5'000'000'001});
  put("times.txt", "5\n");
  EXPECT_THAT(open_error(options), HasSubstr("times.txt: holds 1 times for 2 sweeps"));
}

TEST_F(Sweeps, TakeTheirTimesFromNamesOfNineteenDigits) {
  put_untimed("1690309709285305601.bin", 1);
  put_untimed("1690309709385305601.bin", 2);
  ReadOptions options;
  options.layout = "xyz";
  const Dataset dataset = open_sweep_folder(folder_.path(), options);
  EXPECT_DOUBLE_EQ(dataset.rig.lidars[0].rate_hz, 10.0);
  EXPECT_EQ(all_scans(dataset)[0].stamp, Time{1690309709285305601});
}

TEST_F(Sweeps, RawLayoutsSayWhatEachNumberIs) {
  put("0.bin", packed(1.0F, 2.0F, 3.0F, 0.0625F, 7.0F));
  ReadOptions options;
  options.layout = "xyztr";
  const auto scan = all_scans(open_sweep_folder(folder_.path(), options))[0];
  EXPECT_EQ(scan.points[0].dt_ns, 62'500'000);
  EXPECT_EQ(scan.points[0].ring, 7);
  put("0.bin", packed(1.0F, 2.0F, 3.0F, 9.0F));
  options.layout = "xyzi";
  EXPECT_EQ(all_scans(open_sweep_folder(folder_.path(), options))[0].points[0].intensity, 9.0F);
  EXPECT_FALSE(all_scans(open_sweep_folder(folder_.path(), options))[0].timed);
  options.layout = "xyzt";
  EXPECT_THAT(input_error([&] { all_scans(open_sweep_folder(folder_.path(), options)); }),
              HasSubstr("span more than two seconds"));
  options.layout = "xyzrgb";
  EXPECT_THAT(open_error(options),
              AllOf(HasSubstr("'xyzrgb' is not a layout"), HasSubstr("xyz, xyzi, xyzt, xyztr")));
  options.layout = "xyz";
  EXPECT_THAT(input_error([&] { all_scans(open_sweep_folder(folder_.path(), options)); }),
              HasSubstr("0.bin: its 16 bytes are not a whole number of xyz points of 12 bytes"));
}

TEST_F(Sweeps, ARawLayoutIsInferredOnlyWhenAllSizesLeaveOne) {
  const std::string row(4 * 3 * 4, 'x');  // 48 bytes: 4 points of 12 or 3 of 16
  put("0.bin", row);
  EXPECT_THAT(open_error(),
              AllOf(HasSubstr("0.bin: no file states the layout"), HasSubstr("xyz, xyzi, xyzt"),
                    HasSubstr("choose one with --layout xyz|xyzi|xyzt|xyztr")));
  put("1.bin", row.substr(0, 12));
  const Dataset dataset = open_sweep_folder(folder_.path());
  EXPECT_THAT(dataset.notes, ElementsAre(HasSubstr("taken as xyz"), HasSubstr("10 Hz"),
                                         HasSubstr("the body frame")));
  put("2.bin", row.substr(0, 16));
  EXPECT_THAT(open_error(), HasSubstr("fit their sizes: none"));
}

TEST_F(Sweeps, BadInputIsNamed) {
  EXPECT_FALSE(has_sweeps(folder_.path()));
  EXPECT_THAT(open_error(), HasSubstr("holds no sweep"));
  EXPECT_THAT(input_error([&] { open_sweep_folder(folder_.path() / "none"); }),
              HasSubstr("there is no such folder"));
  put_untimed("0.bin", 1);
  put("0.ply", "ply\n");
  EXPECT_THAT(open_error(), HasSubstr("holds both .bin and .ply sweeps"));
  std::filesystem::remove(folder_.path() / "0.ply");
  ReadOptions options;
  options.layout = "xyz";
  options.sensor = "ouster";
  EXPECT_THAT(open_error(options),
              AllOf(HasSubstr("has no LiDAR 'ouster'"), HasSubstr("its only LiDAR is 'lidar'")));
  options.sensor = "lidar";
  options.rate_hz = 0.0;
  EXPECT_THAT(open_error(options), HasSubstr("rate_hz: 0 is not a valid"));
  EXPECT_THAT(input_error([&] { open_sweep_files({folder_.path() / "none.ply"}); }),
              HasSubstr("is not a sweep file"));
}

TEST_F(Sweeps, StampsMustIncrease) {
  // two sweeps whose 64-bit times both start at 0, i.e. are relative instead of absolute
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nproperty double timestamp\nend_header\n";
  put("0.ply", header + "1 0 0 0\n");
  put("1.ply", header + "1 0 0 0\n");
  EXPECT_THAT(input_error([&] { all_scans(open_sweep_folder(folder_.path())); }),
              AllOf(HasSubstr("1.ply: its stamp is not later"), HasSubstr("are absolute")));
}

TEST(RealSweeps, KittiDriveIsFifteenUntimedSweeps) {
  const auto folder = shared_data("lidar/kitti_drive");
  LIDARENA_NEEDS(folder);
  const auto scans = all_scans(open_sweep_folder(folder));
  ASSERT_EQ(scans.size(), 15U);
  double points = 0;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    EXPECT_FALSE(scans[i].timed);
    EXPECT_EQ(scans[i].stamp, Time{100'000'000} * static_cast<int>(i));
    points += static_cast<double>(scans[i].points.size()) / 15.0;
  }
  EXPECT_EQ(scans[0].points.size(), 122'692U - 1U);  // one point is at the origin
  EXPECT_NEAR(points, 122'500, 100);                 // "about 122 500 points a sweep"
}

TEST(RealSweeps, RsLidarCountsNanosecondsFromTheStampInItsName) {
  const auto folder = shared_data("lidar/rslidar32_static");
  LIDARENA_NEEDS(folder);
  const Dataset dataset = open_sweep_folder(folder);
  EXPECT_NEAR(dataset.rig.lidars[0].rate_hz, 10.0, 0.01);
  const auto scans = all_scans(dataset);
  ASSERT_EQ(scans.size(), 8U);
  EXPECT_EQ(scans[0].stamp, Time{1690309709285305600});
  EXPECT_EQ(scans[0].points.size(), 41'400U);
  EXPECT_EQ(scans[0].points.front().dt_ns, 0);
  EXPECT_EQ(scans[0].points.back().dt_ns, 99'745'600);
  for (const Scan& scan : scans) {
    EXPECT_TRUE(scan.timed);
    EXPECT_TRUE(std::is_sorted(scan.points.begin(), scan.points.end(),
                               [](const Point& a, const Point& b) { return a.dt_ns < b.dt_ns; }));
  }
}

TEST(RealSweeps, Vlp16StampsItsPointsInAbsoluteSeconds) {
  const auto folder = shared_data("lidar/vlp16_static");
  LIDARENA_NEEDS(folder);
  const auto scans = all_scans(open_sweep_folder(folder));
  ASSERT_EQ(scans.size(), 5U);
  for (const Scan& scan : scans) {
    EXPECT_GE(scan.points.size(), 14'672U);
    EXPECT_LE(scan.points.size(), 14'916U);
    EXPECT_NEAR(to_seconds(end_of(scan) - scan.stamp), 0.1, 0.002);  // one revolution at 10 Hz
    for (const Point& point : scan.points) ASSERT_LT(point.ring, 16);
  }
  // file names are the times at which the sweeps were published, after their last point
  const Time named{1673400472138016708};
  EXPECT_LT(end_of(scans[0]), named);
  EXPECT_GT(end_of(scans[0]), named - Time{2'000'000});
}

TEST(RealSweeps, Qt64AndPjlabKeepTheirRingsAndTimes) {
  const auto qt64 = shared_data("lidar/qt64_static");
  LIDARENA_NEEDS(qt64);
  const auto qt64_scans = all_scans(open_sweep_folder(qt64));
  ASSERT_EQ(qt64_scans.size(), 1U);
  EXPECT_EQ(qt64_scans[0].points.size(), 65'511U);
  EXPECT_NEAR(to_seconds(end_of(qt64_scans[0]) - qt64_scans[0].stamp), 0.1, 1e-3);
  const auto pjlab = shared_data("lidar/pjlab_lidar2imu");
  LIDARENA_NEEDS(pjlab);
  const auto sweep = all_scans(open_sweep_folder(pjlab));
  ASSERT_EQ(sweep.size(), 1U);
  EXPECT_EQ(sweep[0].points.size(), 80'787U);
  EXPECT_NEAR(to_seconds(sweep[0].stamp - Time{1635236489369082000}), 0.0, 2.4e-7);
  EXPECT_EQ(sweep[0].points[0].ring, 3);
}

TEST(RealSweeps, RawSweepsOfTwoSizesAreInferredAsXyz) {
  const auto folder = shared_data("lidar/gtsam_points/kitti_00");
  LIDARENA_NEEDS(folder);
  const Dataset dataset = open_sweep_folder(folder);
  EXPECT_THAT(dataset.notes, Contains(HasSubstr("taken as xyz")));
  const auto scans = all_scans(dataset);
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[0].points.size(), 1'496'016U / 12);
  EXPECT_EQ(scans[1].points.size(), 1'495'260U / 12);
}

TEST(RealSweeps, ReturnsAtTheOriginAreNone) {
  const auto file = shared_data("lidar/small_gicp_pair/source.ply");
  LIDARENA_NEEDS(file);
  EXPECT_EQ(read_sweep(file, Time{0}).points.size(), 64'685U);  // of 69 792 shots
}

}  // namespace
}  // namespace lidarena::dataset
