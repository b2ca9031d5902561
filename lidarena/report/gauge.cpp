// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/gauge.hpp"

#include <string>

namespace lidarena::report {

std::optional<Pose> truth_from_estimate(const Json& metrics) {
  for (const std::string gauge : {"se3", "first_pose"}) {
    const Json::json_pointer pointer("/final/ate/" + gauge + "/truth_from_estimate_m_quaternion");
    if (!metrics.is_object() || !metrics.contains(pointer)) continue;
    Pose pose = Pose::Identity();
    read_value(ConfigNode::parse(metrics.at(pointer).dump(), "metrics.json"), pose, {});
    return pose;
  }
  return std::nullopt;
}

}  // namespace lidarena::report
