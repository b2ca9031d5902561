// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/estimation/gyro_calibration.hpp"
#include "lidarena/estimation/imu_buffer.hpp"
#include "lidarena/estimation/imu_track.hpp"
#include "lidarena/estimation/iterated_update.hpp"
#include "lidarena/odometry/arena_lio/initialization.hpp"

namespace lidarena::odometry::arena_lio {

/// The rotation over a scan by the gyro, in the axes of the scan's end.
struct ScanTurn {
  Eigen::Vector3d turned = Eigen::Vector3d::Zero();       ///< rad
  Eigen::Vector3d rate_change = Eigen::Vector3d::Zero();  ///< rad/s, from scan to scan
  std::optional<Eigen::Vector3d> mean_rate;               ///< rad/s, in the map's axes
};

/// What is known at the end of a scan: a value, which each step takes and returns as it then is.
struct Filter {
  estimation::StateEstimate estimate;  ///< in the map's frame
  estimation::ImuTrack track;          ///< the motion through the scan, which ends at `estimate`
  ScanTurn turn;
  estimation::GyroCalibration gyro;
  double accel_scale = 1.0;            ///< factor from the IMU's accelerations to m/s^2
  Pose first_pose = Pose::Identity();  ///< of the IMU, at the initialization
  StillDetector still;
  bool has_moved = false;
};

/// The filter after an initialization in axes of the map, which `map_from_start` leads to.
Filter initial_filter(const Initialization& found, const Eigen::Matrix3d& map_from_start);

/// State and covariance propagated over the intervals, with the track through them.
Filter predicted(Filter filter, const std::vector<estimation::ImuInterval>& intervals,
                 const estimation::ImuNoise& noise);

/// The filter with another track, which leads to its estimate by the IMU backwards.
Filter tracked_back(Filter filter, const std::vector<estimation::ImuInterval>& intervals);

/// The filter with `estimate` for the instant `end`, to which its track is bent.
Filter corrected(Filter filter, const estimation::StateEstimate& estimate, Time end);

/// The filter with `estimate`, and what a standstill tells if its detector sees one in the
/// `samples` of the scan. The filter's own estimate is the one before the scan's update.
Filter held_at_rest(Filter filter, const estimation::StateEstimate& estimate,
                    const std::vector<ImuSample>& samples);

/// The calibration of the gyro, and the delay of its clock, after an update that has turned the
/// state `predicted` into the filter's.
estimation::GyroCalibration calibrated(const Filter& filter,
                                       const estimation::InertialState& predicted);

/// Positions (m) of the scan's points in the LiDAR's frame at the scan's end, by the filter's
/// track.
std::vector<Eigen::Vector3f> deskewed(const Scan& usable, const Filter& filter,
                                      const Parallel& parallel);

}  // namespace lidarena::odometry::arena_lio
