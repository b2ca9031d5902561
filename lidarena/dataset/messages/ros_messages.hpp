// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/point_truth.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/messages/message_stream.hpp"

/// Conversion of Lidarena's types to and from messages of ROS 2 or ROS 1 (whose types differ only
/// in the header). Encoders start a new message in `out`; decoders throw InputError (place `place`)
/// when a message is damaged.
namespace lidarena::dataset::ros {

// Names as ROS 2 spells them; ROS 1 leaves out "msg/".

inline constexpr std::string_view kPointCloud2 = "sensor_msgs/msg/PointCloud2";
inline constexpr std::string_view kImu = "sensor_msgs/msg/Imu";
inline constexpr std::string_view kOdometry = "nav_msgs/msg/Odometry";
inline constexpr std::string_view kTfMessage = "tf2_msgs/msg/TFMessage";
inline constexpr std::string_view kPath = "nav_msgs/msg/Path";
inline constexpr std::string_view kClock = "rosgraph_msgs/msg/Clock";

inline constexpr std::string_view kString = "std_msgs/msg/String";

/// Converts "sensor_msgs/msg/Imu" to "sensor_msgs/Imu", and back.
std::string ros1_name(std::string_view type);
std::string ros2_name(std::string_view type);

/// Whether messages of this type can be written to a recording.
bool has_definition(std::string_view type);
/// The definition of `type` (one of those that can be written) and of all types it uses, in the
/// "ros2msg" or "ros1msg" form: each used type follows a line of 80 '=' and a line "MSG: NAME".
std::string definition_of(std::string_view type, Encoding encoding = Encoding::kCdr);
/// The checksum by which ROS 1 identifies a type: MD5 of its members, with message types replaced
/// by their own checksums.
std::string ros1_md5_of(std::string_view type);

/// header.stamp is the first firing. 24 bytes per point, the memory layout of Point: x y z
/// intensity float32, t uint32 (ns since header.stamp), ring uint16, echo uint8; names and types as
/// in the Ouster driver where it has these fields. A scan without times has no field t. Throws
/// InputError when a point is earlier than the stamp or the stamp does not fit (int32 seconds).
void encode_scan(const Scan& scan, std::string_view frame_id, MessageWriter& out);
/// Reads that layout exactly, and other PointCloud2 layouts as described in point_cloud2.hpp.
Scan decode_scan(Bytes message, std::string_view place, Encoding encoding = Encoding::kCdr);

/// Ground truth of a scan's points, as a PointCloud2 of 32 bytes per point: x y z (world, m), range
/// (m), nx ny nz (world) float32, triangle uint32; in point order, with the stamp of the scan.
void encode_scan_truth(const ScanTruth& truth, std::string_view frame_id, MessageWriter& out);
/// Reads only that layout; the caller fills in the id of the sensor.
ScanTruth decode_scan_truth(Bytes message, std::string_view place,
                            Encoding encoding = Encoding::kCdr);

/// Elements of the diagonals of the covariances (of orientation only the first): -1 = no
/// orientation, 0 = covariance unknown.
struct ImuVariances {
  double orientation = -1.0;
  double angular_velocity = 0.0;
  double acceleration = 0.0;
};
void encode_imu(const ImuSample& sample, std::string_view frame_id, MessageWriter& out,
                const ImuVariances& variances = {});
ImuSample decode_imu(Bytes message, std::string_view place, Encoding encoding = Encoding::kCdr);

/// Only the pose: twist and covariances are 0.
/// What an Odometry message says besides its pose.
struct OdometryFrames {
  std::string_view frame_id;
  std::string_view child_frame_id;
  /// Of (translation, rotation), m and rad, along the axes of `frame_id`; unknown: zeros.
  std::optional<Eigen::Matrix<double, 6, 6>> covariance{};
};
void encode_odometry(const StampedPose& pose, const OdometryFrames& frames, MessageWriter& out);
StampedPose decode_odometry(Bytes message, std::string_view place,
                            Encoding encoding = Encoding::kCdr);

struct StampedTransform {
  Time stamp{0};
  std::string parent;
  std::string child;
  Pose parent_from_child = Pose::Identity();
};
void encode_transforms(std::span<const StampedTransform> transforms, MessageWriter& out);
std::vector<StampedTransform> decode_transforms(Bytes message, std::string_view place,
                                                Encoding encoding = Encoding::kCdr);

void encode_clock(Time time, MessageWriter& out);

void encode_string(std::string_view text, MessageWriter& out);
std::string decode_string(Bytes message, std::string_view place,
                          Encoding encoding = Encoding::kCdr);

/// builtin_interfaces/msg/Time. Throws InputError (place `place`) when it does not fit.
void put_time(Time time, std::string_view place, MessageWriter& out);
/// std_msgs/msg/Header. In ROS 1 a sequence number precedes it, written as 0 and ignored when read.
struct MessageHeader {
  Time stamp{0};
  std::string frame_id;
};
void put_header(Time stamp, std::string_view frame_id, MessageWriter& out);
MessageHeader get_header(MessageReader& in);

}  // namespace lidarena::dataset::ros
