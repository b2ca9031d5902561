// SPDX-License-Identifier: BSD-3-Clause
// Message definitions (members only), as in common_interfaces, geometry2 and Livox's drivers.
#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/md5.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"

namespace lidarena::dataset::ros {
namespace {

struct Definition {
  std::string_view name;  ///< as other definitions refer to it
  std::string_view members;
  std::string_view ros1_members = members;  ///< if they differ
};

constexpr std::string_view kLivoxPoint =
    "uint32 offset_time\nfloat32 x\nfloat32 y\nfloat32 z\nuint8 reflectivity\nuint8 tag\n"
    "uint8 line\n";

constexpr std::array kDefinitions{
    Definition{"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
    Definition{"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n",
               "uint32 seq\ntime stamp\nstring frame_id\n"},
    Definition{"std_msgs/String", "string data\n"},
    Definition{"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    Definition{"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
    Definition{"geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n",
               "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
    Definition{"geometry_msgs/Pose",
               "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
    Definition{"geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n"},
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
    Definition{"livox_ros_driver/CustomPoint", kLivoxPoint},
    Definition{"livox_ros_driver/CustomMsg",
               "std_msgs/Header header\nuint64 timebase\nuint32 point_num\nuint8 lidar_id\n"
               "uint8[3] rsvd\nlivox_ros_driver/CustomPoint[] points\n"},
    Definition{"livox_ros_driver2/CustomPoint", kLivoxPoint},
    Definition{"livox_ros_driver2/CustomMsg",
               "std_msgs/Header header\nuint64 timebase\nuint32 point_num\nuint8 lidar_id\n"
               "uint8[3] rsvd\nlivox_ros_driver2/CustomPoint[] points\n"},
    Definition{"nav_msgs/Path", "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n"},
    Definition{"rosgraph_msgs/Clock", "builtin_interfaces/Time clock\n", "time clock\n"},
    Definition{"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
};

const Definition* find_definition(std::string_view name) {
  for (const Definition& definition : kDefinitions) {
    if (definition.name == name) return &definition;
  }
  return nullptr;
}

const Definition& definition_named(std::string_view name) {
  if (const Definition* definition = find_definition(name)) return *definition;
  throw InputError(name, "is not one of the message types that can be written");
}

std::string_view members_of(const Definition& definition, Encoding encoding) {
  return encoding == Encoding::kRos1 ? definition.ros1_members : definition.members;
}

struct Member {
  std::string_view line;
  const Definition* type;  ///< nullptr: a number, a string or a constant
  std::string_view name;
};

std::vector<Member> split(std::string_view members) {
  std::vector<Member> split;
  while (!members.empty()) {
    const std::string_view line = members.substr(0, members.find('\n'));
    members.remove_prefix(line.size() + 1);
    const std::size_t blank = line.find(' ');
    const std::string_view type = line.substr(0, blank);
    split.push_back(
        {line, find_definition(type.substr(0, type.find('['))), line.substr(blank + 1)});
  }
  return split;
}

/// Appends the definitions that `members` refers to, each once, depth first.
void collect(std::string_view members, Encoding encoding, std::vector<const Definition*>& found) {
  for (const Member& member : split(members)) {
    if (member.type == nullptr || std::ranges::count(found, member.type) > 0) continue;
    found.push_back(member.type);
    collect(members_of(*member.type, encoding), encoding, found);
  }
}

}  // namespace

std::string ros1_name(std::string_view type) {
  std::string name(type);
  if (const auto msg = name.find("/msg/"); msg != name.npos) name.erase(msg, 4);
  return name;
}

std::string ros2_name(std::string_view type) {
  std::string name(type);
  const auto slash = name.find('/');
  if (slash != name.npos && name.find('/', slash + 1) == name.npos) name.insert(slash, "/msg");
  return name;
}

bool has_definition(std::string_view type) { return find_definition(ros1_name(type)) != nullptr; }

std::string definition_of(std::string_view type, Encoding encoding) {
  const Definition& definition = definition_named(ros1_name(type));
  std::vector<const Definition*> used;
  collect(members_of(definition, encoding), encoding, used);
  std::string text(members_of(definition, encoding));
  for (const Definition* other : used) {
    text += std::string(80, '=') + "\nMSG: " + std::string(other->name) + "\n";
    text += members_of(*other, encoding);
  }
  return text;
}

std::string ros1_md5_of(std::string_view type) {
  std::string text;
  for (const Member& member : split(definition_named(ros1_name(type)).ros1_members)) {
    if (!text.empty()) text += '\n';
    text += member.type == nullptr
                ? std::string(member.line)
                : ros1_md5_of(member.type->name) + " " + std::string(member.name);
  }
  return md5_of(text);
}

}  // namespace lidarena::dataset::ros
