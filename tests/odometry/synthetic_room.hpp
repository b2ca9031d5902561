// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "lidarena/base/event.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/base/rig.hpp"

/// Simulated LiDAR and IMU in a small room, both computed in closed form. Independent of the
/// library's simulator, so that an odometry is tested on its own.
namespace lidarena::odometry::synthetic {

/// Pose of the body in the room (z up, m) as a function of time (s).
using Motion = std::function<Pose(double seconds)>;

/// Distance (m) from `origin` along the unit vector `direction` to the walls of the room, 16 x 12 x
/// 4 m about the origin, or to one of its four pillars.
double cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

/// What a beam meets: distance (m) from `origin` along the unit vector `direction` at a time (s);
/// infinite: nothing.
using Scene = std::function<double(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                   double seconds)>;

/// An upright box with the given corners.
struct Box {
  Eigen::Array3d low, high;
};
/// Distance to the outside of a box, or from within to its walls; infinite if it is missed.
double cast(const Box& box, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

/// Rests at the start for 1 s, then flies a curve with up to 1 m/s and 35 deg/s for about 10 s.
Pose flight(double seconds);

struct Recording {
  Motion motion = flight;
  Pose body_from_lidar = Pose::Identity();
  double seconds = 4.0;
  double range_noise_m = 0.01;
  Time epoch{1'000'000'000};
  std::size_t points_per_scan = 10240;
  bool repeating = false;   ///< false: the beams of each scan are between those of the others
  std::uint64_t seed = 17;  ///< of the noise
  double gyro_noise_density = 0.0;   ///< rad/s/sqrt(Hz)
  double accel_noise_density = 0.0;  ///< m/s^2/sqrt(Hz)
  /// Rotors shake the IMU: tones of 126.3 Hz and twice that, 2.5 m/s^2 and 0.025 rad/s each on each
  /// axis.
  bool vibrating = false;
  Scene scene{};  ///< if empty: the room
};

/// A spinning LiDAR of 64 rings, +-35 deg, 10 Hz, named "lidar"; an IMU at 200 Hz, named "imu", at
/// the body's origin.
Rig rig_of(const Recording& recording);

/// All events in the order of EventSource.
std::vector<Event> record(const Recording& recording);

/// The scans only.
std::vector<Scan> scans_of(const Recording& recording);

/// The true pose at `stamp`, in the body's frame at `start`.
Pose truth(const Recording& recording, Time start, Time stamp);

}  // namespace lidarena::odometry::synthetic
