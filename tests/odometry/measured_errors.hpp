// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

/// What each method's errors were when its row was last entered: the gates of the conformance
/// tests, which allow twice as much.
namespace lidarena::odometry {

/// Situations of the conformance tests, in the order of the table's columns.
enum class Situation {
  kFlight,          ///< largest error of the flight
  kFaultyScans,     ///< the same with scans that are empty or have points that are not finite
  kEmptyFirstScan,  ///< the same with a first scan without points
  kElsewhere,       ///< the same from another start
  kMounted,         ///< the same with the LiDAR mounted at an angle, off the body's origin
  kMoving,          ///< the same with a start in motion
  kVibrating,       ///< the same with rotors that shake the IMU
  kStanding,        ///< largest motion at a standstill, of a point 5 m away
  kMap              ///< distance from the walls below which 90 % of the published points lie
};
/// As in the tests' properties: "flight".
std::string_view name_of(Situation situation);

/// Error (m) of a method ("kiss_icp:indoor"); nothing if the table has none.
std::optional<double> measured_error(std::string_view method, Situation situation);

}  // namespace lidarena::odometry
