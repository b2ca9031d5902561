// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/elastic_motion.hpp"

#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::ct_icp {

namespace {
constexpr double kStraight = 1e-9;  // rad; below this, a scan counts as not rotating
// Below this angle (rad) quotients of canceling terms are replaced by the first term of their
// series; the next term is smaller by the square of the angle.
constexpr double kSmall = 1e-4;
}  // namespace

Pose ElasticMotion::at(double alpha) const { return interpolate(begin, end, alpha); }

MotionChange change_between(const ElasticMotion& a, const ElasticMotion& b) {
  MotionChange change;
  const auto add = [&](const Pose& from, const Pose& to) {
    change.translation_m += (to.translation() - from.translation()).norm();
    change.rotation_rad += so3::angle(from.linear().transpose() * to.linear());
  };
  add(a.begin, b.begin);
  add(a.end, b.end);
  return change;
}

ElasticTrack::ElasticTrack(const ElasticMotion& motion)
    : from_(motion.begin.linear()),
      begin_(motion.begin.translation()),
      step_(motion.end.translation() - motion.begin.translation()) {
  const Eigen::Matrix3d end = motion.end.linear();
  const Eigen::Vector3d turn = so3::log(end * from_.transpose());
  const double angle = turn.norm();
  if (angle < kStraight) return;
  axis_ = turn / angle;
  angle_ = angle;
  half_cotangent_ =
      angle < kSmall ? angle * angle / 12.0 : 1.0 - 0.5 * angle / std::tan(0.5 * angle);
}

Eigen::Vector3d ElasticTrack::place(const Eigen::Vector3d& point, double alpha) const {
  const Eigen::Vector3d rotated = from_ * point;
  const Eigen::Vector3d across = axis_.cross(rotated);
  const double turn = alpha * angle_;
  return rotated + std::sin(turn) * across + (1.0 - std::cos(turn)) * axis_.cross(across) + begin_ +
         alpha * step_;
}

// With K = hat(axis), K^3 = -K, the rotation of the slerp at alpha changes by (I - A) times the
// begin's increment plus A times the end's, A = alpha J_l(alpha angle) J_l(angle)^-1 (left
// Jacobians of SO(3), Sola et al. 2018, eq. 145 and 146): both factors are polynomials in K, and so
// is A.
ElasticTrack::Row ElasticTrack::row(const Eigen::Vector3d& point, double alpha,
                                    const Eigen::Vector3d& direction) const {
  const double turn = alpha * angle_;
  const double sine = std::sin(turn);
  const double versine = 1.0 - std::cos(turn);
  // Coefficients of these polynomials:
  const double u = turn < kSmall ? 0.5 * turn : versine / turn;            // of K in J_l
  const double v = turn < kSmall ? turn * turn / 6.0 : 1.0 - sine / turn;  // of K^2 in J_l
  const double h = 0.5 * angle_;                                           // J_l^-1: -h K
  const double w = half_cotangent_;                                        // and w K^2
  const double first = u - h - u * w + v * h;                              // of K in A / alpha
  const double second = v + w - u * h - v * w;                             // of K^2 in A / alpha

  const Eigen::Vector3d start = from_ * point;
  const Eigen::Vector3d across = axis_.cross(start);
  const Eigen::Vector3d rotated = start + sine * across + versine * axis_.cross(across);
  const Eigen::Vector3d lever = rotated.cross(direction);
  const Eigen::Vector3d turned = axis_.cross(lever);
  const Eigen::Vector3d last = alpha * (lever - first * turned + second * axis_.cross(turned));
  Row row;
  row << (1.0 - alpha) * direction.transpose(), (lever - last).transpose(),
      alpha * direction.transpose(), last.transpose();
  return row;
}

std::vector<TimedPoint> timed_points(const Scan& scan, const estimation::ScanTimes& times,
                                     bool rigid) {
  const auto begin = static_cast<double>((times.first - scan.stamp).count());
  const auto length = static_cast<double>((times.last - times.first).count());
  const double per_ns = rigid ? 0.0 : 1.0 / length;
  std::vector<TimedPoint> points;
  points.reserve(scan.points.size());
  for (const Point& point : scan.points) {
    if (!point.position.allFinite()) continue;
    const double alpha = rigid ? 1.0 : (point.dt_ns - begin) * per_ns;
    points.push_back({point.position, static_cast<float>(alpha)});
  }
  return points;
}

std::vector<Eigen::Vector3f> placed(const Pose& by, const ElasticMotion& motion,
                                    std::span<const TimedPoint> points, const Parallel& parallel) {
  const ElasticTrack track({by * motion.begin, by * motion.end});
  std::vector<Eigen::Vector3f> positions(points.size());
  parallel.for_each(points.size(), kPointGrain, [&](std::size_t i) {
    const Eigen::Vector3d point = points[i].position.cast<double>();
    positions[i] = track.place(point, points[i].alpha).cast<float>();
  });
  return positions;
}

std::vector<StampedPose> body_poses(const ElasticMotion& motion, const estimation::ScanTimes& times,
                                    const Pose& body_from_lidar) {
  const Pose lidar_from_body = body_from_lidar.inverse();
  return {{times.first, body_from_lidar * motion.begin * lidar_from_body},
          {times.last, body_from_lidar * motion.end * lidar_from_body}};
}

}  // namespace lidarena::odometry::ct_icp
