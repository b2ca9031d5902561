// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/estimation/filter_steps.hpp"
#include "lidarena/estimation/gyro_calibration.hpp"
#include "lidarena/estimation/imu_buffer.hpp"
#include "lidarena/estimation/imu_noise.hpp"
#include "lidarena/estimation/imu_track.hpp"
#include "lidarena/estimation/iterated_update.hpp"
#include "lidarena/odometry/arena_lio/initialization.hpp"

namespace lidarena::odometry::arena_lio {

/// The rotation over a scan, or a slice of one, by the gyro, in the axes of its end.
struct ScanTurn {
  Eigen::Vector3d turned = Eigen::Vector3d::Zero();       ///< rad
  Eigen::Vector3d rate_change = Eigen::Vector3d::Zero();  ///< rad/s, from the one before
  std::optional<Eigen::Vector3d> mean_rate;               ///< rad/s, in the map's axes
};

/// What an update has added to a prediction.
struct Correction {
  ScanTurn turn;                                       ///< by the gyro
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< rotation vector, rad
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s
  double seconds = 0.0;                                ///< that were predicted
};

/// Velocity corrections are summed over so many seconds: 1 mm of noise of a position is 10 cm/s of
/// the velocity over 10 ms, 2 mm/s over half a second.
inline constexpr double kVelocitySpan_s = 0.5;

/// What is known at the end of a scan: a value, which each step takes and returns as it then is.
struct Filter {
  estimation::StateEstimate estimate;  ///< in the map's frame
  estimation::ImuTrack track;          ///< the motion through the scan, which ends at `estimate`
  std::vector<estimation::FilterStep> steps;  ///< the predictions along `track`
  ScanTurn turn;
  estimation::GyroCalibration gyro;
  /// Rate (rad/s) by which the body turns faster than the gyro's range, on each clipped axis.
  Eigen::Vector3d beyond_range = Eigen::Vector3d::Zero();
  estimation::CorrectionNoise gyro_noise;  ///< of turns that no calibration explains
  estimation::CorrectionNoise accel_noise{kVelocitySpan_s};  ///< of velocities
  double accel_scale = 1.0;            ///< factor from the IMU's accelerations to m/s^2
  Pose first_pose = Pose::Identity();  ///< of the IMU, at the initialization
  StillDetector still;
  bool has_moved = false;
  double moved_s = 0.0;  ///< of corrections in motion
};

/// The filter after an initialization in axes of the map, which `map_from_start` leads to.
Filter initial_filter(const Initialization& found, const Eigen::Matrix3d& map_from_start);

/// The filter without the motion through the last scan.
Filter begun(Filter filter);

/// State and covariance propagated over the intervals, which the track and its steps go on through.
Filter predicted(Filter filter, const std::vector<estimation::ImuInterval>& intervals,
                 const estimation::ImuNoise& noise);

/// The filter with another track, which leads to its estimate by the IMU backwards.
Filter tracked_back(Filter filter, const std::vector<estimation::ImuInterval>& intervals);

/// The filter with what a correction shows: of the gyro's calibration, of the noise of turns that
/// no calibration explains, and of that of the velocity.
Filter informed(Filter filter, const Correction& correction);

/// The filter with what a correction over the intervals shows of the rate beyond the gyro's range.
Filter beyond_range(Filter filter, const std::vector<estimation::ImuInterval>& intervals,
                    const Correction& correction);

/// The filter with its track bent to its estimate, which is that of the instant `end`.
Filter bent(Filter filter, Time end);

/// The filter with its track smoothed by all that it has registered.
Filter smoothed(Filter filter);

/// The filter with `estimate`, and what a standstill tells if its detector sees one in the
/// `samples` of the scan. The filter's own estimate is the one before the scan's update.
Filter held_at_rest(Filter filter, const estimation::StateEstimate& estimate,
                    const std::vector<ImuSample>& samples);

/// Positions (m) of the scan's points in the LiDAR's frame at the scan's end, by the filter's
/// track.
std::vector<Eigen::Vector3f> deskewed(const Scan& usable, const Filter& filter,
                                      const Parallel& parallel);

}  // namespace lidarena::odometry::arena_lio
