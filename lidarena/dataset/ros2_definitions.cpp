// SPDX-License-Identifier: BSD-3-Clause
// Message definitions of ROS 2 (members only), from common_interfaces and geometry2.
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/ros2_messages.hpp"

namespace lidarena::ros2 {
namespace {

struct Definition {
  std::string_view name;  ///< as types refer to it
  std::string_view members;
};

constexpr std::array kDefinitions{
    Definition{"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
    Definition{"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
    Definition{"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    Definition{"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
    Definition{"geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"},
    Definition{"geometry_msgs/Pose",
               "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
    Definition{"geometry_msgs/PoseWithCovariance",
               "geometry_msgs/Pose pose\nfloat64[36] covariance\n"},
    Definition{"geometry_msgs/Twist",
               "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"},
    Definition{"geometry_msgs/TwistWithCovariance",
               "geometry_msgs/Twist twist\nfloat64[36] covariance\n"},
    Definition{"geometry_msgs/Transform",
               "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
    Definition{"geometry_msgs/TransformStamped",
               "std_msgs/Header header\nstring child_frame_id\n"
               "geometry_msgs/Transform transform\n"},
    Definition{"sensor_msgs/PointField",
               "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\n"
               "uint8 UINT32=6\nuint8 FLOAT32=7\nuint8 FLOAT64=8\n"
               "string name\nuint32 offset\nuint8 datatype\nuint32 count\n"},
    Definition{"sensor_msgs/PointCloud2",
               "std_msgs/Header header\nuint32 height\nuint32 width\n"
               "sensor_msgs/PointField[] fields\nbool is_bigendian\nuint32 point_step\n"
               "uint32 row_step\nuint8[] data\nbool is_dense\n"},
    Definition{"sensor_msgs/Imu",
               "std_msgs/Header header\n"
               "geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
               "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
               "geometry_msgs/Vector3 linear_acceleration\n"
               "float64[9] linear_acceleration_covariance\n"},
    Definition{"nav_msgs/Odometry",
               "std_msgs/Header header\nstring child_frame_id\n"
               "geometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist\n"},
    Definition{"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
};

/// Appends the definitions that `members` refers to, each once, depth first.
void collect(std::string_view members, std::vector<Definition>& found) {
  for (const Definition& candidate : kDefinitions) {
    const std::string use = std::string(candidate.name);
    const bool used =
        members.find(use + " ") != members.npos || members.find(use + "[]") != members.npos;
    if (!used) continue;
    bool known = false;
    for (const Definition& other : found) known = known || other.name == candidate.name;
    if (known) continue;
    found.push_back(candidate);
    collect(candidate.members, found);
  }
}

}  // namespace

std::string definition_of(std::string_view type) {
  std::string name(type);
  if (const auto msg = name.find("/msg/"); msg != name.npos) name.erase(msg, 4);
  for (const Definition& definition : kDefinitions) {
    if (definition.name != name) continue;
    std::vector<Definition> used;
    collect(definition.members, used);
    std::string text(definition.members);
    for (const Definition& other : used) {
      text += std::string(80, '=') + "\nMSG: " + std::string(other.name) + "\n";
      text += other.members;
    }
    return text;
  }
  throw InputError(type, "is not among the message types that are written");
}

}  // namespace lidarena::ros2
