// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "lidarena/base/pose.hpp"

namespace lidarena::estimation {

/// Motion during one scan: at least two poses (knots) at equal time steps from its first to its
/// last instant. Between neighbors: linear in position, spherical-linear in rotation. With two
/// knots it is the elastic scan of Dellenbach, Deschaud, Jacquet, Goulette, "CT-ICP" (ICRA 2022,
/// III-B).
struct ElasticMotion {
  std::vector<Pose> knots;

  /// `segments` + 1 knots, all at `pose`.
  static ElasticMotion still(const Pose& pose, int segments);
  std::size_t segments() const { return knots.size() - 1; }
  const Pose& begin() const { return knots.front(); }
  const Pose& end() const { return knots.back(); }
  /// Pose at `alpha`: 0 first, 1 last instant of the scan.
  Pose at(double alpha) const;
};

/// Difference between two motions: sums over first and last knot.
struct MotionChange {
  double translation_m = 0.0;
  double rotation_rad = 0.0;
};
MotionChange change_between(const ElasticMotion& a, const ElasticMotion& b);

/// The motion between two neighboring knots, with precomputed coefficients, so that transforming a
/// point costs one sine and one cosine. `a` in [0, 1] goes from one knot to the next.
class ElasticSegment {
 public:
  using Row = Eigen::Matrix<double, 1, 12>;

  ElasticSegment(const Pose& from, const Pose& to);

  /// World position of a point (lidar frame) measured at `a`.
  Eigen::Vector3d place(const Eigen::Vector3d& point, double a) const;

  /// Derivative of direction . place(point, a) with respect to left increments (translation,
  /// rotation about the knot's own position) of the two knots, in this order. Exact, with the
  /// Jacobian of the slerp.
  Row row(const Eigen::Vector3d& point, double a, const Eigen::Vector3d& direction) const;

 private:
  Eigen::Matrix3d from_;
  Eigen::Vector3d begin_;
  Eigen::Vector3d step_;
  Eigen::Vector3d axis_;   ///< unit, world
  double angle_;           ///< rad
  double half_cotangent_;  ///< 1 - angle / 2 cot(angle / 2)
};

/// The segments of a motion, and the lookup of the segment for an alpha of the scan.
class ElasticTrack {
 public:
  explicit ElasticTrack(const ElasticMotion& motion);

  struct Place {
    std::size_t segment;
    double a;
  };
  Place locate(double alpha) const;
  const ElasticSegment& segment(std::size_t index) const { return segments_[index]; }
  std::size_t size() const { return segments_.size(); }
  /// World position of a point (lidar frame) measured at `alpha` of the scan.
  Eigen::Vector3d place(const Eigen::Vector3d& point, double alpha) const;

 private:
  std::vector<ElasticSegment> segments_;
};

}  // namespace lidarena::estimation
