// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/point_truth.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/dataset/messages/message_stream.hpp"
#include "lidarena/dataset/messages/point_times.hpp"

namespace lidarena::dataset::ros {

/// sensor_msgs/msg/PointField; the numbers are those of the message.
enum class FieldType : std::uint8_t {
  kInt8 = 1,
  kUint8 = 2,
  kInt16 = 3,
  kUint16 = 4,
  kInt32 = 5,
  kUint32 = 6,
  kFloat32 = 7,
  kFloat64 = 8,
};

struct PointField {
  std::string name;
  std::uint32_t offset = 0;
  FieldType type = FieldType::kFloat32;
  bool operator==(const PointField&) const = default;
};

/// sensor_msgs/msg/PointCloud2 without its header; `data` is a view into the message.
struct PointCloud2 {
  std::uint32_t height = 1;
  std::uint32_t width = 0;
  std::vector<PointField> fields;
  std::uint32_t point_step = 0;
  std::uint32_t row_step = 0;
  Bytes data;
  std::vector<std::byte> unpadded;  ///< what `data` refers to where rows of the message are padded
  PointCloud2() = default;
  PointCloud2(const PointCloud2&) = delete;  // `data` may refer to `unpadded`
  PointCloud2& operator=(const PointCloud2&) = delete;
  PointCloud2(PointCloud2&&) = default;  // the buffer keeps its address
  PointCloud2& operator=(PointCloud2&&) = default;
};

/// Appends a cloud of `height` x `width` points of `step` bytes, its data set to zero. Returns a
/// span of the data, for the caller to fill in; the caller then appends is_dense.
std::span<std::byte> put_layout(std::size_t height, std::size_t width, std::size_t step,
                                const std::vector<PointField>& fields, MessageWriter& out);

/// Appends everything after the header. Throws InputError (place `place`) when a point is earlier
/// than the stamp.
void put_cloud(const Scan& scan, std::string_view place, MessageWriter& out);
/// Throws InputError when sizes contradict each other or the data is big endian.
PointCloud2 get_cloud(MessageReader& in, std::string_view place);

/// The same for ground-truth points, in the memory layout of PointTruth: x y z range nx ny nz
/// triangle.
void put_truth_cloud(const std::vector<PointTruth>& points, MessageWriter& out);
/// Reads exactly that layout; throws InputError (place `place`) for any other.
std::vector<PointTruth> truth_from_cloud(const PointCloud2& cloud, std::string_view place);

/// The scan in a cloud with this header.stamp. A cloud written by put_cloud() gives the same scan,
/// bit by bit. In clouds of other drivers, fields are found by name and type:
///   x, y, z        float32 or float64, required
///   intensity      any type; else reflectivity, signal; else 0
///   ring           any integer; else line, channel; else 0
///   time           t, offset_time, time, timestamp, time_stamp, or another name with "time" in it:
///                  integers in ns since header.stamp; floats in s, us or ns, since header.stamp or
///                  absolute (distinguished by the scan's duration and distance from the stamp)
/// Points without a return (not finite, or 0 0 0) are dropped, the others sorted in firing order.
/// If points are earlier than header.stamp (drivers that stamp the last packet), the scan's stamp
/// is the first point's time. Without a time field, or if all times are 0, the scan is untimed.
/// Throws InputError when the layout is not supported.
Scan scan_from_cloud(Time header_stamp, const PointCloud2& cloud, std::string_view place);

/// What was wrong with the times of a cloud's points.
struct TimeFaults {
  std::size_t undated_points = 0;  ///< without a finite time, left out
  bool implausible = false;        ///< not those of the other sweeps: the scan is untimed
};

/// The same where the times are known to be read by `rule`, see judge_point_times(): whatever a
/// single cloud has for times, it gives a scan.
Scan scan_from_cloud(Time header_stamp, const PointCloud2& cloud, std::string_view place,
                     const PointTimes& rule, TimeFaults& faults);

/// The range of the times of a cloud's returns, for judge_point_times().
SweepTimes times_in(Time header_stamp, const PointCloud2& cloud, std::string_view place);

/// Whether a cloud states the rings (lines, channels) of its points.
bool has_rings(const PointCloud2& cloud);

}  // namespace lidarena::dataset::ros
