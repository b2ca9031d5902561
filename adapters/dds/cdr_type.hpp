// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <string>

#include "lidarena/dataset/byte_stream.hpp"

struct ddsi_serdata;
struct ddsi_sertype;

/// DDS data that is already serialized. Messages in recordings are plain CDR, which is what DDS
/// sends, so they pass without a generated type for each of them: any ROS 2 message can be sent and
/// received, and its bytes stay what they are.
namespace lidarena::dds {

/// A topic of `participant` whose data are CDR messages of the DDS type `type_name`, e.g.
/// "sensor_msgs::msg::dds_::Imu_". `type`: what make_data() needs. Throws Error when Cyclone DDS
/// refuses.
struct CdrTopic {
  dds_entity_t topic = 0;
  const ddsi_sertype* type = nullptr;
};
CdrTopic create_cdr_topic(dds_entity_t participant, const std::string& topic_name,
                          const std::string& type_name);

/// A message (with its encapsulation header) as DDS data; the caller has one reference.
ddsi_serdata* make_data(const ddsi_sertype* type, dataset::Bytes message);

/// The message, without the padding that DDS adds; valid as long as the caller has a reference.
dataset::Bytes message_of(const ddsi_serdata* data);

/// The number that its publisher gave a received message: 1, 2, ... for each of a topic. 0: not
/// known, since it did not come over the network but from this process.
std::int64_t sequence_of(const ddsi_serdata* data);

}  // namespace lidarena::dds
