// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/flight/pose_spline_flight.hpp"

namespace lidarena::flight {

/// Settings of fit_imu_spline().
struct ImuFitConfig {
  double knot_s = 0.15;
  double pose_sigma_m = 0.002;
  double pose_sigma_rad = 0.003;
  double bias_knot_s = 10.0;
  int left_out_second = 4;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("knot_s", self.knot_s, "s", "time between the knots of the spline", at_least(0.05));
    v("pose_sigma_m", self.pose_sigma_m, "m", "error of the recorded positions, each axis",
      above(0));
    v("pose_sigma_rad", self.pose_sigma_rad, "rad", "error of the recorded rotations, each axis",
      above(0));
    v("bias_knot_s", self.bias_knot_s, "s",
      "the IMU's biases are linear between knots this far apart", above(0));
    v("left_out_second", self.left_out_second, "",
      "which one of each five seconds of samples the fit does not see", between(0, 4));
  }
};

/// Root mean square of the residuals of one axis.
struct ImuResiduals {
  double gyro_rad_s = 0.0, accel_m_s2 = 0.0;
};

/// The smooth motion of an IMU that explains its samples and recorded poses best.
struct ImuSplineFit {
  std::vector<PoseSplineFlight::Spline::Value> controls;  ///< pose of the IMU, recording's frame
  double knot_s = 0.0;
  Time duration{0};
  double position_rms_m = 0.0, rotation_rms_rad = 0.0;  ///< residuals of the poses, each axis
  ImuResiduals fitted, left_out;
  Eigen::Vector3d gyro_bias, accel_bias;  ///< means over time, rad/s and m/s^2
  int iterations = 0;
};

/// One B-spline of degree 6 in position and quaternion, and biases that are linear between their
/// knots, fitted to the poses of an IMU (z up; time 0: the first pose) and to its samples, by
/// Gauss-Newton with the sparse normal equations (Furgale, Rehder, Siegwart, "Unified temporal and
/// spatial calibration for multi-sensor systems", IROS 2013, without its clocks). Of five seconds
/// of samples one is left out, unless poses are missing in it: its residuals show whether the
/// spline follows the noise. The weights of gyro and accelerometer follow from their residuals.
/// Throws InputError (place `name`) if the samples do not cover the poses, or the poses are fewer
/// than two.
ImuSplineFit fit_imu_spline(const Trajectory& poses, const std::vector<ImuSample>& samples,
                            const ImuFitConfig& config, const std::string& name);

/// One sentence with the residuals.
std::string describe(const ImuSplineFit& fit);

}  // namespace lidarena::flight
