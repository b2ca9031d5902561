// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/estimation/iterated_update.hpp"
#include "lidarena/map/local_planes.hpp"
#include "lidarena/odometry/arena_lio/config.hpp"
#include "lidarena/odometry/contacts.hpp"

namespace lidarena::odometry::arena_lio {

/// How a scan lies in the map.
struct Agreement {
  std::size_t points = 0;
  std::size_t near_planes = 0;  ///< points in a cell with a plane
  std::size_t on_planes = 0;    ///< of these, points on the plane, within the kernel's scale
  /// Of these or of all points, which should lie on planes: of all if the prior's position was less
  /// certain than the kernel's scale; then points in unknown cells speak against the estimate.
  std::size_t expected = 0;
  std::vector<Contact> contacts{};

  /// Share of the expected points that lie on planes.
  double share() const {
    return expected == 0 ? 0.0 : static_cast<double>(on_planes) / static_cast<double>(expected);
  }
  Agreement& operator+=(const Agreement& other) {
    points += other.points;
    near_planes += other.near_planes;
    on_planes += other.on_planes;
    expected += other.expected;
    contacts.insert(contacts.end(), other.contacts.begin(), other.contacts.end());
    return *this;
  }
};

/// Residuals of a scan's points (m, LiDAR frame at the scan's end) from the planes of the cells
/// that they lie in, with a kernel that narrows from one evaluation to the next: from the
/// uncertainty of the prior's position, so that a bad prediction does not lose the walls, to the
/// kernel's scale.
class PlaneResiduals {
 public:
  /// `seen_from`: of each point, the place of its LiDAR (m, in the frame of the points);
  /// `prior_sigma`: standard deviation (m) of the position before the update; `with_extrinsics`:
  /// whether the points also move the LiDAR on the IMU.
  PlaneResiduals(std::span<const Eigen::Vector3f> points,
                 std::span<const Eigen::Vector3f> seen_from, const map::LocalPlanes& map,
                 double prior_sigma, bool with_extrinsics, const Config& config,
                 const Parallel& parallel);

  /// The sums at `state`. Planes are always searched for: a search is one access to a table.
  estimation::NormalEquations<estimation::kPointDof> operator()(
      const estimation::InertialState& state, bool search);

  /// Number of evaluations until the kernel has its scale.
  int narrowing() const;

  /// After the update: how the points lie in the map at `state`, in cells of both sizes.
  Agreement agreement(const estimation::InertialState& state);

 private:
  void find_planes(const Pose& world_from_lidar, bool with_coarse = false);

  std::span<const Eigen::Vector3f> points_, seen_from_;
  const map::LocalPlanes& map_;
  const Config& config_;
  const Parallel& parallel_;
  bool with_extrinsics_;
  bool knew_the_place_;  ///< the prior was more certain than the kernel's scale
  double scale_;         ///< m, of the kernel in the next evaluation
  std::vector<Eigen::Vector3f> in_map_;
  std::vector<const map::MapPlane*> planes_;  ///< null: none
};

}  // namespace lidarena::odometry::arena_lio
