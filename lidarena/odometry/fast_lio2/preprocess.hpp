// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/estimation/imu_track.hpp"
#include "lidarena/estimation/inertial_state.hpp"
#include "lidarena/odometry/fast_lio2/config.hpp"

namespace lidarena::odometry::fast_lio2 {

/// The scan with times made up from the azimuth of its points, by a rule that is right for a sensor
/// that turns clockwise and sends its points in the order of their firing: a point is later than
/// the first one of its ring by the angle from there, clockwise, at 361 degrees in a scan's period;
/// by a revolution more where that is earlier than the point before it. The first point of each
/// ring is not used; it stays as one that is not finite, so that the count of points goes on.
Scan with_azimuth_times(const Scan& scan, double rate_hz);

/// Every n-th point of the message in its order, without those that are too near or not finite.
/// The program never uses the first point of a Livox message: `is_livox`.
Scan selected_points(const Scan& scan, const Config& config, bool is_livox);

/// When scans end.
class ScanClock {
 public:
  /// The instant of the last of the points in their order, as in the program: if that is not the
  /// latest one, the scan ends too early. With at most one point, or if that instant is before half
  /// of the mean duration of the scans so far, the mean duration counts.
  Time end_of(const Scan& selected);

 private:
  double mean_s_ = 0.0;
  int scans_ = 0;
};

/// Backward propagation (section IV-C, eq. 10): the points (m) in the LiDAR's frame at the scan's
/// end, where `state` holds. Points of the track's first instant stay as they were measured, since
/// the program moves only points that are later than a pose of the track. Its earliest point, if
/// later, is moved once more for each earlier step of the track.
std::vector<Eigen::Vector3f> propagate_backward(const Scan& selected,
                                                const estimation::ImuTrack& track,
                                                const estimation::InertialState& state,
                                                const Parallel& parallel);

}  // namespace lidarena::odometry::fast_lio2
