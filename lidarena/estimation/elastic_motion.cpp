// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/elastic_motion.hpp"

#include <algorithm>
#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::estimation {

namespace {
constexpr double kStraightSegment = 1e-9;  // rad; below this, a segment counts as not rotating
// Below this angle (rad) quotients of canceling terms are replaced by the first term of their
// series; the next term is smaller by the square of the angle.
constexpr double kSmall = 1e-4;
}  // namespace

ElasticMotion ElasticMotion::still(const Pose& pose, int segments) {
  return {std::vector<Pose>(static_cast<std::size_t>(segments) + 1, pose)};
}

Pose ElasticMotion::at(double alpha) const {
  const double position = std::clamp(alpha, 0.0, 1.0) * static_cast<double>(segments());
  const std::size_t first = std::min(static_cast<std::size_t>(position), segments() - 1);
  return interpolate(knots[first], knots[first + 1], position - static_cast<double>(first));
}

MotionChange change_between(const ElasticMotion& a, const ElasticMotion& b) {
  MotionChange change;
  const auto add = [&](const Pose& from, const Pose& to) {
    change.translation_m += (to.translation() - from.translation()).norm();
    change.rotation_rad += so3::angle(from.linear().transpose() * to.linear());
  };
  add(a.begin(), b.begin());
  add(a.end(), b.end());
  return change;
}

ElasticSegment::ElasticSegment(const Pose& from, const Pose& to)
    : from_(from.linear()),
      begin_(from.translation()),
      step_(to.translation() - from.translation()),
      axis_(Eigen::Vector3d::UnitZ()),
      angle_(0.0),
      half_cotangent_(0.0) {
  const Eigen::Matrix3d end = to.linear();
  const Eigen::Vector3d turn = so3::log(end * from_.transpose());
  const double angle = turn.norm();
  if (angle < kStraightSegment) return;
  axis_ = turn / angle;
  angle_ = angle;
  half_cotangent_ =
      angle < kSmall ? angle * angle / 12.0 : 1.0 - 0.5 * angle / std::tan(0.5 * angle);
}

Eigen::Vector3d ElasticSegment::place(const Eigen::Vector3d& point, double a) const {
  const Eigen::Vector3d rotated = from_ * point;
  const Eigen::Vector3d across = axis_.cross(rotated);
  const double turn = a * angle_;
  return rotated + std::sin(turn) * across + (1.0 - std::cos(turn)) * axis_.cross(across) + begin_ +
         a * step_;
}

// With K = hat(axis), K^3 = -K, the rotation of the slerp at a changes by (I - A) times the first
// knot's increment plus A times the second's, A = a J_l(a angle) J_l(angle)^-1 (left Jacobians of
// SO(3), Sola et al. 2018, eq. 145 and 146): both factors are polynomials in K, and so is A.
ElasticSegment::Row ElasticSegment::row(const Eigen::Vector3d& point, double a,
                                        const Eigen::Vector3d& direction) const {
  const double turn = a * angle_;
  const double sine = std::sin(turn);
  const double versine = 1.0 - std::cos(turn);
  // Coefficients of these polynomials:
  const double u = turn < kSmall ? 0.5 * turn : versine / turn;            // of K in J_l
  const double v = turn < kSmall ? turn * turn / 6.0 : 1.0 - sine / turn;  // of K^2 in J_l
  const double h = 0.5 * angle_;                                           // J_l^-1: -h K
  const double w = half_cotangent_;                                        // and w K^2
  const double first = u - h - u * w + v * h;                              // of K in A / a
  const double second = v + w - u * h - v * w;                             // of K^2 in A / a

  const Eigen::Vector3d start = from_ * point;
  const Eigen::Vector3d across = axis_.cross(start);
  const Eigen::Vector3d rotated = start + sine * across + versine * axis_.cross(across);
  const Eigen::Vector3d lever = rotated.cross(direction);
  const Eigen::Vector3d turned = axis_.cross(lever);
  const Eigen::Vector3d last = a * (lever - first * turned + second * axis_.cross(turned));
  Row row;
  row << (1.0 - a) * direction.transpose(), (lever - last).transpose(), a * direction.transpose(),
      last.transpose();
  return row;
}

ElasticTrack::ElasticTrack(const ElasticMotion& motion) {
  segments_.reserve(motion.segments());
  for (std::size_t i = 0; i < motion.segments(); ++i)
    segments_.emplace_back(motion.knots[i], motion.knots[i + 1]);
}

ElasticTrack::Place ElasticTrack::locate(double alpha) const {
  const double position = alpha * static_cast<double>(segments_.size());
  const std::size_t segment = std::min(static_cast<std::size_t>(position), segments_.size() - 1);
  return {segment, position - static_cast<double>(segment)};
}

Eigen::Vector3d ElasticTrack::place(const Eigen::Vector3d& point, double alpha) const {
  const auto [segment, a] = locate(alpha);
  return segments_[segment].place(point, a);
}

}  // namespace lidarena::estimation
