// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/rig.hpp"

namespace lidarena {

const LidarInfo* Rig::find_lidar(const std::string& id) const {
  if (id.empty()) return lidars.size() == 1 ? &lidars.front() : nullptr;
  for (const LidarInfo& lidar : lidars) {
    if (lidar.id == id) return &lidar;
  }
  return nullptr;
}

}  // namespace lidarena
