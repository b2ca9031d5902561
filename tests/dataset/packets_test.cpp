// SPDX-License-Identifier: BSD-3-Clause
// Packets of LiDARs in captures and messages.
#include <gmock/gmock.h>

#include <cmath>

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
  EXPECT_THAT(error(std::string("\x0a\x0d\x0d\x0a", 4) + std::string(40, '\0')),
              HasSubstr("editcap -F pcap"));
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

TEST(VelodyneScans, AnotherModelIsRefused) {
  VelodyneScans scans("a.pcap");
  std::string packet(kVelodynePacket, '\0');
  packet[1205] = '\x21';
  EXPECT_THAT(input_error([&] { scans.push(Time{0}, std::as_bytes(std::span(packet))); }),
              HasSubstr("model 0x21"));
}

}  // namespace
}  // namespace lidarena::dataset
