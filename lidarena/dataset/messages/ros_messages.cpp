// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/messages/ros_messages.hpp"

#include <limits>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/messages/point_cloud2.hpp"

namespace lidarena::dataset::ros {
namespace {

constexpr std::size_t kCovariance3 = 9;   // doubles of a 3 x 3 covariance
constexpr std::size_t kCovariance6 = 36;  // and of a 6 x 6 one

void put_vector(const Eigen::Vector3d& v, MessageWriter& out) {
  for (const double value : {v.x(), v.y(), v.z()}) out.put(value);
}

/// A 3 x 3 matrix with `value` on its diagonal.
void put_diagonal(double value, MessageWriter& out) {
  for (int i = 0; i < 9; ++i) out.put(i % 4 == 0 ? value : 0.0);
}

Eigen::Vector3d get_vector(MessageReader& in) {
  Eigen::Vector3d v;
  for (int i = 0; i < 3; ++i) v[i] = in.get<double>();
  return v;
}

/// Position (or translation), then the quaternion x y z w.
void put_pose(const Pose& pose, MessageWriter& out) {
  put_vector(pose.translation(), out);
  const Eigen::Quaterniond q(pose.linear());
  for (const double value : {q.x(), q.y(), q.z(), q.w()}) out.put(value);
}

Pose get_pose(MessageReader& in) {
  const Eigen::Vector3d translation = get_vector(in);
  Eigen::Quaterniond q;
  for (double* value : {&q.x(), &q.y(), &q.z(), &q.w()}) *value = in.get<double>();
  return make_pose(q, translation);
}

}  // namespace

void put_time(Time time, std::string_view place, MessageWriter& out) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  const bool is_ros1 = out.encoding() == Encoding::kRos1;  // has unsigned seconds
  const std::int64_t min_seconds = is_ros1 ? 0 : std::numeric_limits<std::int32_t>::min();
  if (seconds.count() > std::numeric_limits<std::int32_t>::max() || seconds.count() < min_seconds) {
    throw InputError(place, "a time does not fit into the 32-bit seconds of ROS messages");
  }
  out.put(static_cast<std::int32_t>(seconds.count()));
  out.put(static_cast<std::uint32_t>((time - seconds).count()));
}

void put_header(Time stamp, std::string_view frame_id, MessageWriter& out) {
  if (out.encoding() == Encoding::kRos1) out.put(std::uint32_t{0});  // seq
  put_time(stamp, frame_id, out);
  out.put(frame_id);
}

MessageHeader get_header(MessageReader& in) {
  if (in.encoding() == Encoding::kRos1) in.get<std::uint32_t>();  // seq
  const std::chrono::seconds seconds{in.get<std::int32_t>()};
  const Time nanoseconds{in.get<std::uint32_t>()};
  return {seconds + nanoseconds, in.get_string()};
}

void encode_scan(const Scan& scan, std::string_view frame_id, MessageWriter& out) {
  out.clear();
  put_header(scan.stamp, frame_id, out);
  put_cloud(scan, frame_id, out);
}

Scan decode_scan(Bytes message, std::string_view place, Encoding encoding) {
  MessageReader in(message, place, encoding);
  const MessageHeader header = get_header(in);
  return scan_from_cloud(header.stamp, get_cloud(in, place), place);
}

void encode_scan_truth(const ScanTruth& truth, std::string_view frame_id, MessageWriter& out) {
  out.clear();
  put_header(truth.stamp, frame_id, out);
  put_truth_cloud(truth.points, out);
}

ScanTruth decode_scan_truth(Bytes message, std::string_view place, Encoding encoding) {
  MessageReader in(message, place, encoding);
  const MessageHeader header = get_header(in);
  return {{}, header.stamp, truth_from_cloud(get_cloud(in, place), place)};
}

void encode_imu(const ImuSample& sample, std::string_view frame_id, MessageWriter& out,
                const ImuVariances& variances) {
  out.clear();
  put_header(sample.stamp, frame_id, out);
  for (const double value : {0.0, 0.0, 0.0, 1.0}) out.put(value);
  // orientation_covariance: -1 in the first element means that there is no orientation
  out.put(variances.orientation);
  out.put_repeated(0.0, kCovariance3 - 1);
  put_vector(sample.gyro, out);
  put_diagonal(variances.angular_velocity, out);
  put_vector(sample.accel, out);
  put_diagonal(variances.acceleration, out);
}

ImuSample decode_imu(Bytes message, std::string_view place, Encoding encoding) {
  MessageReader in(message, place, encoding);
  ImuSample sample;
  sample.stamp = get_header(in).stamp;
  in.skip_doubles(4 + kCovariance3);  // orientation
  sample.gyro = get_vector(in);
  in.skip_doubles(kCovariance3);
  sample.accel = get_vector(in);
  return sample;
}

void encode_odometry(const StampedPose& pose, const OdometryFrames& frames, MessageWriter& out) {
  out.clear();
  put_header(pose.stamp, frames.frame_id, out);
  out.put(frames.child_frame_id);
  put_pose(pose.world_from_body, out);
  if (frames.covariance) {
    for (Eigen::Index row = 0; row < 6; ++row)
      for (Eigen::Index column = 0; column < 6; ++column)
        out.put((*frames.covariance)(row, column));
  } else {
    out.put_repeated(0.0, kCovariance6);
  }
  out.put_repeated(0.0, 6);  // twist
  out.put_repeated(0.0, kCovariance6);
}

StampedPose decode_odometry(Bytes message, std::string_view place, Encoding encoding) {
  MessageReader in(message, place, encoding);
  StampedPose pose;
  pose.stamp = get_header(in).stamp;
  in.get_string();  // child_frame_id
  pose.world_from_body = get_pose(in);
  return pose;
}

void encode_transforms(std::span<const StampedTransform> transforms, MessageWriter& out) {
  out.clear();
  out.put(static_cast<std::uint32_t>(transforms.size()));
  for (const StampedTransform& transform : transforms) {
    put_header(transform.stamp, transform.parent, out);
    out.put(std::string_view(transform.child));
    put_pose(transform.parent_from_child, out);
  }
}

std::vector<StampedTransform> decode_transforms(Bytes message, std::string_view place,
                                                Encoding encoding) {
  MessageReader in(message, place, encoding);
  constexpr std::size_t kMinTransformBytes = 7 * sizeof(double);
  std::vector<StampedTransform> transforms(in.get_length(kMinTransformBytes));
  for (StampedTransform& transform : transforms) {
    MessageHeader header = get_header(in);
    transform.stamp = header.stamp;
    transform.parent = std::move(header.frame_id);
    transform.child = in.get_string();
    transform.parent_from_child = get_pose(in);
  }
  return transforms;
}

void encode_clock(Time time, MessageWriter& out) {
  out.clear();
  put_time(time, "/clock", out);
}

void encode_string(std::string_view text, MessageWriter& out) {
  out.clear();
  out.put(text);
}

std::string decode_string(Bytes message, std::string_view place, Encoding encoding) {
  return MessageReader(message, place, encoding).get_string();
}

}  // namespace lidarena::dataset::ros
