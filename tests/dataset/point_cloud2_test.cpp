// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/messages/point_cloud2.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/messages/livox_message.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"

namespace lidarena::dataset::ros {
namespace {

constexpr Time kStamp{1'700'000'000'123'456'789};  // November 2023
constexpr double kStampSeconds = 1'700'000'000.0;
constexpr double kAfterStampSeconds = 0.123456789;

/// A cloud message built field by field, as drivers do.
class CloudMessage {
 public:
  CloudMessage(Time stamp, std::uint32_t point_step, std::vector<PointField> fields)
      : stamp_(stamp), step_(point_step), fields_(std::move(fields)) {}

  std::byte* add_point() {
    data_.resize(data_.size() + step_);
    return data_.data() + data_.size() - step_;
  }
  template <class T>
  static void set(std::byte* point, std::size_t offset, T value) {
    std::memcpy(point + offset, &value, sizeof value);
  }
  static void set_position(std::byte* point, float x, float y, float z) {
    set(point, 0, x);
    set(point, 4, y);
    set(point, 8, z);
  }

  bool big_endian = false;
  std::uint32_t extra_width = 0;

  Scan decode() const {
    MessageWriter out;
    put_header(stamp_, "lidar", out);
    out.put(std::uint32_t{1});
    out.put(static_cast<std::uint32_t>(data_.size() / step_) + extra_width);
    out.put(static_cast<std::uint32_t>(fields_.size()));
    for (const PointField& field : fields_) {
      out.put(std::string_view(field.name));
      out.put(field.offset);
      out.put(static_cast<std::uint8_t>(field.type));
      out.put(std::uint32_t{1});
    }
    out.put(static_cast<std::uint8_t>(big_endian));
    out.put(step_);
    out.put(static_cast<std::uint32_t>(data_.size()));
    std::ranges::copy(data_, out.put_octets(data_.size()).begin());
    out.put(std::uint8_t{0});
    return decode_scan(out.bytes(), "test");
  }

