// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/recorded_imu_reader.hpp"

#include <algorithm>
#include <sstream>

#include "lidarena/base/error.hpp"

namespace lidarena::sensor {

RecordedImuReader::RecordedImuReader(const flight::RecordedImu& recorded, const Pose& body_from_imu,
                                     const std::string& id)
    : samples_(recorded.samples) {
  constexpr double kApart_m = 1e-3;
  if (samples_.empty()) throw InputError(id, "the flight has no samples of its IMU");
  const Eigen::Vector3d there = recorded.body_from_imu.translation();
  if ((body_from_imu.translation() - there).norm() > kApart_m) {
    std::ostringstream text;
    text << "its IMU is at (" << body_from_imu.translation().transpose()
         << ") m of the body, the recorded one at (" << there.transpose() << ") m";
    throw InputError(id, text.str(),
                     "set the sensor's imu.lidar_from_imu so that both are in one place");
  }
  const Eigen::Matrix3d imu_from_recorded =
      body_from_imu.linear().transpose() * recorded.body_from_imu.linear();
  for (ImuSample& sample : samples_) {
    sample.gyro = imu_from_recorded * sample.gyro;
    sample.accel = imu_from_recorded * sample.accel;
  }
}

Time RecordedImuReader::next_stamp() const {
  return next_ < samples_.size() ? samples_[next_].stamp : Time::max();
}

Time RecordedImuReader::first_stamp_from(Time t) const {
  const auto after = std::ranges::lower_bound(samples_, t, {}, &ImuSample::stamp);
  return after != samples_.end() ? after->stamp : t;
}

}  // namespace lidarena::sensor
