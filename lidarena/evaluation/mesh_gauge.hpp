// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena {

/// The gauge "robust": the map laid onto the mesh itself, and what that rests on.
struct MeshAlignment {
  static constexpr int kStarts = 5;               ///< the given pose and four around it
  static constexpr double kAgree_m = 0.02;        ///< RMS move of the map between two results
  static constexpr double kLeastInliers = 0.5;    ///< share within 20 cm; below, refused
  static constexpr double kUnobservable = 0.003;  ///< of the eigenvalues below
  Pose mesh_from_map = Pose::Identity();
  std::string refusal;     ///< empty when the transform is to be trusted
  std::size_t points = 0;  ///< of the map's 10 cm voxels, what was fitted
  int iterations = 0;
  double inlier_share = 0.0;  ///< of these points, within 20 cm of the mesh afterwards
  int agreeing_starts = 0;    ///< of kStarts
  /// Rising, of the Gauss-Newton Hessian a point, in moves that shift the points by 1 m RMS: the
  /// mean square that such a move adds to the distances, 0 (nothing holds it) to 1. A closed room
  /// has 0.1 and more everywhere; an endless corridor has a zero.
  Eigen::Matrix<double, 6, 1> eigenvalues = Eigen::Matrix<double, 6, 1>::Zero();
  /// Directions that the surface does not hold, left as the start had them: "translation along
  /// (1.00, 0.00, 0.00)", "rotation about (...)", mesh frame.
  std::vector<std::string> frozen;
  double moved_m = 0.0;     ///< of the points' centroid, from the start
  double turned_rad = 0.0;  ///< from the start
  bool determined() const { return refusal.empty(); }
};

/// Trimmed point-to-plane ICP (Chen, Medioni 1992; Chetverikov 2005) of the map's 10 cm voxels to
/// the mesh from `start`, by Tukey's weight with a scale that falls from 1 m (all points) over 0.2
/// m to 3 x 1.4826 x the median residual (the nearest 95 % of the points). A narrower scale is kept
/// while the map as a whole does not get clearly worse and the starts agree: a bent map would be
/// laid onto the mesh by one part. Steps along directions with an eigenvalue below kUnobservable
/// are left out (solution remapping, Zhang, Kaess, Singh 2016). Never scales. Refused when fewer
/// than half of the points end within 20 cm, when fewer than three of five starts (off by 20 cm and
/// 2 degrees) agree, or with fewer than 100 points. Minimizes nearly what is reported: the rigid
/// part of a drift is gone, a bend stays.
MeshAlignment align_to_mesh(std::span<const Eigen::Vector3f> map, const Pose& start,
                            const World& world, const Parallel& parallel);

}  // namespace lidarena
