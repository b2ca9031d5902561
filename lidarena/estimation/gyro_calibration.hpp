// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace lidarena::estimation {

/// Online calibration of a gyro against the rotations that were estimated from a LiDAR, by
/// recursive least squares:
/// - scale factors and misalignment of the axes, which MEMS data sheets give as up to some percent:
///   without them a turn by 30 degrees within a scan is wrong by milliradians, whatever the bias.
///   The true rate is (I + A) times the measured one without bias;
/// - the delay of its clock, without which a change of the rate is seen too late: by 20 ms at
///   5 rad/s a scan is off by 0.1 rad.
class GyroCalibration {
 public:
  static constexpr double kMaxDelay = 0.1;  ///< s

  /// The true rate (rad/s) by what is known so far; `rate`: measured, without bias.
  Eigen::Vector3d calibrated(const Eigen::Vector3d& rate) const {
    return rate + correction() * rate;
  }

  /// `turned`: rotation vector (rad) of the calibrated rates over a scan, much less than half a
  /// turn; `change`: of the mean rate (rad/s) since the scan before; `missed`: the rotation vector
  /// that leads from there to the rotation that was estimated; `sigma`: of that (rad). All in the
  /// axes of the scan's end. Returns what of `missed` the calibration does not explain.
  Eigen::Vector3d observe(const Eigen::Vector3d& turned, const Eigen::Vector3d& change,
                          const Eigen::Vector3d& missed, double sigma);

  Eigen::Matrix3d correction() const { return estimate_.head<9>().reshaped(3, 3); }  ///< A
  /// The rotation vector (rad) of A, its part that is no scale and no skew of the axes: by how much
  /// the gyro is turned from where it is taken to be on the LiDAR.
  Eigen::Vector3d turned() const;
  /// By how much the gyro's stamps are late, by the LiDAR's clock (s).
  double delay_s() const;

 private:
  static constexpr double kPriorSigma = 0.01;       ///< of each element of A
  static constexpr double kPriorDelaySigma = 0.02;  ///< s

  using Vector = Eigen::Matrix<double, 10, 1>;
  using Matrix = Eigen::Matrix<double, 10, 10>;
  static Matrix prior();

  Vector estimate_ = Vector::Zero();  ///< columns of A, delay
  Matrix covariance_ = prior();
};

}  // namespace lidarena::estimation
