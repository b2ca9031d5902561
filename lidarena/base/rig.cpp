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

const ImuInfo* Rig::imu_beside(const LidarInfo& lidar) const {
  for (const ImuInfo& imu : imus) {
    if (imu.id == lidar.id) return &imu;
  }
  return imus.empty() ? nullptr : &imus.front();
}

}  // namespace lidarena
