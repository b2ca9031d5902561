// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/cdr.hpp"

/// Our values as ROS 2 messages and back. Encoders start a new message in `out`; decoders throw
/// InputError (place `place`) when a message is broken.
namespace lidarena::ros2 {

inline constexpr std::string_view kPointCloud2 = "sensor_msgs/msg/PointCloud2";
inline constexpr std::string_view kImu = "sensor_msgs/msg/Imu";
inline constexpr std::string_view kOdometry = "nav_msgs/msg/Odometry";
inline constexpr std::string_view kTfMessage = "tf2_msgs/msg/TFMessage";

/// The definition of `type` (one of the above) and of all types it uses, in the "ros2msg" form: the
/// others follow after lines of 80 '=' and "MSG: NAME".
std::string definition_of(std::string_view type);

/// header.stamp is the first firing. 24 bytes a point, as they lie in memory: x y z intensity
/// float32, t uint32 (ns since header.stamp), ring uint16, echo uint8; names and types as the
/// Ouster driver's where it has them. A scan without times has no field t. Throws InputError when a
/// point lies before the stamp or the stamp does not fit (int32 seconds).
void encode_scan(const Scan& scan, std::string_view frame_id, CdrWriter& out);
/// Reads that layout exactly, and other PointCloud2 layouts as point_cloud2.hpp says.
Scan decode_scan(Bytes message, std::string_view place);

/// No orientation (first covariance -1), other covariances 0 (unknown).
void encode_imu(const ImuSample& sample, std::string_view frame_id, CdrWriter& out);
ImuSample decode_imu(Bytes message, std::string_view place);

/// Pose alone: twist and covariances are 0.
void encode_odometry(const StampedPose& pose, std::string_view frame_id,
                     std::string_view child_frame_id, CdrWriter& out);
StampedPose decode_odometry(Bytes message, std::string_view place);

struct StampedTransform {
  Time stamp{0};
  std::string parent;
  std::string child;
  Pose parent_from_child = Pose::Identity();
};
void encode_transforms(std::span<const StampedTransform> transforms, CdrWriter& out);
std::vector<StampedTransform> decode_transforms(Bytes message, std::string_view place);

/// std_msgs/msg/Header.
struct MessageHeader {
  Time stamp{0};
  std::string frame_id;
};
void put_header(Time stamp, std::string_view frame_id, CdrWriter& out);
MessageHeader get_header(CdrReader& in);

}  // namespace lidarena::ros2
