// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/results/map_metrics.hpp"
#include "lidarena/world/world.hpp"

namespace lidarena::evaluation {

/// The alignment "robust": the map is fitted to the mesh itself; and how well that is determined.
struct MeshAlignment {
  static constexpr int kStarts = results::MeshFit::kStarts;
  static constexpr double kAgree_m = 0.02;    ///< results agree below this RMS motion of the map
  static constexpr double kMinInliers = 0.5;  ///< share within 20 cm; refused below this
  static constexpr double kUnobservable = 0.003;  ///< limit for the eigenvalues of the fit
  Pose mesh_from_map = Pose::Identity();
  std::string refusal;  ///< empty when the transform is reliable
  results::MeshFit fit;
  bool determined() const { return refusal.empty(); }
};

/// Trimmed point-to-plane ICP (Chen, Medioni 1992; Chetverikov 2005) of the map's 10 cm voxels to
/// the mesh from `start`, with Tukey's weight and a scale that decreases from 1 m (all points) over
/// 0.2 m to 3 x 1.4826 x the median residual (the nearest 95 % of the points). A narrower scale is
/// kept only if the map as a whole does not get clearly worse and the starts agree; otherwise a
/// bent map would be aligned by one of its parts. Steps along directions with an eigenvalue below
/// kUnobservable are left out (solution remapping, Zhang, Kaess, Singh 2016). The map is never
/// scaled. Refused when fewer than half of the points end within 20 cm, when fewer than three of
/// five starts (off by 20 cm and 2 degrees) agree, or with fewer than 100 points. Minimizes nearly
/// the error that is reported: it removes the rigid part of the drift, but no bending.
MeshAlignment align_to_mesh(std::span<const Eigen::Vector3f> map, const Pose& start,
                            const world::World& world, const Parallel& parallel);

}  // namespace lidarena::evaluation
