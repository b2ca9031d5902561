// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/messages/livox_message.hpp"

#include <algorithm>
#include <limits>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/firing_order.hpp"
#include "lidarena/dataset/messages/message_stream.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"

namespace lidarena::dataset {

bool is_livox_type(std::string_view type) {
  return type == "livox_ros_driver2/msg/CustomMsg" || type == "livox_ros_driver/msg/CustomMsg" ||
         type == "livox_interfaces/msg/CustomMsg";
}

Scan decode_livox(Bytes message, std::string_view place, Encoding encoding) {
  constexpr std::size_t kMinPointBytes = 19;  // without padding, which the last point lacks
  MessageReader in(message, place, encoding);
  Scan scan;
  scan.stamp = ros::get_header(in).stamp;
  in.get<std::uint64_t>();  // timebase: header.stamp again, or the sensor's own clock
  in.get<std::uint32_t>();  // point_num: the sequence has its own length
  for (int i = 0; i < 4; ++i) in.get<std::uint8_t>();  // lidar_id, rsvd[3]
  const std::uint32_t count = in.get_length(kMinPointBytes);
  scan.points.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto offset_time = in.get<std::uint32_t>();
    if (offset_time > std::uint32_t{std::numeric_limits<std::int32_t>::max()}) {
      throw InputError(place, "a scan is longer than 2.1 s", "split it into shorter scans");
    }
    Point point;
    point.dt_ns = static_cast<std::int32_t>(offset_time);
    for (int axis = 0; axis < 3; ++axis) point.position[axis] = in.get<float>();
    point.intensity = in.get<std::uint8_t>();
    in.get<std::uint8_t>();  // tag
    point.ring = in.get<std::uint8_t>();
    const bool is_return = point.position.allFinite() && !point.position.isZero(0.0F);
    if (is_return) scan.points.push_back(point);
  }
  scan.timed = scan.points.empty() || std::ranges::any_of(scan.points, [](const Point& point) {
                 return point.dt_ns != 0;
               });
  sort_in_firing_order(scan.points);
  return scan;
}

}  // namespace lidarena::dataset
