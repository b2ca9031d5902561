// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <limits>
#include <string>

#include "lidarena/base/error.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/base/so3.hpp"

namespace lidarena {

/// Faults that a benchmark puts into a recording before an odometry sees it.
struct Faults {
  Time clock{0};                      ///< added to the scans' stamps
  Pose misplaced = Pose::Identity();  ///< told from true pose of the LiDAR
  double lost = 0.0;                  ///< share of the points that are lost,
  double begin_s = 0.0, end_s = 0.0;  ///< between these times since the first scan
  double near_m = std::numeric_limits<double>::infinity();  ///< those left are no farther: dust
};

/// Reads `--clock S`, `--misplaced X,Y,Z,RX,RY,RZ` (m, degrees) and `--lost SHARE,BEGIN,END[,DUST]`
/// (a share of the points from BEGIN to END (s); with DUST, a point in five of the others becomes a
/// return from dust at up to DUST meters). False: the option is none of these.
inline bool read_fault(const std::string& option, const std::string& value, Faults& faults) {
  double v[6] = {};
  const int read =
      std::sscanf(value.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf", v, v + 1, v + 2, v + 3, v + 4, v + 5);
  if (option == "--clock" && read == 1) {
    faults.clock = from_seconds(v[0]);
  } else if (option == "--misplaced" && read == 6) {
    constexpr double kDegree = 0.017453292519943295;
    faults.misplaced = make_pose(so3::exp(kDegree * Eigen::Vector3d(v[3], v[4], v[5])),
                                 Eigen::Vector3d(v[0], v[1], v[2]));
  } else if (option == "--lost" && read >= 3) {
    faults.lost = v[0];
    faults.begin_s = v[1];
    faults.end_s = v[2];
    if (read > 3) faults.near_m = v[3];
  } else {
    return false;
  }
  return true;
}

inline Rig with_faults(Rig rig, const Faults& faults) {
  for (LidarInfo& lidar : rig.lidars)
    lidar.body_from_lidar = lidar.body_from_lidar * faults.misplaced;
  return rig;
}

/// `scan` with the faults; `t`: s since the first scan.
inline Scan with_faults(const Scan& scan, double t, const Faults& faults) {
  Scan faulty = scan;
  faulty.stamp += faults.clock;
  if (t < faults.begin_s || t >= faults.end_s) return faulty;
  SequentialRandom random(static_cast<std::uint64_t>(scan.stamp.count()), 1);
  const bool dusty = faults.near_m < 1e9;
  std::erase_if(faulty.points, [&](Point& point) {
    const double range = point.position.norm();
    if (dusty && random.uniform() < 0.2) {
      const double dust = 0.2 + random.uniform() * (faults.near_m - 0.2);
      if (dust < range) {
        point.position *= static_cast<float>(dust / range);
        return false;
      }
    }
    return random.uniform() < faults.lost;
  });
  return faulty;
}

}  // namespace lidarena
