// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace lidarena::estimation {

/// Online calibration of a gyro's scale factors and the misalignment of its axes, which MEMS data
/// sheets give as up to some percent: without it a turn by 30 degrees within a scan is wrong by
/// milliradians, whatever the bias. The true rate is (I + A) times the measured one without bias;
/// A follows from the rotations that were estimated otherwise (from a LiDAR), by recursive least
/// squares.
class GyroCalibration {
 public:
  /// The true rate (rad/s) by what is known so far; `rate`: measured, without bias.
  Eigen::Vector3d calibrated(const Eigen::Vector3d& rate) const { return rate + a_ * rate; }

  /// `turned`: rotation vector (rad) of the calibrated rates over an interval, much less than half
  /// a turn; `missed`: the rotation vector that leads from there to the rotation that was
  /// estimated, in the axes of the end.
  void observe(const Eigen::Vector3d& turned, const Eigen::Vector3d& missed);

  const Eigen::Matrix3d& correction() const { return a_; }  ///< A

 private:
  static constexpr double kPriorSigma = 0.01;     ///< of each element of A
  static constexpr double kRotationSigma = 1e-3;  ///< rad, of the estimated rotations

  Eigen::Matrix3d a_ = Eigen::Matrix3d::Zero();
  /// Covariance of each row of A.
  Eigen::Matrix3d covariance_ = kPriorSigma * kPriorSigma * Eigen::Matrix3d::Identity();
};

}  // namespace lidarena::estimation
