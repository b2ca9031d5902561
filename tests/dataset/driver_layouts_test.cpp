// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/messages/driver_layouts.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "lidarena/base/error.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/messages/livox_message.hpp"
#include "lidarena/dataset/messages/point_cloud2.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/recording.hpp"
#include "lidarena/dataset/recording_source.hpp"
#include "tests/dataset/event_matching.hpp"
#include "tests/dataset/file_helpers.hpp"
#include "tests/dataset/sample_events.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

using testing::HasSubstr;

constexpr int kLines = 4;
constexpr int kShotsPerLine = 50;

LidarInfo mid360() {
  LidarInfo lidar;
  lidar.id = "mid360";
  lidar.model = "livox_mid360";
  lidar.rows = kLines;
  lidar.columns = kShotsPerLine;
  return lidar;
}

/// Shots 0.5 ms apart; about every third has no return.
Scan livox_scan() {
  Scan scan{std::chrono::seconds(12) + Time{345}, {}, true};
  SequentialRandom random(3);
  for (int i = 0; i < kLines * kShotsPerLine; ++i) {
    if (random.uniform(0.0, 1.0) < 0.33) continue;
    const auto value = static_cast<float>(i);
    scan.points.push_back({Eigen::Vector3f(1.0F + value, -value, 0.25F), value, i * 500'000,
                           static_cast<std::uint16_t>(i % kLines), 0});
  }
  return scan;
}

class Encodings : public testing::TestWithParam<Encoding> {
 protected:
  MessageWriter message_{GetParam()};
};

TEST_P(Encodings, LivoxCustomMessagesGiveTheSamePointsBack) {
  encode_livox_custom(livox_scan(), mid360(), "livox_frame", message_);
  expect_same(decode_livox(message_.bytes(), "test", GetParam()), livox_scan());
}

