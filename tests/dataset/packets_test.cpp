// SPDX-License-Identifier: BSD-3-Clause
// Packets of LiDARs in captures and messages.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/damaged_file.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/packets/ouster_packets.hpp"
#include "lidarena/dataset/packets/pcap_reader.hpp"
#include "lidarena/dataset/packets/velodyne_packets.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "tests/dataset/event_matching.hpp"
#include "tests/dataset/file_helpers.hpp"
#include "tests/dataset/packet_samples.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(PcapReader, GivesTheDatagramsWithPortAndTime) {
  const TemporaryFolder folder;
  PcapReader reader(folder.write(
      "a.pcap", pcap({ip_frame(udp("one", 7502), 1, 0, false), std::string(60, '\1'),  // no IP
                      ip_frame(udp("three", 7503), 2, 0, false)})));
  const auto first = reader.next();
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->port, 7502);
  EXPECT_EQ(text_of(first->payload), "one");
  const auto second = reader.next();
  ASSERT_TRUE(second.has_value());
  EXPECT_EQ(text_of(second->payload), "three");
  EXPECT_EQ(second->captured, std::chrono::seconds(1'700'000'000) + Time{200'000});
  EXPECT_FALSE(reader.next().has_value());
}

/// A block of pcapng.
std::string block(std::uint32_t type, std::string body) {
  body.resize((body.size() + 3) / 4 * 4);
  const auto length = static_cast<std::uint32_t>(12 + body.size());
  return packed(type, length) + body + packed(length);
}

/// The 4-byte numbers and the given 2-byte ones are in the other byte order.
std::string swapped_words(const std::string& bytes) {
  std::string other;
  for (std::size_t i = 0; i < bytes.size(); i += 4)
    other += {bytes[i + 3], bytes[i + 2], bytes[i + 1], bytes[i]};
  return other;
}

