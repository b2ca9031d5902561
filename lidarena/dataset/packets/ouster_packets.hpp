// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/dataset/byte_stream.hpp"
#include "lidarena/dataset/packets/ouster_metadata.hpp"

namespace lidarena::dataset {

/// Makes scans of the LiDAR packets of an Ouster, as its "Software User Manual" (firmware 3.1,
/// sections "LiDAR Data Packet Format" and "Range to XYZ") describes them. Points are in the
/// LiDAR's frame, the reflectivity is the intensity, the second return of a dual packet is echo 1.
/// Times are those of the sensor's clock.
class OusterScans {
 public:
  explicit OusterScans(OusterMetadata metadata);

  /// Size of a LiDAR packet, bytes.
  std::size_t packet_bytes() const;
  /// Takes a packet of that size. Returns the scan before when this packet begins another one.
  std::optional<Scan> push(Bytes packet);
  /// The last scan, if it has columns.
  std::optional<Scan> finish();

 private:
  struct Column {
    Time time{0};
    std::uint16_t measurement = 0;
    std::uint16_t frame = 0;
    bool is_valid = false;
    Bytes pixels;
  };
  Column column_at(Bytes packet, std::size_t index) const;
  void add(const Column& column);
  void add_return(const Column& column, std::size_t row, std::uint32_t range_mm, float reflectivity,
                  std::uint8_t echo);

  OusterMetadata meta_;
  std::vector<Eigen::Vector3d> outwards_;  ///< by column: unit vectors of the encoder's angle
  std::optional<std::uint16_t> frame_;
  std::optional<Time> first_;
  std::vector<std::pair<Time, Point>> points_;
};

/// An IMU packet: stamp (of the accelerometer), m/s^2, rad/s. Empty when it has another size.
std::optional<ImuSample> ouster_imu_sample(Bytes packet);

}  // namespace lidarena::dataset