TEST_P(Encodings, LivoxCustomMessagesHaveEveryShotInTheDriversOrder) {
  const Scan scan = livox_scan();
  encode_livox_custom(scan, mid360(), "livox_frame", message_);
  MessageReader in(message_.bytes(), "test", GetParam());
  const auto header = ros::get_header(in);
  EXPECT_EQ(header.stamp, scan.stamp);
  EXPECT_EQ(header.frame_id, "livox_frame");
  EXPECT_EQ(in.get<std::uint64_t>(), static_cast<std::uint64_t>(scan.stamp.count()));
  constexpr std::uint32_t kShots = kLines * kShotsPerLine;
  EXPECT_EQ(in.get<std::uint32_t>(), kShots);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(in.get<std::uint8_t>(), 0);
  EXPECT_EQ(in.get<std::uint32_t>(), kShots);
  std::size_t returns = 0;
  for (std::uint32_t i = 0; i < kShots; ++i) {
    EXPECT_EQ(in.get<std::uint32_t>(), i * 500'000);
    const auto x = in.get<float>();
    in.get<float>();
    in.get<float>();
    EXPECT_EQ(in.get<std::uint8_t>(), x == 0.0F ? 0 : i);  // reflectivity
    EXPECT_EQ(in.get<std::uint8_t>(), 0);                  // tag: high confidence
    EXPECT_EQ(in.get<std::uint8_t>(), i % kLines);
    returns += x == 0.0F ? 0 : 1;
  }
  EXPECT_EQ(returns, scan.points.size());
}

TEST_P(Encodings, ScansWhoseShotsAreUnknownAreWrittenAsTheyAre) {
  LidarInfo lidar = mid360();
  lidar.columns = 0;
  encode_livox_custom(livox_scan(), lidar, "livox_frame", message_);
  expect_same(decode_livox(message_.bytes(), "test", GetParam()), livox_scan());
  Scan odd = livox_scan();
  odd.points[5].dt_ns += 1000;  // between two shots
  encode_livox_custom(odd, mid360(), "livox_frame", message_);
  expect_same(decode_livox(message_.bytes(), "test", GetParam()), odd);
  Scan untimed = livox_scan();
  untimed.timed = false;
  for (Point& point : untimed.points) point.dt_ns = 0;
  encode_livox_custom(untimed, mid360(), "livox_frame", message_);
  expect_same(decode_livox(message_.bytes(), "test", GetParam()), untimed);
}

TEST_P(Encodings, LivoxCloudsHave26BytesAPointWithAbsoluteTimes) {
  const Scan scan = livox_scan();
  encode_livox_cloud(scan, mid360(), "livox_frame", message_);
  MessageReader in(message_.bytes(), "test", GetParam());
  ros::get_header(in);
  const ros::PointCloud2 cloud = ros::get_cloud(in, "test");
  EXPECT_EQ(cloud.point_step, 26U);
  EXPECT_EQ(cloud.width, 200U);
  ASSERT_EQ(cloud.fields.size(), 7U);
  EXPECT_EQ(cloud.fields[6], (ros::PointField{"timestamp", 18, ros::FieldType::kFloat64}));
  double time = 0.0;
  std::memcpy(&time, cloud.data.data() + 26 * 7 + 18, sizeof time);
  EXPECT_EQ(time, 12e9 + 345 + 7 * 500'000);
  expect_same(ros::decode_scan(message_.bytes(), "test", GetParam()), scan);
}

TEST_P(Encodings, OneReturnAloneIsUnderstoodToo) {
  Scan scan = livox_scan();
  scan.points.erase(scan.points.begin() + 1, scan.points.end());
  scan.points[0].dt_ns = 1'500'000;
  encode_livox_cloud(scan, mid360(), "livox_frame", message_);
  expect_same(ros::decode_scan(message_.bytes(), "test", GetParam()), scan);
}

TEST_P(Encodings, OfTheFirstGenerationTagsTellTheReturnAndCloudsHaveNoTimes) {
  LidarInfo mid40 = mid360();
  mid40.model = "livox_mid40";
  encode_livox_cloud(livox_scan(), mid40, "livox_frame", message_);
  MessageReader in(message_.bytes(), "test", GetParam());
  ros::get_header(in);
  const ros::PointCloud2 cloud = ros::get_cloud(in, "test");
  EXPECT_EQ(cloud.point_step, 18U);
  EXPECT_EQ(cloud.fields.size(), 6U);
  EXPECT_EQ(cloud.data[16], std::byte{0x10});
}

constexpr int kRings = 4;
constexpr int kColumns = 8;

LidarInfo small_ouster() {
  LidarInfo lidar;
  lidar.id = "os0";
  lidar.model = "ouster_os0_128";
  lidar.rows = kRings;
  lidar.columns = kColumns;
  lidar.pixel_shifts = {3, 1, -1, -3};
  lidar.beam_origin_m = 0.02767;
  return lidar;
}

/// A return in every second pixel, 9 m along a beam that points `pixel_shifts` columns ahead.
Scan ouster_scan() {
  Scan scan{std::chrono::seconds(7), {}, true};
  for (int column = 0; column < kColumns; ++column) {
    const double head = 2.0 * std::numbers::pi * (1.0 - column / 8.0);
    for (int ring = 0; ring < kRings; ++ring) {
      if ((column + ring) % 2 == 1) continue;
      const double beam = head - 2.0 * std::numbers::pi *
                                     small_ouster().pixel_shifts[static_cast<std::size_t>(ring)] /
                                     kColumns;
      const Eigen::Vector3d p(0.02767 * std::cos(head) + 9.0 * std::cos(beam),
                              0.02767 * std::sin(head) + 9.0 * std::sin(beam), 0.0);
      scan.points.push_back(
          {p.cast<float>(), 17.25F, column * 12'500'000, static_cast<std::uint16_t>(ring), 0});
    }
  }
  return scan;
}

TEST_P(Encodings, OusterCloudsGiveTheSamePointsBack) {
  encode_ouster_cloud(ouster_scan(), small_ouster(), "os_lidar", message_);
  expect_same(ros::decode_scan(message_.bytes(), "test", GetParam()), ouster_scan());
}

// Destaggered: all pixels of one image column have the same direction.
TEST_P(Encodings, OusterCloudsAreImagesWhoseColumnsAreDirections) {
  encode_ouster_cloud(ouster_scan(), small_ouster(), "os_lidar", message_);
  MessageReader in(message_.bytes(), "test", GetParam());
  EXPECT_EQ(ros::get_header(in).stamp, std::chrono::seconds(7));
  const ros::PointCloud2 cloud = ros::get_cloud(in, "test");
  EXPECT_EQ(cloud.height, 4U);
  EXPECT_EQ(cloud.width, 8U);
  EXPECT_EQ(cloud.point_step, 48U);
  EXPECT_EQ(cloud.row_step, 48U * 8);
  int returns = 0;
  for (std::size_t i = 0; i < 32; ++i) {
    const std::byte* at = cloud.data.data() + 48 * i;
    const auto load = [&]<class T>(std::size_t offset, T value) {
      std::memcpy(&value, at + offset, sizeof value);
      return value;
    };
    const std::size_t row = i / 8;
    const std::size_t pixel = i % 8;
    EXPECT_EQ(load(26, std::uint16_t{}), row);
    const int shift = small_ouster().pixel_shifts[row];
    const int column = (static_cast<int>(pixel) - shift + 8) % 8;
    EXPECT_EQ(load(20, std::uint32_t{}), static_cast<std::uint32_t>(column) * 12'500'000U);
    const float x = load(0, 0.0F);
    if (std::isnan(x)) {
      EXPECT_EQ(load(32, std::uint32_t{}), 0U);
      continue;
    }
    ++returns;
    const double azimuth = std::atan2(load(4, 0.0F), x);
    const double pixel_azimuth = 2.0 * std::numbers::pi * (1.0 - static_cast<double>(pixel) / 8.0);
    // the beam's origin, 28 mm off the axis, changes the azimuth at 9 m by at most 0.0031 rad
    EXPECT_NEAR(std::remainder(azimuth - pixel_azimuth, 2.0 * std::numbers::pi), 0.0, 0.0032);
    EXPECT_EQ(load(32, std::uint32_t{}), 9028U);  // 9 m from an origin 27.67 mm off the axis
    EXPECT_EQ(load(16, 0.0F), 17.25F);
    EXPECT_EQ(load(24, std::uint16_t{}), 17U);
  }
  EXPECT_EQ(returns, 16);
}

TEST_P(Encodings, OusterScansWithoutTimesOrGeometryStandInOneRow) {
  Scan scan = ouster_scan();
  LidarInfo unknown = small_ouster();
  unknown.pixel_shifts.clear();
  encode_ouster_cloud(scan, unknown, "os_lidar", message_);
  expect_same(ros::decode_scan(message_.bytes(), "test", GetParam()), scan);
  scan.timed = false;
  for (Point& point : scan.points) point.dt_ns = 0;
  encode_ouster_cloud(scan, small_ouster(), "os_lidar", message_);
  expect_same(ros::decode_scan(message_.bytes(), "test", GetParam()), scan);
}

TEST_P(Encodings, ImusHaveTheirDriversUnitsAndCovariances) {
  const ImuSample sample = sample::imu(3);
  encode_driver_imu(sample, Driver::kLivox, "imu", message_);
  ImuSample back = ros::decode_imu(message_.bytes(), "test", GetParam());
  EXPECT_NEAR(back.accel.z(), 1.0, 1e-15);
  EXPECT_EQ(back.gyro, sample.gyro);
  encode_driver_imu(sample, Driver::kOuster, "imu", message_);
  MessageReader in(message_.bytes(), "test", GetParam());
  ros::get_header(in);
  in.skip_doubles(4);
  EXPECT_EQ(in.get<double>(), -1.0);
  in.skip_doubles(8 + 3);
  EXPECT_EQ(in.get<double>(), 6e-4);
  EXPECT_EQ(in.get<double>(), 0.0);
  in.skip_doubles(2);
  EXPECT_EQ(in.get<double>(), 6e-4);
  in.skip_doubles(4 + 3);
  EXPECT_EQ(in.get<double>(), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Ros, Encodings, testing::Values(Encoding::kCdr, Encoding::kRos1),
                         [](const auto& param) {
                           return param.param == Encoding::kCdr ? "Ros2" : "Ros1";
                         });

Rig both() {
  Rig rig;
  rig.lidars = {mid360(), small_ouster()};
  rig.imus.resize(2);
  rig.imus[0].id = "mid360";
  rig.imus[1].id = "os0";
  return rig;
}

std::vector<Event> events_of_both() {
  std::vector<Event> events;
  for (int i = 0; i <= 200; ++i) {
    ImuSample sample = sample::imu(i);
    sample.stamp = std::chrono::seconds(7) + Time{5'000'000 * i};
    events.push_back({"mid360", sample});
    events.push_back({"os0", sample});
  }
  events.push_back({"os0", ouster_scan()});
  ImuSample sample = sample::imu(7);
  sample.stamp = std::chrono::seconds(13);
  events.push_back({"mid360", sample});
  events.push_back({"os0", sample});
  events.push_back({"mid360", livox_scan()});
  return events;
}

class DriverDialect : public testing::TestWithParam<DatasetFormat> {
 protected:
  DriverDialect() {
    DatasetWriter out(path_, both(), {.format = GetParam(), .dialect = Dialect::kDriver});
    for (const Event& event : events_of_both()) out.write(event);
    out.close();
  }

  /// Compares with events_of_both(), up to rounding of accelerations that were converted to g and
  /// back.
  static void expect_nearly_same(std::vector<Event> events) {
    const std::vector<Event> expected = events_of_both();
    ASSERT_EQ(events.size(), expected.size());
    for (std::size_t i = 0; i < events.size(); ++i) {
      auto* sample = std::get_if<ImuSample>(&events[i].data);
      if (sample == nullptr) continue;
      const Eigen::Vector3d accel = std::get<ImuSample>(expected[i].data).accel;
      EXPECT_LE((sample->accel - accel).norm(), 1e-14);
      sample->accel = accel;
    }
    expect_same(events, expected);
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "flight";
};

TEST_P(DriverDialect, ReadsBackAsTheSameEventsInSi) {
  expect_nearly_same(drain(*open_dataset(path_).events));
}

TEST_P(DriverDialect, HasTheTopicsAndTypesOfTheDrivers) {
  const bool is_bag = GetParam() == DatasetFormat::kBag;
  const RecordingInfo info = read_recording_info(path_ / (is_bag ? "data.bag" : "data.mcap"));
  std::map<std::string, std::string> types;
  for (const RecordedTopic& topic : info.topics) types[topic.topic] = topic.type;
  EXPECT_EQ(types.at("/mid360/livox"), "livox_ros_driver2/msg/CustomMsg");
  EXPECT_EQ(types.at("/mid360/points"), ros::kPointCloud2);
  EXPECT_EQ(types.at("/os0/points"), ros::kPointCloud2);
  EXPECT_FALSE(types.contains("/os0/livox"));
}

INSTANTIATE_TEST_SUITE_P(Formats, DriverDialect,
                         testing::Values(DatasetFormat::kMcap, DatasetFormat::kBag),
                         [](const auto& param) {
                           return param.param == DatasetFormat::kBag ? "Bag" : "Mcap";
                         });

}  // namespace
}  // namespace lidarena::dataset
