// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/estimation/motion_filter.hpp"
#include "lidarena/map/local_planes.hpp"
#include "lidarena/odometry/arena_lo/config.hpp"
#include "lidarena/odometry/arena_lo/slices.hpp"
#include "lidarena/odometry/contacts.hpp"

namespace lidarena::odometry::arena_lo {

/// How points lie on the planes of the map.
struct Measurement {
  /// Derivatives of the cost by the pose (position, rotation), in units of its variance.
  estimation::NormalEquations<6> equations;
  std::size_t points = 0;
  double sum_of_scales = 0.0;   ///< m, of the kernels of all points
  std::size_t near_planes = 0;  ///< points in a cell with a plane
  std::size_t on_planes = 0;    ///< of these, points on the plane, within the kernel's scale

  Measurement& operator+=(const Measurement& other);
};

/// Distances of `points` (m, lidar frame) from the planes of the cells in which they lie with the
/// pose at `at`. A kernel takes weight from points that do not lie on the plane of their cell. It
/// is as wide as the point's position is uncertain, but not narrower than `least_scale` (m), and
/// its width is also the measure of the point's variance.
Measurement measure(std::span<const Eigen::Vector3f> points, const estimation::MotionEstimate& at,
                    double least_scale, const map::LocalPlanes& map, const Config& config,
                    const Parallel& parallel);

/// What is known before a scan: the motion at an earlier instant.
struct Known {
  estimation::MotionEstimate estimate;
  Time instant{0};
};

/// The motion of a scan: at the middle of each slice, and at the scan's end; given the measurements
/// up to each instant, and given those of the whole scan.
using Steps = std::vector<estimation::MotionStep>;
using Motion = std::vector<estimation::MotionEstimate>;

/// The motion as it continues without measurements.
Steps coast(const Known& before, std::span<const Slice> slices, Time end, const Config& config);

struct Registration {
  Steps steps;
  Motion motion;
  Measurement measurement;  ///< in the last pass, of all slices
  std::size_t passes = 0;
  std::vector<Contact> contacts{};  ///< of all slices
};

/// Aligns a scan with the map. Each pass filters the slices in their order and smooths them: an
/// iterated Kalman smoother, which is Gauss-Newton on all slices (B. Bell, "The Iterated Kalman
/// Smoother as a Gauss-Newton Method", SIAM J. Optimization 1994). The first pass measures each
/// slice where those before it predict it; the kernel narrows from pass to pass.
Registration register_slices(const Known& before, std::span<const Slice> slices, Time end,
                             const map::LocalPlanes& map, const Config& config,
                             const Parallel& parallel);

}  // namespace lidarena::odometry::arena_lo
