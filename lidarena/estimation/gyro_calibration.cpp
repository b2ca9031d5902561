// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/gyro_calibration.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace lidarena::estimation {

GyroCalibration::Matrix GyroCalibration::prior() {
  Vector sigma = Vector::Constant(kPriorSigma);
  sigma[9] = kPriorDelaySigma;
  return sigma.cwiseAbs2().asDiagonal();
}

Eigen::Vector3d GyroCalibration::observe(const Eigen::Vector3d& turned,
                                         const Eigen::Vector3d& change,
                                         const Eigen::Vector3d& missed, double sigma) {
  Eigen::Matrix<double, 3, 10> by_estimate;
  by_estimate << turned.x() * Eigen::Matrix3d::Identity(), turned.y() * Eigen::Matrix3d::Identity(),
      turned.z() * Eigen::Matrix3d::Identity(), change;
  const Eigen::Matrix<double, 10, 3> seen = covariance_ * by_estimate.transpose();
  Eigen::Matrix3d innovation = by_estimate * seen;
  innovation.diagonal().array() += sigma * sigma;
  const Eigen::Matrix<double, 10, 3> gain = innovation.ldlt().solve(seen.transpose()).transpose();
  const Vector step = gain * missed;
  estimate_ += step;
  covariance_ -= gain * seen.transpose();
  return missed - by_estimate * step;
}

Eigen::Vector3d GyroCalibration::turned() const {
  const Eigen::Matrix3d skew = 0.5 * (correction() - correction().transpose());
  return {skew(2, 1), skew(0, 2), skew(1, 0)};
}

double GyroCalibration::delay_s() const { return std::clamp(estimate_[9], -kMaxDelay, kMaxDelay); }

}  // namespace lidarena::estimation
