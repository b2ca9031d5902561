// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "lidarena/estimation/elastic_alignment.hpp"
#include "lidarena/map/voxel_hash_map.hpp"
#include "lidarena/odometry/ct_icp/config.hpp"

namespace lidarena::ct_icp {

/// How the map's points about a keypoint lie (CT-ICP, III-B). With eigenvalues l1 >= l2 >= l3 of
/// their covariance and s = sqrt(l):
struct Neighborhood {
  Eigen::Vector3d anchor;       ///< m, world, see PlanePoint
  Eigen::Vector3d normal;       ///< unit, of l3
  Eigen::Vector3d line;         ///< unit, of l1
  Eigen::Vector3d eigenvalues;  ///< m^2, l3 first
  double planarity = 0.0;       ///< (s2 - s3) / s1
  double linearity = 0.0;       ///< (s1 - s2) / s1
};

/// Both measures are 0 when all neighbors coincide.
Neighborhood describe(std::span<const Neighbor> neighbors, PlanePoint plane_point);

/// What a keypoint should lie on: the neighborhood's plane, with the weight
/// c1 planarity^2 + c2 exp(-distance / (gate min_neighbors)) of the public program (c1 + c2 = 1).
ElasticMatch plane_match(const Neighborhood& neighborhood, const Eigen::Vector3d& keypoint,
                         const RegistrationConfig& config);

/// Likewise a line, a plane or a distribution, whatever the neighborhood is; weighed by the
/// square of linearity or planarity, or by 0.1.
ElasticMatch shape_match(const Neighborhood& neighborhood);

}  // namespace lidarena::ct_icp
