// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/packets/velodyne_packets.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/firing_order.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/packets/packet_field.hpp"

namespace lidarena::dataset {
namespace {

constexpr std::size_t kBlocks = 12;
constexpr std::size_t kBlockBytes = 100;
constexpr std::size_t kLasers = 16;
constexpr std::uint16_t kBlockFlag = 0xEEFF;  // bytes FF EE
constexpr double kFiring_us = 55.296;         // of all 16 lasers
constexpr double kLaser_us = 2.304;           // from one to the next
constexpr double kRangeUnit_m = 0.002;
constexpr std::uint8_t kDualReturn = 0x39;
constexpr int kTurn = 36000;  // hundredths of a degree
constexpr std::int64_t kHour_us = 3'600'000'000;

enum Model : std::uint8_t { kVlp16 = 0x22, kPuckHiRes = 0x24 };

/// Elevation of a laser, in the order of firing: from below and from the middle in turn.
double elevation_deg(std::uint8_t model, std::size_t laser) {
  const int step = static_cast<int>(laser % 2 == 0 ? laser / 2 : 8 + laser / 2);  // from below
  return model == kPuckHiRes ? -10.0 + 4.0 / 3.0 * step : -15.0 + 2.0 * step;
}

/// Height of a laser above the optical center; -15 degrees: 11.2 mm, 15 degrees: -11.2 mm.
double height_m(std::uint8_t model, std::size_t laser) {
  constexpr std::array kVlp{11.2, 9.7, 8.1, 6.6, 5.1, 3.7, 2.2, 0.7};
  constexpr std::array kHiRes{7.4, 6.5, 5.4, 4.4, 3.4, 2.5, 1.5, 0.5};
  const std::size_t step = laser % 2 == 0 ? laser / 2 : 8 + laser / 2;
  const auto& heights = model == kPuckHiRes ? kHiRes : kVlp;
  return 1e-3 * (step < 8 ? heights[step] : -heights[15 - step]);
}

int azimuth_of(Bytes packet, std::size_t block) {
  return at<std::uint16_t>(packet, block * kBlockBytes + 2);
}

bool is_dual(Bytes packet) { return at<std::uint8_t>(packet, 1204) == kDualReturn; }

/// By how much the head turns during a block, hundredths of a degree.
double turn_per_block(Bytes packet) {
  const std::size_t step = is_dual(packet) ? 2 : 1;
  const int turned = azimuth_of(packet, kBlocks - step) - azimuth_of(packet, 0);
  return static_cast<double>((turned + kTurn) % kTurn) /
         (static_cast<double>(kBlocks / step) - 1.0);
}

}  // namespace

void VelodyneScans::add_block(Bytes packet, std::size_t block, Time packet_time) {
  const auto model = at<std::uint8_t>(packet, 1205);
  const std::size_t begin = block * kBlockBytes;
  const bool dual = is_dual(packet);
  const bool is_second = dual && block % 2 == 1;
  const double first_us = 2.0 * kFiring_us * static_cast<double>(dual ? block / 2 : block);
  const double per_us = turn_per_block(packet) / (2.0 * kFiring_us);
  for (std::size_t shot = 0; shot < 2 * kLasers; ++shot) {
    const std::size_t value = begin + 4 + 3 * shot;
    const auto range = at<std::uint16_t>(packet, value);
    if (range == 0) continue;
    // the block before has the other return of the same shot
    if (is_second && at<std::uint16_t>(packet, value - kBlockBytes) == range) continue;
    const std::size_t laser = shot % kLasers;
    const double us =
        kFiring_us * static_cast<double>(shot / kLasers) + kLaser_us * static_cast<double>(laser);
    const double azimuth =
        (azimuth_of(packet, block) + per_us * us) * std::numbers::pi / (kTurn / 2.0);
    const double elevation = elevation_deg(model, laser) * std::numbers::pi / 180.0;
    const double flat = kRangeUnit_m * range * std::cos(elevation);
    const Eigen::Vector3d position(
        flat * std::cos(azimuth), -flat * std::sin(azimuth),
        kRangeUnit_m * range * std::sin(elevation) + height_m(model, laser));
    const auto ring = static_cast<std::uint16_t>(laser % 2 == 0 ? laser / 2 : 8 + laser / 2);
    const auto reflectivity = static_cast<float>(at<std::uint8_t>(packet, value + 2));
    shots_.push_back({packet_time + Time{std::llround(1e3 * (first_us + us))},
                      {position.cast<float>(), reflectivity, 0, ring,
                       static_cast<std::uint8_t>(is_second ? 1 : 0)}});
  }
}

std::optional<Scan> VelodyneScans::push(Time received, Bytes packet, bool whole) {
  const auto model = at<std::uint8_t>(packet, 1205);
  if (model != kVlp16 && model != kPuckHiRes) {
    throw InputError(place_, fmt::format("its packets are of the Velodyne model 0x{:02x}", model),
                     "read are those of the VLP-16 (0x22) and the Puck Hi-Res (0x24); record the "
                     "PointCloud2 of the driver");
  }
  const Time since_hour = std::chrono::microseconds(at<std::uint32_t>(packet, 1200));
  if (!hour_) hour_ = received - since_hour;
  while (*hour_ + since_hour < latest_ - std::chrono::minutes(30))
    *hour_ += std::chrono::microseconds(kHour_us);
  latest_ = *hour_ + since_hour;
  std::optional<Scan> done;
  for (std::size_t block = 0; block < kBlocks; ++block) {
    if (at<std::uint16_t>(packet, block * kBlockBytes) != kBlockFlag) continue;
    const int azimuth = azimuth_of(packet, block);
    if (!whole && azimuth < last_azimuth_ - kTurn / 2 && !shots_.empty()) done = finish();
    last_azimuth_ = azimuth;
    if (!first_) first_ = latest_;
    add_block(packet, block, latest_);
  }
  return done;
}

std::optional<Scan> VelodyneScans::finish() {
  if (!first_) return std::nullopt;
  Scan scan{shots_.empty() ? *first_ : shots_.front().time, {}, true};
  for (const Shot& shot : shots_) scan.stamp = std::min(scan.stamp, shot.time);
  for (Shot& shot : shots_) {
    const std::int64_t dt = (shot.time - scan.stamp).count();
    if (dt > std::numeric_limits<std::int32_t>::max()) continue;  // a packet of another time
    shot.point.dt_ns = static_cast<std::int32_t>(dt);
    scan.points.push_back(shot.point);
  }
  sort_in_firing_order(scan.points);
  shots_.clear();
  first_.reset();
  return scan;
}

bool is_velodyne_type(std::string_view type) { return type == "velodyne_msgs/msg/VelodyneScan"; }

Scan decode_velodyne(Bytes message, std::string_view place, Encoding encoding) {
  MessageReader in(message, place, encoding);
  const ros::MessageHeader header = ros::get_header(in);
  VelodyneScans scans{std::string(place)};
  const std::uint32_t count = in.get_length(kVelodynePacket + 8);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::chrono::seconds seconds{in.get<std::int32_t>()};
    const Time stamp = seconds + Time{in.get<std::uint32_t>()};
    scans.push(stamp, in.get_bytes(kVelodynePacket), true);
  }
  return scans.finish().value_or(Scan{header.stamp, {}, true});
}

}  // namespace lidarena::dataset
