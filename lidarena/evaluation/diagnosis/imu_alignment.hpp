// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/trajectory.hpp"

namespace lidarena::evaluation {

/// How an IMU's clock and axes lie to a trajectory, as the rotation of both shows.
struct ImuAlignment {
  double late_s = 0.0;   ///< by how much the IMU's stamps are late, against the trajectory's
  double drift_s = 0.0;  ///< late_s of the second half minus that of the first
  Eigen::Matrix3d body_from_imu = Eigen::Matrix3d::Identity();
  double rate_rad_s = 0.0;    ///< RMS of the trajectory's angular rate: what there is to see
  double misfit_rad_s = 0.0;  ///< RMS of the difference of both rates, after the alignment
  bool axes_known = false;    ///< the body turned about more than one axis
};

/// Compares the mean rate between consecutive poses with the mean of the gyroscope over the same
/// time, moved by -0.5 to 0.5 s, under the rotation that fits best (Wahba's problem, solved by
/// SVD: F. L. Markley, "Attitude determination using vector observations", 1988). Empty when the
/// body hardly turns (below 0.05 rad/s RMS) or fewer than 20 poses are within the samples.
std::optional<ImuAlignment> align_imu(const Trajectory& trajectory,
                                      std::span<const ImuSample> samples);

}  // namespace lidarena::evaluation