 private:
  Time stamp_;
  std::uint32_t step_;
  std::vector<PointField> fields_;
  std::vector<std::byte> data_;
};

std::vector<PointField> with_position(std::vector<PointField> others) {
  std::vector<PointField> fields{
      {"x", 0, FieldType::kFloat32}, {"y", 4, FieldType::kFloat32}, {"z", 8, FieldType::kFloat32}};
  fields.insert(fields.end(), others.begin(), others.end());
  return fields;
}

std::vector<std::int32_t> times(const Scan& scan) {
  std::vector<std::int32_t> ns;
  for (const Point& point : scan.points) ns.push_back(point.dt_ns);
  return ns;
}

// Layout of the Ouster driver ("original" points, step 48): ordered by ring, so times jump back.
TEST(PointCloud2, ReadsAnOusterCloudAndPutsItInFiringOrder) {
  CloudMessage cloud(kStamp, 48,
                     with_position({{"intensity", 16, FieldType::kFloat32},
                                    {"t", 20, FieldType::kUint32},
                                    {"reflectivity", 24, FieldType::kUint16},
                                    {"ring", 26, FieldType::kUint16},
                                    {"ambient", 28, FieldType::kUint16},
                                    {"range", 32, FieldType::kUint32}}));
  for (std::uint16_t ring = 0; ring < 2; ++ring) {
    for (std::uint32_t column = 0; column < 3; ++column) {
      std::byte* point = cloud.add_point();
      const bool missed = ring == 1 && column == 1;
      CloudMessage::set_position(point, missed ? NAN : 1.0F, ring, static_cast<float>(column));
      CloudMessage::set(point, 16, 7.5F);
      CloudMessage::set(point, 20, 48828U * column);
      CloudMessage::set(point, 26, ring);
    }
  }
  const Scan scan = cloud.decode();
  EXPECT_EQ(scan.stamp, kStamp);
  EXPECT_TRUE(scan.timed);
  EXPECT_THAT(times(scan), testing::ElementsAre(0, 0, 48828, 97656, 97656));
  EXPECT_EQ(scan.points[1].ring, 1);
  EXPECT_EQ(scan.points[1].intensity, 7.5F);
}

// Velodyne's ROS driver uses the time of the last packet as stamp: point times are negative float
// seconds.
TEST(PointCloud2, TheStampBecomesTheFirstFiringWhereADriverStampsTheLast) {
  CloudMessage cloud(kStamp, 22,
                     with_position({{"intensity", 12, FieldType::kFloat32},
                                    {"ring", 16, FieldType::kUint16},
                                    {"time", 18, FieldType::kFloat32}}));
  for (const float time : {-0.0625F, -0.03125F, 0.0F}) {
    std::byte* point = cloud.add_point();
    CloudMessage::set_position(point, 1, 2, 3);
    CloudMessage::set(point, 18, time);
  }
  const Scan scan = cloud.decode();
  EXPECT_EQ(scan.stamp, kStamp - Time{62'500'000});
  EXPECT_THAT(times(scan), testing::ElementsAre(0, 31'250'000, 62'500'000));
}

// Livox driver 2: absolute ns in a double, with a resolution of 256 ns at this epoch.
TEST(PointCloud2, ReadsAbsoluteNanoseconds) {
  CloudMessage cloud(kStamp, 26,
                     with_position({{"intensity", 12, FieldType::kFloat32},
                                    {"tag", 16, FieldType::kUint8},
                                    {"line", 17, FieldType::kUint8},
                                    {"timestamp", 18, FieldType::kFloat64}}));
  const std::int64_t first = kStamp.count() / 256 * 256 + 256;  // exact in a double
  for (int i = 0; i < 3; ++i) {
    std::byte* point = cloud.add_point();
    CloudMessage::set_position(point, 1, 2, 3);
    CloudMessage::set(point, 17, static_cast<std::uint8_t>(i));
    CloudMessage::set(point, 18, static_cast<double>(first + i * 49'999'872));
  }
  const Scan scan = cloud.decode();
  EXPECT_EQ(scan.stamp, kStamp);
  const auto start = static_cast<std::int32_t>(first - kStamp.count());
  EXPECT_THAT(times(scan), testing::ElementsAre(start, start + 49'999'872, start + 2 * 49'999'872));
  EXPECT_EQ(scan.points[2].ring, 2);
}

// Hesai and RoboSense: absolute seconds in a double, with a resolution of 0.24 us at this epoch.
TEST(PointCloud2, ReadsAbsoluteSeconds) {
  CloudMessage cloud(kStamp, 26,
                     with_position({{"intensity", 12, FieldType::kFloat32},
                                    {"ring", 16, FieldType::kUint16},
                                    {"timestamp", 18, FieldType::kFloat64}}));
  for (int i = 0; i < 3; ++i) {
    std::byte* point = cloud.add_point();
    CloudMessage::set_position(point, 1, 2, 3);
    CloudMessage::set(point, 18, kStampSeconds + kAfterStampSeconds + 0.05 * i);
  }
  const Scan scan = cloud.decode();
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(static_cast<double>(
                    (time_of(scan, scan.points[static_cast<std::size_t>(i)]) - kStamp).count()),
                50e6 * i, 240.0);
  }
}

TEST(PointCloud2, TellsTheUnitOfFloatTimesByTheDurationOfTheScan) {
  struct Case {
    const char* name;
    double step;
  };
  for (const Case& c : {Case{"time", 0.05}, Case{"time", 0.05e6}, Case{"t", 0.05e9}}) {
    CloudMessage cloud(kStamp, 20, with_position({{c.name, 12, FieldType::kFloat64}}));
    for (int i = 0; i < 3; ++i) {
      std::byte* point = cloud.add_point();
      CloudMessage::set_position(point, 1, 2, 3);
      CloudMessage::set(point, 12, c.step * i);
    }
    EXPECT_THAT(times(cloud.decode()), testing::ElementsAre(0, 50'000'000, 100'000'000)) << c.step;
  }
}

TEST(PointCloud2, NearTimeZeroTheNameTellsAbsoluteFromRelative) {
  const Time stamp = std::chrono::seconds(2);
  for (const bool absolute : {true, false}) {
    CloudMessage cloud(stamp, 20,
                       with_position({{absolute ? "timestamp" : "time", 12, FieldType::kFloat64}}));
    for (int i = 0; i < 2; ++i) {
      std::byte* point = cloud.add_point();
      CloudMessage::set_position(point, 1, 2, 3);
      CloudMessage::set(point, 12, (absolute ? 2.0 : 0.0) + 0.0625 * i);
    }
    EXPECT_THAT(times(cloud.decode()), testing::ElementsAre(0, 62'500'000));
  }
}

TEST(PointCloud2, WithoutTimesAScanIsUntimed) {
  CloudMessage none(kStamp, 12, with_position({}));
  CloudMessage::set_position(none.add_point(), 1, 2, 3);
  EXPECT_FALSE(none.decode().timed);
  CloudMessage zero(kStamp, 16, with_position({{"t", 12, FieldType::kUint32}}));
  CloudMessage::set_position(zero.add_point(), 1, 2, 3);
  CloudMessage::set_position(zero.add_point(), 1, 2, 4);
  EXPECT_FALSE(zero.decode().timed);
}

TEST(PointCloud2, DropsWhatIsNoReturn) {
  CloudMessage cloud(kStamp, 12, with_position({}));
  CloudMessage::set_position(cloud.add_point(), 0, 0, 0);
  CloudMessage::set_position(cloud.add_point(), 1, 2, std::numeric_limits<float>::infinity());
  CloudMessage::set_position(cloud.add_point(), 1, 2, 3);
  EXPECT_THAT(cloud.decode().points, testing::SizeIs(1));
}

void expect_refused(const CloudMessage& cloud, const std::string& why) {
  try {
    cloud.decode();
    ADD_FAILURE() << "accepted, expected error: " << why;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(why));
  }
}

