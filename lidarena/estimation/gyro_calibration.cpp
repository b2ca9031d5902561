// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/gyro_calibration.hpp"

namespace lidarena::estimation {

void GyroCalibration::observe(const Eigen::Vector3d& turned, const Eigen::Vector3d& missed) {
  const Eigen::Vector3d seen = covariance_ * turned;
  const Eigen::Vector3d gain = seen / (kRotationSigma * kRotationSigma + turned.dot(seen));
  a_ += missed * gain.transpose();
  covariance_ -= gain * seen.transpose();
}

}  // namespace lidarena::estimation
