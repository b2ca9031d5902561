// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/estimation/point_to_plane.hpp"
#include "lidarena/map/kd_tree.hpp"

namespace lidarena::odometry::fast_lio2 {

using Neighbors = std::array<map::Neighbor, 5>;

/// Residuals of a scan's points (m, LiDAR's frame at the scan's end) from the planes through their
/// five nearest points of the map (section IV-C, eq. 12-14).
class PlaneResiduals {
 public:
  PlaneResiduals(std::span<const Eigen::Vector3f> points, const map::KdTree& map,
                 bool estimate_extrinsics, const Parallel& parallel);

  /// The sums at `state`. Without `search` the planes are those of the search before, and points
  /// that were off their plane since then stay out.
  estimation::NormalEquations<estimation::kPointDof> operator()(
      const estimation::InertialState& state, bool search);
  /// The map's points nearest to each point, of the last search.
  const std::vector<Neighbors>& neighbors() const { return neighbors_; }

 private:
  /// Neighbors and plane of the point with index `i`, which is at `point` (m) in the map.
  void find(std::size_t i, const Eigen::Vector3f& point);

  std::span<const Eigen::Vector3f> points_;
  const map::KdTree& map_;
  bool estimate_extrinsics_;
  const Parallel& parallel_;
  std::vector<Neighbors> neighbors_;
  estimation::PointPlanes fitted_;  ///< through the neighbors, whether or not still in use
  estimation::PointPlanes planes_;
};

}  // namespace lidarena::odometry::fast_lio2
