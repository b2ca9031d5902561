// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "lidarena/map/local_planes.hpp"

namespace lidarena::odometry {

/// A point of a scan that lies on a plane of the map.
struct Contact {
  Eigen::Vector3f arm;     ///< m, from the sensor, in the map's axes
  Eigen::Vector3f normal;  ///< of the plane
  float normal_error;      ///< rad, a bound
};

/// The contacts of points that are seen from `sensor` (m, in the map): each with the plane of its
/// coarse cell, whose normal is known better, if it lies within `max_distance` (m) of it, else with
/// that of its fine cell. Points on neither have none.
std::vector<Contact> contacts_of(std::span<const Eigen::Vector3f> points,
                                 const Eigen::Vector3f& sensor, const map::LocalPlanes& map,
                                 double max_distance);

/// Whether a scan alone leaves a direction of its position or rotation open: the standard deviation
/// exceeds 5 cm or 1 degree. Each contact stands for so many returns, each with 2 cm of noise. A
/// contact tells of a direction only what the error of its normal cannot feign: in a bare corridor
/// errors of normals look like something that is seen along it. Without contacts all are open.
bool leaves_a_direction_open(std::span<const Contact> contacts, double returns_per_contact);

}  // namespace lidarena::odometry