TEST(PcapReader, ReadsPcapngWithItsKindsOfPackets) {
  const TemporaryFolder folder;
  const std::string one = ip_frame(udp("one", 7502), 1, 0, false);
  const std::string two = ip_frame(udp("two", 7502), 2, 0, false);
  const auto size = static_cast<std::uint32_t>(one.size());
  const std::string section = block(0x0A0D0D0A, packed(0x1A2B3C4DU, 1U, -1, -1));
  const std::string in_us = block(1, packed(std::uint16_t{1}, std::uint16_t{0}, 0U));
  const std::string in_ns = block(1, packed(std::uint16_t{1}, std::uint16_t{0}, 0U,
                                            std::uint16_t{9}, std::uint16_t{1}, 9U, 0U));
  const std::string in_halves = block(1, packed(std::uint16_t{1}, std::uint16_t{0}, 0U,
                                                std::uint16_t{9}, std::uint16_t{1}, 0x81U, 0U));
  PcapReader reader(folder.write(
      "a.pcapng",
      section + in_us + in_ns + in_halves + block(5, "statistics..") +
          block(6, packed(0U, 0U, 1'500'000U, size, size) + one) +
          block(6, packed(1U, 1U, 2U, size, size) + two) +  // 2^32 + 2 ns
          block(6, packed(2U, 0U, 7U, size, size) + one) +
          block(2, packed(std::uint16_t{0}, std::uint16_t{0}, 0U, 9U, size, size) + two) +
          block(3, packed(size) + one)));
  const std::vector<std::pair<std::string, Time>> expected{{"one", Time{1'500'000'000}},
                                                           {"two", Time{4'294'967'298}},
                                                           {"one", Time{3'500'000'000}},
                                                           {"two", Time{9000}},
                                                           {"one", Time{9000}}};
  for (const auto& [text, time] : expected) {
    const auto datagram = reader.next();
    ASSERT_TRUE(datagram.has_value());
    EXPECT_EQ(text_of(datagram->payload), text);
    EXPECT_EQ(datagram->captured, time);
  }
  EXPECT_FALSE(reader.next().has_value());
}

TEST(PcapReader, ReadsPcapngInTheOtherByteOrderAndUntilItsCut) {
  const TemporaryFolder folder;
  const std::string frame = ip_frame(udp("one", 7502), 1, 0, false) + "\0";
  const auto size = static_cast<std::uint32_t>(frame.size() / 4 * 4);
  const std::string content = frame.substr(0, size);
  const std::string link =  // two numbers of 2 bytes
      swapped_words(packed(1U, 20U)) + std::string("\0\1\0\0", 4) + swapped_words(packed(0U, 20U));
  const std::uint32_t length = 32 + size;
  const std::string packet = swapped_words(packed(6U, length, 0U, 0U, 4U, size, size)) + content +
                             swapped_words(packed(length));
  const std::string file =
      swapped_words(block(0x0A0D0D0A, packed(0x1A2B3C4DU, 1U, -1, -1))) + link + packet + packet;
  PcapReader reader(folder.write("a.pcapng", file.substr(0, file.size() - 5)));
  const auto datagram = reader.next();
  ASSERT_TRUE(datagram.has_value());
  EXPECT_EQ(datagram->captured, Time{4000});
  EXPECT_THROW(reader.next(), DamagedFile);
}

TEST(PcapReader, JoinsWhatIpHasSplitInAnyOrder) {
  const TemporaryFolder folder;
  const std::string payload(3000, 'x');
  const std::string whole = udp(payload, 7502);
  PcapReader reader(folder.write("a.pcap", pcap({ip_frame(whole.substr(1480, 1480), 9, 1480, true),
                                                 ip_frame(whole.substr(0, 1480), 9, 0, true),
                                                 ip_frame(whole.substr(2960), 9, 2960, false)})));
  const auto datagram = reader.next();
  ASSERT_TRUE(datagram.has_value());
  EXPECT_EQ(text_of(datagram->payload), payload);
  EXPECT_FALSE(reader.next().has_value());
}

TEST(PcapReader, ACutFileGivesThePacketsBeforeTheCut) {
  const TemporaryFolder folder;
  const std::string file =
      pcap({ip_frame(udp("one", 7502), 1, 0, false), ip_frame(udp("two", 7502), 2, 0, false)});
  PcapReader reader(folder.write("a.pcap", file.substr(0, file.size() - 1)));
  EXPECT_TRUE(reader.next().has_value());
  EXPECT_THROW(reader.next(), DamagedFile);
}

TEST(PcapReader, OtherFilesAreRefusedWithARemedy) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& text) {
    return input_error([&] { PcapReader reader(folder.write("a.pcap", text)); });
  };
  PcapReader empty(
      folder.write("a.pcapng", std::string("\x0a\x0d\x0d\x0a", 4) + std::string(40, '\0')));
  EXPECT_THROW(empty.next(), DamagedFile);
  EXPECT_THAT(error("nothing"), HasSubstr("is not a capture of packets"));
}

OusterMetadata small_ouster(OusterProfile profile) {
  OusterMetadata meta;
  meta.profile = profile;
  meta.columns_per_frame = 4;
  meta.columns_per_packet = 2;
  meta.altitude_rad = {0.5, -0.5};
  meta.azimuth_rad = {0.1, -0.1};
  meta.beam_origin_m = {0.03, 0.0};
  return meta;
}

TEST(OusterScans, EachProfileHasRangesReflectivitiesAndEchoes) {
  struct Case {
    OusterProfile profile;
    std::string pixel;
    std::size_t echoes;
  };
  const std::uint8_t zero = 0, reflectivity = 77;
  const std::uint16_t unused = 0xFFFF;
  for (const Case& c :
       {Case{OusterProfile::kLegacy,
             packed(0xFFF00000U | 8000U, reflectivity, zero, unused, unused, unused), 1},
        Case{OusterProfile::kSingle,
             packed(0xFFF80000U | 8000U, reflectivity, zero, unused, unused, unused), 1},
        Case{OusterProfile::kDual,
             packed((77U << 24) | 8000U, (99U << 24) | 9000U, unused, unused, unused, unused), 2},
        Case{OusterProfile::kLowRate, packed(std::uint16_t{0x8000 | 1000}, reflectivity, zero),
             1}}) {
    SCOPED_TRACE(static_cast<int>(c.profile));
    OusterScans scans(small_ouster(c.profile));
    const auto push = [&](std::uint16_t frame, std::uint16_t column) {
      const std::string packet = ouster_packet(c.profile, frame, column, c.pixel);
      EXPECT_EQ(packet.size(), scans.packet_bytes());
      return scans.push(std::as_bytes(std::span(packet)));
    };
    EXPECT_FALSE(push(5, 0).has_value());
    EXPECT_FALSE(push(5, 2).has_value());
    const auto scan = push(6, 0);
    ASSERT_TRUE(scan.has_value());
    EXPECT_EQ(scan->stamp, Time{1000000});
    ASSERT_EQ(scan->points.size(), 8 * c.echoes);
    const Point& first = scan->points.front();
    // encoder angle 0, beam 0.1 rad to the right of it, 8 m from the axis
    const Eigen::Vector3d expected =
        Eigen::Vector3d(0.03, 0.0, 0.0) +
        (8.0 - 0.03) * Eigen::Vector3d(std::cos(0.5) * std::cos(-0.1),
                                       std::cos(0.5) * std::sin(-0.1), std::sin(0.5));
    EXPECT_LT((first.position.cast<double>() - expected).norm(), 1e-6);
    EXPECT_EQ(first.intensity, 77.0F);
    EXPECT_EQ(scan->points.back().dt_ns, 300000);
    if (c.echoes == 2) {
      EXPECT_EQ(scan->points[1].echo, 1);
      EXPECT_EQ(scan->points[1].intensity, 99.0F);
    }
  }
}

/// The range as the sensor measured it, mm, of a point of `meta`'s LiDAR.
double range_mm(const Point& point, const OusterMetadata& meta) {
  const double n = meta.beam_origin_m.norm();
  const double c = std::cos(meta.altitude_rad[point.ring]) * std::cos(meta.azimuth_rad[point.ring]);
  const double squared = point.position.cast<double>().squaredNorm();
  return 1e3 * (n - n * c + std::sqrt(n * n * c * c + squared - n * n));
}

// The counts and sums of ranges are those of the OSF file beside the capture.
TEST(OusterCapture, HasTheReturnsOfTheOsfOfTheSamePackets) {
  const auto folder = shared_data("lidar/ouster");
  LIDARENA_NEEDS(folder);
  const auto meta = read_ouster_metadata(folder / "OS-1-128_v2.3.0_1024x10.json");
  Dataset dataset = open_dataset(folder / "OS-1-128_v2.3.0_1024x10_lb_n3.pcap");
  constexpr std::array<std::size_t, 3> kReturns{107647, 107357, 107532};
  constexpr std::array<double, 3> kRangeSums{1695188032.0, 1691787376.0, 1701150736.0};
  std::size_t scans = 0, samples = 0;
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();
  while (const auto event = dataset.events->next()) {
    if (const auto* sample = std::get_if<ImuSample>(&event->data)) {
      accel += sample->accel;
      ++samples;
      continue;
    }
    const Scan& scan = std::get<Scan>(event->data);
    ASSERT_LT(scans, 3U);
    EXPECT_EQ(scan.points.size(), kReturns[scans]);
    double sum = 0.0;
    for (const Point& point : scan.points) sum += range_mm(point, meta);
    EXPECT_NEAR(sum, kRangeSums[scans], 1e-6 * kRangeSums[scans]);
    EXPECT_NEAR(to_seconds(end_of(scan) - scan.stamp), 0.0999, 2e-4);
    ++scans;
  }
  EXPECT_EQ(scans, 3U);
  EXPECT_EQ(samples, 30U);
  // the means of the 30 packets, 1.0827 g, read from the file byte by byte
  EXPECT_NEAR(accel.norm() / 30.0, 1.0827 * 9.80665, 1e-3);
  EXPECT_TRUE(dataset.rig.imus.at(0).body_from_imu.translation().isApprox(
      Eigen::Vector3d(0.006253, -0.011775, 0.007645)));
}

TEST(OusterCapture, ASensorOfAnotherShapeIsRead) {
  const auto file = shared_data("lidar/ouster/OS-0-128-U1_v2.3.0_1024x10.pcap");
  LIDARENA_NEEDS(file);
  Dataset dataset = open_dataset(file);
  std::size_t scans = 0;
  while (const auto event = dataset.events->next())
    scans += std::holds_alternative<Scan>(event->data) ? 1 : 0;
  EXPECT_EQ(scans, 1U);
  EXPECT_EQ(dataset.rig.lidars.at(0).model, "OS-0-128");
}

TEST(OusterCapture, WithoutItsMetadataTheErrorAsksForThem) {
  const TemporaryFolder folder;
  const auto file =
      folder.write("a.pcap", pcap({ip_frame(udp(std::string(900, 'x'), 7502), 1, 0, false)}));
  EXPECT_THAT(input_error([&] { open_dataset(file); }),
              testing::AllOf(HasSubstr("put its metadata (JSON) beside"),
                             HasSubstr("1 of 900 bytes to port 7502")));
}

// The driver (nebula) made the PCD of the packets in the message with the same stamp.
TEST(VelodyneScans, HasThePointsThatTheDriverMakesOfTheSamePackets) {
  const auto folder = shared_data("lidar/vlp16_static");
  LIDARENA_NEEDS(folder);
  const Cloud expected = read_cloud(folder / "1673400472138016708.pcd");
  Dataset dataset = open_dataset(folder / "rosbag2");
  std::vector<Scan> scans;
  while (auto event = dataset.events->next()) scans.push_back(std::get<Scan>(event->data));
  ASSERT_EQ(scans.size(), 4U);
  std::size_t near = 0;
  for (const Eigen::Vector3f& point : expected.points) {
    const auto is_near = [&](const Point& other) {
      // the driver leaves out the heights of the lasers, up to 11.2 mm; azimuths differ by 0.1 deg
      return (other.position - point).norm() < 0.0115F + 0.002F * point.norm();
    };
    // the driver begins a sweep at another azimuth than the message
    near += std::ranges::any_of(scans[3].points, is_near) ||
                    std::ranges::any_of(scans[2].points, is_near)
                ? 1
                : 0;
  }
  EXPECT_GT(near, expected.points.size() * 99 / 100);
  EXPECT_NEAR(static_cast<double>(scans.back().points.size()),
              static_cast<double>(expected.points.size()), 0.05 * 15000);
  EXPECT_NEAR(to_seconds(end_of(scans[1]) - scans[1].stamp), 0.1, 0.005);
}

/// A packet of 12 blocks in which every shot has the range `units`; a block turns by 0.2 degrees.
std::string velodyne_packet(std::uint8_t model, std::uint16_t units) {
  std::string packet;
  for (std::uint16_t block = 0; block < 12; ++block) {
    packet += packed(std::uint16_t{0xEEFF}, static_cast<std::uint16_t>(9000 + 20 * block));
    for (int shot = 0; shot < 32; ++shot) packet += packed(units, std::uint8_t{50});
  }
  return packet + packed(1000U, std::uint8_t{0x37}, model);
}

Scan scan_of(const std::string& packet) {
  VelodyneScans scans("a.pcap");
  scans.push(std::chrono::hours(5), std::as_bytes(std::span(packet)), true);
  return scans.finish().value();
}

double elevation_deg(const Point& point) {
  const Eigen::Vector3f& p = point.position;
  return std::atan2(p.z(), p.head<2>().norm()) * 180.0 / std::numbers::pi;
}

TEST(VelodyneScans, OfTheVlp32cHaveTheAnglesAndTimesOfItsManual) {
  // the lasers as configs/sensors/beams/velodyne_vlp32c.yaml has them: ring, elevation, azimuth
  // (counter-clockwise), instant in the cycle
  struct Laser {
    int ring;
    double elevation_deg, offset_deg, us;
  };
  const Scan scan = scan_of(velodyne_packet(0x28, 2500));  // 10 m by units of 4 mm
  ASSERT_EQ(scan.points.size(), 12U * 32U);
  for (const Laser& laser : {Laser{0, -25.0, -1.4, 0.0},
                             {17, -1.0, 4.2, 0.0},
                             {15, -1.667, -1.4, 2.304},
                             {1, -15.639, 1.4, 2.304},
                             {31, 15.0, 1.4, 32.256},
                             {16, -1.333, 1.4, 34.56}}) {
    const auto found = std::ranges::find(scan.points, laser.ring, &Point::ring);
    ASSERT_NE(found, scan.points.end());
    EXPECT_NEAR(found->position.norm(), 10.0, 1e-5);
    EXPECT_NEAR(elevation_deg(*found), laser.elevation_deg, 1e-3) << laser.ring;
    EXPECT_NEAR(found->dt_ns, 1e3 * laser.us, 1.0) << laser.ring;
    const double azimuth =
        std::atan2(found->position.y(), found->position.x()) * 180.0 / std::numbers::pi;
    EXPECT_NEAR(azimuth, -90.0 - 0.2 * laser.us / 55.296 + laser.offset_deg, 1e-3) << laser.ring;
  }
  EXPECT_NEAR(scan.points.back().dt_ns, 1e3 * (11 * 55.296 + 34.56), 1.0);
}

TEST(VelodyneScans, OfTheHdl32eHaveTheAnglesAndTimesOfItsManual) {
  const Scan scan = scan_of(velodyne_packet(0x21, 2500));  // 5 m by units of 2 mm
  ASSERT_EQ(scan.points.size(), 12U * 32U);
  for (int firing = 0; firing < 32; ++firing) {  // one after the other, 1.152 us apart
    const Point& point = scan.points[static_cast<std::size_t>(firing)];
    EXPECT_NEAR(point.position.norm(), 5.0, 1e-5);
    EXPECT_NEAR(point.dt_ns, 1152.0 * firing, 1.0);
    const double expected = (firing % 2 == 0 ? -30.667 : -9.333) + 4.0 / 3.0 * (firing / 2);
    EXPECT_NEAR(elevation_deg(point), expected, 1e-2);
  }
  EXPECT_NEAR(scan.points[32].dt_ns, 46080.0, 1.0);
}

TEST(VelodyneScans, AnotherModelIsRefused) {
  VelodyneScans scans("a.pcap");
  std::string packet(kVelodynePacket, '\0');
  packet[1205] = '\x23';
  EXPECT_THAT(input_error([&] { scans.push(Time{0}, std::as_bytes(std::span(packet))); }),
              HasSubstr("model 0x23"));
}

}  // namespace
}  // namespace lidarena::dataset