TEST(PointCloud2, SaysWhatItDoesNotUnderstand) {
  expect_refused({kStamp, 8, {{"x", 0, FieldType::kFloat32}, {"y", 4, FieldType::kFloat32}}},
                 "it has: x y");
  expect_refused({kStamp, 8, with_position({})}, "field 'z' of a cloud does not fit");
  expect_refused({kStamp, 16, with_position({{"t", 12, static_cast<FieldType>(9)}})},
                 "field 't' of a cloud does not fit");

  CloudMessage big(kStamp, 12, with_position({}));
  big.big_endian = true;
  expect_refused(big, "big endian");

  CloudMessage wide(kStamp, 12, with_position({}));
  wide.extra_width = 1;
  expect_refused(wide, "has 0 bytes of data");

  CloudMessage odd(kStamp, 20, with_position({{"timestamp", 12, FieldType::kFloat64}}));
  for (int i = 1; i < 3; ++i) {
    std::byte* point = odd.add_point();
    CloudMessage::set_position(point, 1, 2, 3);
    CloudMessage::set(point, 12, 1e6 + 0.05 * i);  // neither relative to the stamp nor close to it
  }
  expect_refused(odd, "field 'timestamp' runs from");

  CloudMessage nan(kStamp, 16, with_position({{"time", 12, FieldType::kFloat32}}));
  CloudMessage::set_position(nan.add_point(), 1, 2, 3);
  CloudMessage::set(nan.add_point() - 16, 12, NAN);
  expect_refused(nan, "field 'time' of a return is not finite");
}

// CDR aligns the uint32 of the next point, so every point except the last takes 20 bytes.
TEST(LivoxMessage, ReadsACustomMsg) {
  MessageWriter out;
  put_header(kStamp, "livox_frame", out);
  out.put(static_cast<std::uint64_t>(kStamp.count()));
  out.put(std::uint32_t{3});
  for (int i = 0; i < 4; ++i) out.put(std::uint8_t{0});
  out.put(std::uint32_t{3});
  for (std::uint32_t i = 0; i < 3; ++i) {
    out.put(5000U * i);
    for (int axis = 0; axis < 3; ++axis) out.put(i == 1 ? 0.0F : static_cast<float>(i + 1));
    out.put(static_cast<std::uint8_t>(100 + i));
    out.put(std::uint8_t{0x10});
    out.put(static_cast<std::uint8_t>(i));
  }
  EXPECT_TRUE(is_livox_type("livox_ros_driver2/msg/CustomMsg"));
  const Scan scan = decode_livox(out.bytes(), "test");
  EXPECT_EQ(scan.stamp, kStamp);
  ASSERT_EQ(scan.points.size(), 2U);  // the second has no return
  EXPECT_EQ(scan.points[1].dt_ns, 10000);
  EXPECT_EQ(scan.points[1].position, Eigen::Vector3f(3, 3, 3));
  EXPECT_EQ(scan.points[1].intensity, 102.0F);
  EXPECT_EQ(scan.points[1].ring, 2);
  EXPECT_THROW(decode_livox(out.bytes().first(out.bytes().size() - 1), "test"), InputError);
}

}  // namespace
}  // namespace lidarena::dataset::ros
