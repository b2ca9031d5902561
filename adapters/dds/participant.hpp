// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dds/dds.h>

#include <string>
#include <string_view>

namespace lidarena::dds {

/// Where live topics are: the domain of ROS 2 nodes, and how far it reaches.
struct LiveOptions {
  int domain = -1;       ///< -1: that of ROS_DOMAIN_ID, 0 without it
  bool network = false;  ///< false: this machine alone, by its loopback interface
};

/// Owns a DDS entity and all that was created with it.
class Entity {
 public:
  Entity() = default;
  /// Throws Error with `what` when `entity` is an error of Cyclone DDS.
  Entity(dds_entity_t entity, const std::string& what);
  ~Entity();
  Entity(Entity&& other) noexcept;
  Entity& operator=(Entity&& other) noexcept;

  dds_entity_t get() const { return entity_; }

 private:
  dds_entity_t entity_ = 0;
};

/// A participant of the domain. CYCLONEDDS_URI, where it is set, decides about the network. Throws
/// InputError when ROS_DOMAIN_ID is not a number from 0 to 232.
class Participant {
 public:
  explicit Participant(const LiveOptions& options);
  dds_entity_t get() const { return participant_.get(); }

 private:
  Entity domain_;  ///< where the options configure it
  Entity participant_;
};

/// "/tf" <-> "rt/tf": the name of a ROS 2 topic in DDS; the second is empty for others.
std::string dds_topic_of(std::string_view ros_topic);
std::string ros_topic_of(std::string_view dds_topic);
/// "sensor_msgs/msg/Imu" <-> "sensor_msgs::msg::dds_::Imu_"; the second is empty for others.
std::string dds_type_of(std::string_view ros_type);
std::string ros_type_of(std::string_view dds_type);

}  // namespace lidarena::dds
