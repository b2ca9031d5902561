// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/base/se3.hpp"
#include "lidarena/estimation/scan_times.hpp"
#include "lidarena/map/voxel_hash_map.hpp"
#include "lidarena/odometry/lidar_path.hpp"
#include "lidarena/odometry/odometry.hpp"

/// Parameters and steps that both releases of KISS-ICP share: `kiss_icp`, v0.2 of 2023, and
/// `kiss_icp_head`, of late 2025. Paper: see kiss_icp/README.md.
namespace lidarena::odometry::kiss_icp {

/// The parameters of the published program. The defaults are those that both releases share.
struct Config {
  double max_range_m = 100.0;
  double min_range_m = 0.0;
  std::optional<double> voxel_size_m;  ///< unset: max_range_m / 100
  int max_points_per_voxel = 20;

  bool deskew = true;

  double initial_threshold_m = 2.0;
  double min_motion_m = 0.1;

  int max_iterations = 500;
  double convergence = 1e-4;

  double voxel_size() const { return voxel_size_m.value_or(max_range_m / 100.0); }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("max_range_m", self.max_range_m, "m",
      "farther points are dropped; also the local map's radius and the lever arm of the adaptive "
      "threshold",
      above(0));
    v("min_range_m", self.min_range_m, "m", "nearer points are dropped", at_least(0));
    v("voxel_size_m", self.voxel_size_m, "m",
      "voxel size of the map, null: max_range_m / 100; smaller is more accurate and slower",
      above(0));
    v("max_points_per_voxel", self.max_points_per_voxel, "",
      "maximum number of points in a map cell", Limits{1, 4096});
    v("deskew", self.deskew, "",
      "remove the motion within the scan, if its points carry times; a scan whose points all have "
      "the same time then loses all of them");
    v("initial_threshold_m", self.initial_threshold_m, "m",
      "initial sigma of the prediction's error; the search radius is 3 sigma", above(0));
    v("min_motion_m", self.min_motion_m, "m",
      "smaller errors of the prediction do not enter sigma; v0.2 counts none nearer to the start "
      "than 5 times this",
      at_least(0));
    v("max_iterations", self.max_iterations, "",
      "maximum number of ICP iterations; bounds the time of a scan that does not converge",
      at_least(1));
    v("convergence", self.convergence, "m and rad", "ICP ends when the norm of its step is smaller",
      at_least(0));
  }
};

using Points = std::vector<Eigen::Vector3f>;  ///< m

/// Edges of the cells of the two thinnings, in voxels of the map (paper, section III-B).
inline constexpr double kMapThinning = 0.5;
inline constexpr double kKeypointThinning = 1.5;

/// Twist per second (m/s, rad/s, lidar frame) within a scan: the `motion` between the previous two
/// poses divided by the duration of this scan (paper, eq. 2). Zero if the points have no times or
/// all the same.
se3::Vector6 twist_within(const estimation::ScanTimes& times, const Pose& motion);

/// The points between the minimum and the maximum range, both exclusive; none that are not finite.
Points in_range(const Points& points, const Config& config);

/// The scan's points within the range limits, in the lidar's frame at `instant`. Without a twist
/// they are as measured. A scan to be de-skewed whose points have all the same time has none: the
/// published program divides by the scan's duration.
Points preprocess(const Scan& scan, const estimation::ScanTimes& times,
                  const std::optional<se3::Vector6>& twist, Time instant, const Config& config,
                  const Parallel& parallel);

/// How a release assigns points to cells and orders the cells.
struct CellOrder {
  map::VoxelRounding rounding;
  std::uint32_t hash_factor_y;  ///< of a cell's y index, see map::spatial_hash()
};

/// The first point of each voxel (edge in m), with its own coordinates, in the order of the slots
/// of the published program's hash table. In this pseudo-random order, a second, coarser pass takes
/// its points from the whole duration of the scan and not only from its beginning.
Points thin(const Points& points, double voxel_size, const CellOrder& order);

/// Upper limit (m) on how far a prediction `error` (true pose relative to the predicted one) moves
/// a point at `range` m: |t| + 2 range sin(angle / 2) (paper, eq. 5 and 6).
double displacement(const Pose& error, double range);

/// Difference of a point and its counterpart, and its derivative with respect to a left increment
/// (translation, rotation about the origin) of the point's pose (paper, eq. 10). All in m, map
/// frame.
struct PointResidual {
  Eigen::Vector3d error;
  Eigen::Matrix<double, 3, 6> jacobian;
};
PointResidual point_to_point(const Eigen::Vector3d& point, const Eigen::Vector3d& counterpart);

/// Geman-McClure weight of a residual as in the published program, which adds a length to a squared
/// length: the residual at which the weight is 1/4 is sqrt(scale / 1 m) m.
double kernel_weight(double squared_error, double scale);

/// Limits of one registration.
struct IcpLimits {
  double max_distance_m = 0.0;  ///< between a keypoint and its counterpart
  double kernel_scale = 0.0;    ///< see kernel_weight()
  int max_iterations = 0;
  double convergence = 0.0;  ///< ICP ends when the norm of its step (m, rad) is smaller
};
/// For the adaptive threshold's `sigma` (m): a search radius of 3 sigma (paper, section III-C).
IcpLimits icp_limits(double sigma, double kernel_scale, const Config& config);

struct Registration {
  Pose map_from_lidar = Pose::Identity();
  int iterations = 0;
  std::size_t matches = 0;  ///< keypoints with a counterpart, in the last iteration
};

/// Point-to-point ICP of the de-skewed `keypoints` against `map`, from the pose `guess` (paper,
/// section III-D).
Registration register_points(const Points& keypoints, const map::VoxelHashMap& map,
                             const Pose& guess, const IcpLimits& limits, const Parallel& parallel);

/// Status of a scan of which `points` passed the range limits.
ScanStatus status_of(const Registration& registration, std::size_t points, bool map_is_empty);

/// Poses of the body within the scan, as used for de-skewing, for a lidar with this pose at
/// `instant`; empty if it was not de-skewed.
std::vector<StampedPose> motion_within(const estimation::ScanTimes& times,
                                       const se3::Vector6& twist, const Pose& map_from_lidar,
                                       Time instant, const LidarPath& path);

}  // namespace lidarena::odometry::kiss_icp
