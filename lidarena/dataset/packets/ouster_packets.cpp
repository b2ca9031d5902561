// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/packets/ouster_packets.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "lidarena/dataset/firing_order.hpp"
#include "lidarena/dataset/imu_units.hpp"
#include "lidarena/dataset/packets/packet_field.hpp"

namespace lidarena::dataset {
namespace {

/// Sizes of a profile's parts, bytes.
struct Layout {
  std::size_t packet_header, column_header, pixel, column_footer, packet_footer;
};

Layout layout_of(OusterProfile profile) {
  switch (profile) {
    case OusterProfile::kLegacy:
      return {0, 16, 12, 4, 0};
    case OusterProfile::kSingle:
      return {32, 12, 12, 0, 32};
    case OusterProfile::kDual:
      return {32, 12, 16, 0, 32};
    case OusterProfile::kLowRate:
      return {32, 12, 4, 0, 32};
  }
  return {};
}

}  // namespace

OusterScans::OusterScans(OusterMetadata metadata) : meta_(std::move(metadata)) {
  for (int column = 0; column < meta_.columns_per_frame; ++column) {
    const double encoder =
        2.0 * std::numbers::pi * (1.0 - static_cast<double>(column) / meta_.columns_per_frame);
    outwards_.emplace_back(std::cos(encoder), std::sin(encoder), encoder);
  }
}

std::size_t OusterScans::packet_bytes() const {
  const Layout layout = layout_of(meta_.profile);
  const std::size_t column =
      layout.column_header + meta_.rows() * layout.pixel + layout.column_footer;
  return layout.packet_header + static_cast<std::size_t>(meta_.columns_per_packet) * column +
         layout.packet_footer;
}

OusterScans::Column OusterScans::column_at(Bytes packet, std::size_t index) const {
  const Layout layout = layout_of(meta_.profile);
  const std::size_t pixels = meta_.rows() * layout.pixel;
  const std::size_t size = layout.column_header + pixels + layout.column_footer;
  const Bytes bytes = packet.subspan(layout.packet_header + index * size, size);
  Column column;
  column.time = Time{static_cast<std::int64_t>(at<std::uint64_t>(bytes, 0))};
  column.measurement = at<std::uint16_t>(bytes, 8);
  column.pixels = bytes.subspan(layout.column_header, pixels);
  if (meta_.profile == OusterProfile::kLegacy) {
    column.frame = at<std::uint16_t>(bytes, 10);
    column.is_valid = at<std::uint32_t>(bytes, size - 4) == 0xFFFFFFFF;
  } else {
    column.frame = at<std::uint16_t>(packet, 2);
    column.is_valid = (at<std::uint16_t>(bytes, 10) & 1) != 0;
  }
  column.is_valid =
      column.is_valid && column.measurement < outwards_.size() && column.time >= Time{0};
  return column;
}

std::optional<Scan> OusterScans::push(Bytes packet) {
  std::optional<Scan> done;
  for (std::size_t i = 0; i < static_cast<std::size_t>(meta_.columns_per_packet); ++i) {
    const Column column = column_at(packet, i);
    if (!column.is_valid) continue;
    if (frame_ && *frame_ != column.frame) done = finish();
    frame_ = column.frame;
    add(column);
  }
  return done;
}

std::optional<Scan> OusterScans::finish() {
  if (!first_) return std::nullopt;
  Scan scan{*first_, {}, true};
  for (auto& [time, point] : points_) {
    const std::int64_t dt = (time - scan.stamp).count();
    if (dt < 0 || dt > std::numeric_limits<std::int32_t>::max()) continue;  // a clock was set
    point.dt_ns = static_cast<std::int32_t>(dt);
    scan.points.push_back(point);
  }
  sort_in_firing_order(scan.points);
  points_.clear();
  first_.reset();
  return scan;
}

void OusterScans::add(const Column& column) {
  first_ = first_ ? std::min(*first_, column.time) : column.time;
  const std::size_t pixel = layout_of(meta_.profile).pixel;
  for (std::size_t row = 0; row < meta_.rows(); ++row) {
    const Bytes bytes = column.pixels.subspan(row * pixel, pixel);
    const auto word = at<std::uint32_t>(bytes, 0);
    switch (meta_.profile) {
      case OusterProfile::kLegacy:
        add_return(column, row, word & 0xFFFFF, at<std::uint8_t>(bytes, 4), 0);
        break;
      case OusterProfile::kSingle:
        add_return(column, row, word & 0x7FFFF, at<std::uint8_t>(bytes, 4), 0);
        break;
      case OusterProfile::kDual:
        add_return(column, row, word & 0x7FFFF, at<std::uint8_t>(bytes, 3), 0);
        add_return(column, row, at<std::uint32_t>(bytes, 4) & 0x7FFFF, at<std::uint8_t>(bytes, 7),
                   1);
        break;
      case OusterProfile::kLowRate:  // in steps of 8 mm
        add_return(column, row, 8 * (word & 0x7FFF), at<std::uint8_t>(bytes, 2), 0);
        break;
    }
  }
}

/// The beam leaves a circle around the axis; its range counts from the axis.
void OusterScans::add_return(const Column& column, std::size_t row, std::uint32_t range_mm,
                             float reflectivity, std::uint8_t echo) {
  if (range_mm == 0) return;
  const Eigen::Vector3d& encoder = outwards_[column.measurement];
  const double length = 1e-3 * range_mm - meta_.beam_origin_m.norm();
  const double azimuth = encoder.z() - meta_.azimuth_rad[row];
  const double flat = length * std::cos(meta_.altitude_rad[row]);
  const Eigen::Vector3d position(
      flat * std::cos(azimuth) + meta_.beam_origin_m.x() * encoder.x(),
      flat * std::sin(azimuth) + meta_.beam_origin_m.x() * encoder.y(),
      length * std::sin(meta_.altitude_rad[row]) + meta_.beam_origin_m.y());
  points_.emplace_back(column.time, Point{position.cast<float>(), reflectivity, 0,
                                          static_cast<std::uint16_t>(row), echo});
}

std::optional<ImuSample> ouster_imu_sample(Bytes packet) {
  constexpr std::size_t kSize = 48;
  if (packet.size() != kSize) return std::nullopt;
  const auto vector = [&](std::size_t offset) {
    return Eigen::Vector3d(at<float>(packet, offset), at<float>(packet, offset + 4),
                           at<float>(packet, offset + 8));
  };
  ImuSample sample;
  sample.stamp = Time{static_cast<std::int64_t>(at<std::uint64_t>(packet, 8))};
  sample.accel = kStandardGravity * vector(24);
  sample.gyro = std::numbers::pi / 180.0 * vector(36);
  return sample;
}

}  // namespace lidarena::dataset
