// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/packets/velodyne_packets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/firing_order.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/packets/packet_field.hpp"

namespace lidarena::dataset {
namespace {

constexpr std::size_t kBlocks = 12;
constexpr std::size_t kBlockBytes = 100;
constexpr std::size_t kShots = 32;            // of a block
constexpr std::uint16_t kBlockFlag = 0xEEFF;  // bytes FF EE
constexpr std::uint8_t kDualReturn = 0x39;
constexpr int kTurn = 36000;  // hundredths of a degree
constexpr std::int64_t kHour_us = 3'600'000'000;

enum ModelId : std::uint8_t { kHdl32e = 0x21, kVlp16 = 0x22, kPuckHiRes = 0x24, kVlp32c = 0x28 };

/// How a model fires. Blocks have one or two cycles.
struct Model {
  ModelId id;
  std::size_t lasers;
  std::size_t at_once;  ///< lasers that fire together
  double cycle_us;      ///< of all lasers
  double next_us;       ///< until the next lasers fire
  double range_unit_m;
};
constexpr std::array kModels{
    Model{kHdl32e, 32, 1, 46.08, 1.152, 0.002}, Model{kVlp16, 16, 1, 55.296, 2.304, 0.002},
    Model{kPuckHiRes, 16, 1, 55.296, 2.304, 0.002}, Model{kVlp32c, 32, 2, 55.296, 2.304, 0.004}};

const Model* model_of(Bytes packet) {
  const auto* found = std::ranges::find(kModels, at<std::uint8_t>(packet, 1205), &Model::id);
  return found == kModels.end() ? nullptr : found;
}

/// Elevation and azimuth offset (clockwise) of the VLP-32C's lasers in the order of firing,
/// degrees.
constexpr std::array<std::pair<double, double>, 32> kLasersOfVlp32c{
    {{-25.0, 1.4},  {-1.0, -4.2},   {-1.667, 1.4}, {-15.639, -1.4}, {-11.31, 1.4}, {0.0, -1.4},
     {-0.667, 4.2}, {-8.843, -1.4}, {-7.254, 1.4}, {0.333, -4.2},   {-0.333, 1.4}, {-6.148, -1.4},
     {-5.333, 4.2}, {1.333, -1.4},  {0.667, 4.2},  {-4.0, -1.4},    {-4.667, 1.4}, {1.667, -4.2},
     {1.0, 1.4},    {-3.667, -4.2}, {-3.333, 4.2}, {3.333, -1.4},   {2.333, 1.4},  {-2.667, -1.4},
     {-3.0, 1.4},   {7.0, -1.4},    {4.667, 1.4},  {-2.333, -4.2},  {-2.0, 4.2},   {15.0, -1.4},
     {10.333, 1.4}, {-1.333, -1.4}}};

/// Number of a laser, counted from below. The others fire from below and from the middle in turn.
std::size_t ring_of(const Model& model, std::size_t laser) {
  if (model.id != kVlp32c) return laser % 2 == 0 ? laser / 2 : (model.lasers + laser) / 2;
  return static_cast<std::size_t>(std::ranges::count_if(kLasersOfVlp32c, [&](const auto& other) {
    return other.first < kLasersOfVlp32c[laser].first;
  }));
}

double elevation_deg(const Model& model, std::size_t laser) {
  const auto ring = static_cast<double>(ring_of(model, laser));
  switch (model.id) {
    case kHdl32e:
      return (-92.0 + 4.0 * ring) / 3.0;
    case kPuckHiRes:
      return -10.0 + 4.0 / 3.0 * ring;
    case kVlp32c:
      return kLasersOfVlp32c[laser].first;
    case kVlp16:
      break;
  }
  return -15.0 + 2.0 * ring;
}

/// Height of a laser above the optical center; of the VLP-16 11.2 mm at -15 degrees, -11.2 mm
/// at 15.
double height_m(const Model& model, std::size_t laser) {
  if (model.lasers != 16) return 0.0;
  constexpr std::array kVlp{11.2, 9.7, 8.1, 6.6, 5.1, 3.7, 2.2, 0.7};
  constexpr std::array kHiRes{7.4, 6.5, 5.4, 4.4, 3.4, 2.5, 1.5, 0.5};
  const std::size_t ring = ring_of(model, laser);
  const auto& heights = model.id == kPuckHiRes ? kHiRes : kVlp;
  return 1e-3 * (ring < 8 ? heights[ring] : -heights[15 - ring]);
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
  const Model& model = *model_of(packet);
  const std::size_t begin = block * kBlockBytes;
  const bool dual = is_dual(packet);
  const bool is_second = dual && block % 2 == 1;
  const double block_us = model.cycle_us * static_cast<double>(kShots / model.lasers);
  const double first_us = block_us * static_cast<double>(dual ? block / 2 : block);
  const double per_us = turn_per_block(packet) / block_us;
  for (std::size_t shot = 0; shot < kShots; ++shot) {
    const std::size_t value = begin + 4 + 3 * shot;
    const auto range = at<std::uint16_t>(packet, value);
    if (range == 0) continue;
    // the block before has the other return of the same shot
    if (is_second && at<std::uint16_t>(packet, value - kBlockBytes) == range) continue;
    const std::size_t laser = shot % model.lasers;
    const double us = model.cycle_us * static_cast<double>(shot / model.lasers) +
                      model.next_us * static_cast<double>(laser / model.at_once);
    const double offset = model.id == kVlp32c ? 100.0 * kLasersOfVlp32c[laser].second : 0.0;
    const double azimuth =
        (azimuth_of(packet, block) + per_us * us + offset) * std::numbers::pi / (kTurn / 2.0);
    const double elevation = elevation_deg(model, laser) * std::numbers::pi / 180.0;
    const double distance = model.range_unit_m * range;
    const double flat = distance * std::cos(elevation);
    const Eigen::Vector3d position(flat * std::cos(azimuth), -flat * std::sin(azimuth),
                                   distance * std::sin(elevation) + height_m(model, laser));
    const auto reflectivity = static_cast<float>(at<std::uint8_t>(packet, value + 2));
    shots_.push_back({packet_time + Time{std::llround(1e3 * (first_us + us))},
                      {position.cast<float>(), reflectivity, 0,
                       static_cast<std::uint16_t>(ring_of(model, laser)),
                       static_cast<std::uint8_t>(is_second ? 1 : 0)}});
  }
}

std::optional<Scan> VelodyneScans::push(Time received, Bytes packet, bool whole) {
  if (model_of(packet) == nullptr) {
    throw InputError(place_,
                     fmt::format("its packets are of the Velodyne model 0x{:02x}",
                                 at<std::uint8_t>(packet, 1205)),
                     "read are those of the HDL-32E (0x21), the VLP-16 (0x22), the Puck Hi-Res "
                     "(0x24) and the VLP-32C (0x28); record the PointCloud2 of the driver");
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
