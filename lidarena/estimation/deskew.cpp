// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/deskew.hpp"

#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::estimation {

namespace {
constexpr double kStraight = 1e-9;  // rad/s; below counts as straight: 0.5 nm error per m and s
}  // namespace

ConstantTwist::ConstantTwist(const se3::Vector6& twist_per_second)
    : twist_(twist_per_second), rate_(twist_.tail<3>().norm()) {
  if (rate_ < kStraight) return;
  const Eigen::Vector3d velocity = twist_.head<3>();
  axis_ = twist_.tail<3>() / rate_;
  along_ = axis_ * axis_.dot(velocity);
  across_ = (velocity - along_) / rate_;
  turned_ = axis_.cross(velocity) / rate_;
  skew_ = so3::hat(axis_);
  skew_squared_ = skew_ * skew_;
}

Pose ConstantTwist::at(double seconds) const {
  if (rate_ < kStraight) return se3::exp(twist_ * seconds);
  const double sine = std::sin(rate_ * seconds);
  const double cosine = std::cos(rate_ * seconds);
  // Rodrigues' formula, and the left Jacobian times rho, split along and across the axis
  return make_pose(Eigen::Matrix3d::Identity() + sine * skew_ + (1.0 - cosine) * skew_squared_,
                   sine * across_ + seconds * along_ + (1.0 - cosine) * turned_);
}

std::vector<Eigen::Vector3f> deskew(const Scan& scan, const se3::Vector6& twist_per_second,
                                    Time reference, const Parallel& parallel) {
  if (!scan.timed) return positions(scan);
  const ConstantTwist reference_from_instant(twist_per_second);
  std::vector<Eigen::Vector3f> moved(scan.points.size());
  parallel.for_each(scan.points.size(), kPointGrain, [&](std::size_t i) {
    const Point& point = scan.points[i];
    const double seconds = to_seconds(time_of(scan, point) - reference);
    moved[i] = (reference_from_instant.at(seconds) * point.position.cast<double>()).cast<float>();
  });
  return moved;
}

std::vector<Eigen::Vector3f> positions(const Scan& scan) {
  std::vector<Eigen::Vector3f> measured;
  measured.reserve(scan.points.size());
  for (const Point& point : scan.points) measured.push_back(point.position);
  return measured;
}

}  // namespace lidarena::estimation
