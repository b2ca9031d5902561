// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/dataset/messages/message_stream.hpp"

/// Scans and IMU samples as the manufacturers' ROS drivers publish them. Encoders start a new
/// message in `out`.
namespace lidarena::dataset {

enum class Driver { kUnknown, kLivox, kOuster };

/// By the name of the model: livox_..., ouster_....
Driver driver_of(const LidarInfo& lidar);

/// Message type of CustomMsg: that of livox_ros_driver2 (Mid-360, HAP, and all models in ROS 2), or
/// that of livox_ros_driver (first-generation models in ROS 1).
std::string_view livox_type(const LidarInfo& lidar, Encoding encoding);

/// CustomMsg: header.stamp and timebase are the scan's stamp, offset_time is ns since then, line
/// the ring, reflectivity the intensity rounded to 0..255, tag 0 (first generation: 0x10 for the
/// first return). As in the drivers' messages, shots without a return are included as (0, 0, 0),
/// provided that the point times match rows, columns and rate of `lidar`.
void encode_livox_custom(const Scan& scan, const LidarInfo& lidar, std::string_view frame_id,
                         MessageWriter& out);

/// PointCloud2 of driver 2, 26 bytes per point: x y z intensity float32, tag uint8, line uint8,
/// timestamp float64 (absolute, ns: exact up to 104 days from 0, to 256 ns at present-day epoch
/// times). For the first generation the 18 bytes per point of driver 1, which have no times.
void encode_livox_cloud(const Scan& scan, const LidarInfo& lidar, std::string_view frame_id,
                        MessageWriter& out);

/// PointCloud2 of ouster-ros, point type "original", 48 bytes per point: x y z at 0, 4, 8;
/// intensity float32 16; t uint32 20 (ns since header.stamp, the first column's time);
/// reflectivity, ring, ambient uint16 24, 26, 28; range uint32 32 (mm). Organized as rows x columns
/// and destaggered: the column of a point is that of its direction. Pixels without a return are NaN
/// with range 0. If a pixel has several returns, the first is kept. Without times, or when `lidar`
/// lacks rows, columns or pixel shifts, the points form one row in their given order.
void encode_ouster_cloud(const Scan& scan, const LidarInfo& lidar, std::string_view frame_id,
                         MessageWriter& out);

/// Livox: acceleration in g, all covariances 0. Ouster: SI, variances 0.01 (m/s^2)^2 and 6e-4
/// (rad/s)^2, no orientation (-1). Unknown: ros::encode_imu.
void encode_driver_imu(const ImuSample& sample, Driver driver, std::string_view frame_id,
                       MessageWriter& out);

}  // namespace lidarena::dataset
