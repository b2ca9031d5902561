// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/recorded_imu_flight.hpp"

#include <Eigen/Geometry>

#include "lidarena/base/error.hpp"

namespace lidarena::flight {
namespace {

using Controls = std::vector<PoseSplineFlight::Spline::Value>;

/// A constant rotation on either side is linear in the quaternion, so the control points turn too.
Controls placed(Controls controls, const Pose& world_from_recording, const Pose& recorded_from_body,
                const std::string& name) {
  constexpr double kTilt = 1e-6, kMoved_m = 1e-3;
  const Eigen::Vector3d up = world_from_recording.linear().col(2);
  if ((up - Eigen::Vector3d::UnitZ()).norm() > kTilt)
    throw InputError(name, "world_from_recording tilts the vertical of a recorded IMU",
                     "turn the recording about z alone");
  if (recorded_from_body.translation().norm() > kMoved_m)
    throw InputError(name, "recorded_from_body moves the body away from the recorded IMU",
                     "leave its position zero, and mount the LiDAR by body_from_lidar");
  const Eigen::Quaterniond before(world_from_recording.linear());
  const Eigen::Quaterniond after(recorded_from_body.linear());
  for (auto& control : controls) {
    const Eigen::Quaterniond q(Eigen::Vector4d(control.tail<4>()));
    const Eigen::Vector3d position = world_from_recording * Eigen::Vector3d(control.head<3>());
    control << position, (before * q * after).coeffs();
  }
  return controls;
}

}  // namespace

RecordedImuFlight::RecordedImuFlight(ImuSplineFit fit, const std::vector<ImuSample>& samples,
                                     Time start, const Pose& world_from_recording,
                                     const Pose& recorded_from_body, const std::string& name)
    : spline_(placed(std::move(fit.controls), world_from_recording, recorded_from_body, name),
              fit.knot_s, fit.duration) {
  if (samples.empty()) return;
  imu_ = RecordedImu{{}, recorded_from_body.inverse()};
  for (ImuSample sample : samples) {
    sample.stamp -= start;
    if (sample.stamp >= Time{0} && sample.stamp <= fit.duration) imu_->samples.push_back(sample);
  }
}

}  // namespace lidarena::flight
