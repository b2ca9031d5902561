// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lidarena/base/time.hpp"

namespace lidarena::dataset {

/// Metadata of a topic for rosbag2.
struct RosbagTopic {
  std::string name;
  std::string type;
  std::string qos;  ///< offered_qos_profiles, YAML
  std::uint64_t message_count = 0;
};

/// Offered QoS, in the integer form that every rosbag2 from Humble on reads. Empty means the
/// default (reliable, volatile); latched (reliable, transient local, depth 1) is what subscribers
/// to /tf_static request.
std::string default_qos();
std::string latched_qos();

/// metadata.yaml of a bag folder with the one MCAP file `file`, so that `ros2 bag play` accepts it:
/// metadata version 5 (Humble), which later versions read too.
std::string rosbag2_metadata(const std::string& file, const std::vector<RosbagTopic>& topics,
                             Time start, Time end);

}  // namespace lidarena::dataset
