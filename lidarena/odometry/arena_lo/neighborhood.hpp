// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "lidarena/estimation/elastic_alignment.hpp"
#include "lidarena/map/voxel_hash_map.hpp"
#include "lidarena/odometry/arena_lo/config.hpp"

namespace lidarena::odometry::arena_lo {

/// Shape of the map's points around a keypoint (CT-ICP, III-B). With the eigenvalues l1 >= l2 >= l3
/// of their covariance and s = sqrt(l):
struct Neighborhood {
  Eigen::Vector3d anchor;       ///< m, world, see PlanePoint
  Eigen::Vector3d normal;       ///< unit eigenvector of l3
  Eigen::Vector3d line;         ///< unit eigenvector of l1
  Eigen::Vector3d eigenvalues;  ///< m^2, l3 first
  double planarity = 0.0;       ///< (s2 - s3) / s1
  double linearity = 0.0;       ///< (s1 - s2) / s1
};

/// Planarity and linearity are 0 when all neighbors coincide.
Neighborhood describe(std::span<const map::Neighbor> neighbors, PlanePoint plane_point);

/// Match of a keypoint with the neighborhood's plane, with the published program's weight
/// c1 planarity^2 + c2 exp(-distance / (max_plane_distance_m min_neighbors)), c1 + c2 = 1.
estimation::ElasticMatch plane_match(const Neighborhood& neighborhood,
                                     const Eigen::Vector3d& keypoint,
                                     const RegistrationConfig& config);

/// Match with a line, a plane or a distribution, by the neighborhood's shape; the weight is the
/// square of the linearity or planarity, or 0.1.
estimation::ElasticMatch shape_match(const Neighborhood& neighborhood);

}  // namespace lidarena::odometry::arena_lo
