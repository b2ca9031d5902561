// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace lidarena::world {

/// A triangle abc in coordinates of its plane: a at the origin, b at (base, 0), c at (x, y) with
/// y > 0. Holds the precomputed values for many distance queries against the same triangle.
class TriangleFrame {
 public:
  TriangleFrame(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c)
      : origin_(a), along_((b - a).normalized()), normal_((b - a).cross(c - a).normalized()) {
    across_ = normal_.cross(along_);
    base_ = (b - a).norm();
    apex_x_ = along_.dot(c - a);
    apex_y_ = across_.dot(c - a);
    side_bc_ = (apex_x_ - base_) * (apex_x_ - base_) + apex_y_ * apex_y_;
    side_ca_ = apex_x_ * apex_x_ + apex_y_ * apex_y_;
  }

  /// Squared distance of `p` to the triangle, up to rounding; infinity when its distance to the
  /// plane alone exceeds `limit` (squared).
  double squared_distance(const Eigen::Vector3d& p, double limit) const {
    const Eigen::Vector3d d = p - origin_;
    const double height = normal_.dot(d);
    const double above = height * height;
    if (above > limit) return std::numeric_limits<double>::infinity();
    return above + squared_distance_in_plane(along_.dot(d), across_.dot(d));
  }

 private:
  /// Only edges that the point lies outside of need to be checked.
  double squared_distance_in_plane(double x, double y) const {
    double nearest = std::numeric_limits<double>::infinity();
    if (y < 0.0) nearest = to_edge(x, y, base_, 0.0, base_ * base_);
    const double ux = apex_x_ - base_;
    if (ux * y - apex_y_ * (x - base_) < 0.0) {
      nearest = std::min(nearest, to_edge(x - base_, y, ux, apex_y_, side_bc_));
    }
    if (apex_y_ * x - apex_x_ * y < 0.0) {
      nearest = std::min(nearest, to_edge(x, y, apex_x_, apex_y_, side_ca_));
    }
    return nearest == std::numeric_limits<double>::infinity() ? 0.0 : nearest;
  }

  /// Squared distance of (x, y) to the segment from the origin to (ux, uy); `length2` is the
  /// squared length of the segment.
  static double to_edge(double x, double y, double ux, double uy, double length2) {
    const double along = std::clamp((x * ux + y * uy) / length2, 0.0, 1.0);
    const double dx = x - along * ux;
    const double dy = y - along * uy;
    return dx * dx + dy * dy;
  }

  Eigen::Vector3d origin_, along_, across_, normal_;
  double base_, apex_x_, apex_y_, side_bc_, side_ca_;
};

}  // namespace lidarena::world
