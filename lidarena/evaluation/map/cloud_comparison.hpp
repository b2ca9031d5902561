// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "lidarena/base/parallel.hpp"

/// Scores of a map without a mesh: against a reference cloud, and by itself.
namespace lidarena::evaluation {

/// A map against a reference cloud in the same frame. Distances go to the nearest point of the
/// other cloud, so that they are not below half the spacing of its points.
struct CloudComparison {
  double accuracy_m = 0.0;      ///< mean distance of the map's points from the reference
  double completeness_m = 0.0;  ///< mean distance of the reference's points from the map
  double chamfer_m = 0.0;       ///< mean of both (symmetric, of distances, not of squares)
  double f_score_5cm = 0.0;     ///< harmonic mean of the shares of both that are within 5 cm
  double f_score_10cm = 0.0;    ///< likewise
  std::size_t map_points = 0;   ///< finite ones
  std::size_t reference_points = 0;
};

/// Precision, recall and F-score as in A. Knapitsch et al., "Tanks and Temples", ACM TOG 36(4),
/// 2017. Throws InputError (place `name`) when a cloud has no finite point.
CloudComparison compare_clouds(std::span<const Eigen::Vector3f> map,
                               std::span<const Eigen::Vector3f> reference, const std::string& name,
                               const Parallel& parallel);

/// How far a map agrees with itself.
struct MapAgreement {
  /// Mean map entropy: mean of 0.5 ln det(2 pi e C), C the covariance (m^2) of the points within
  /// 0.3 m (D. Droeschel, S. Behnke, "Local multi-resolution representation for 6D motion
  /// estimation and mapping with a continuously rotating 3D laser scanner", ICRA 2014).
  double mean_map_entropy = 0.0;
  /// Root of the mean plane variance, m: the smallest eigenvalue of C, of the flattest half of the
  /// neighborhoods, where there is a plane (J. Razlaw et al., "Evaluation of registration methods
  /// for sparse 3D laser scans", ECMR 2015, takes the upper quartile over all).
  double plane_thickness_m = 0.0;
  std::size_t neighborhoods = 0;  ///< with 15 points or more; 0: the others are not known
};

/// Looks at up to 20,000 points, evenly spaced in the map's order.
MapAgreement map_agreement(std::span<const Eigen::Vector3f> map, const Parallel& parallel);

}  // namespace lidarena::evaluation
