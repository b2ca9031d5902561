// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/scan.hpp"
#include "lidarena/dataset/messages/message_stream.hpp"

namespace lidarena::dataset {

/// Size of the content of a Velodyne's data packet.
inline constexpr std::size_t kVelodynePacket = 1206;

/// Decodes data packets of Velodyne's VLP-16 and Puck Hi-Res ("VLP-16 User Manual", 63-9243 rev. E,
/// chapters 6 and 9), VLP-32C ("VLP-32C User Manual", 63-9325) and HDL-32E ("HDL-32E User Manual",
/// 63-9113): x forward (azimuth 0), y left, z up. In a packet with two returns per shot,
/// the second (the last return) is echo 1 where it differs from the strongest. Intensity is the
/// calibrated reflectivity.
class VelodyneScans {
 public:
  /// `place` names the source in messages.
  explicit VelodyneScans(std::string place) : place_(std::move(place)) {}

  /// Takes a packet of 1206 bytes that was received at `received`. Returns the scan before when the
  /// head has passed azimuth 0 within this packet (unless `whole` packets make a scan). Throws
  /// InputError for another model.
  std::optional<Scan> push(Time received, Bytes packet, bool whole = false);
  /// The last scan, if it has shots.
  std::optional<Scan> finish();

 private:
  struct Shot {
    Time time{0};
    Point point;
  };
  void add_block(Bytes packet, std::size_t block, Time packet_time);

  std::string place_;
  std::optional<Time> hour_;  ///< when the sensor's microseconds were 0
  Time latest_{0};            ///< of the last packet
  int last_azimuth_ = -1;     ///< hundredths of a degree
  std::optional<Time> first_;
  std::vector<Shot> shots_;
};

/// Whether `type` (as spelled in ROS 2) is the message of Velodyne's driver with packets.
bool is_velodyne_type(std::string_view type);

/// Decodes a VelodyneScan: the packets of one revolution. The stamp is that of the first packet.
Scan decode_velodyne(Bytes message, std::string_view place, Encoding encoding);

}  // namespace lidarena::dataset
