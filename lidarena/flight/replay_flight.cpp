// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/replay_flight.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "lidarena/base/error.hpp"
#include "lidarena/base/so3.hpp"
#include "lidarena/flight/rotation_rates.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Coefficients = Eigen::Matrix<double, 3, 6>;

/// First and second derivative at one pose.
struct Rates {
  Vector3d first = Vector3d::Zero(), second = Vector3d::Zero();
};

struct Node {
  Rates position, rotation;
};

/// Derivatives at pose `i` of the polynomial through it and up to four neighbors, two on each side
/// where possible.
Node node_at(std::span<const StampedPose> poses, std::size_t i) {
  const std::size_t count = std::min<std::size_t>(5, poses.size());
  const std::size_t first = std::min(i - std::min<std::size_t>(i, 2), poses.size() - count);
  const Pose& here = poses[i].world_from_body;
  const double scale = to_seconds(poses[first + count - 1].stamp - poses[first].stamp);
  // one row per neighbor: step = [t t^2 t^3 ...] * coefficients, with time in units of `scale`
  const auto n = static_cast<Eigen::Index>(count - 1);
  Eigen::MatrixXd powers(n, n);
  Eigen::MatrixXd steps(n, 6);
  Eigen::Index row = 0;
  for (std::size_t k = first; k < first + count; ++k) {
    if (k == i) continue;
    const Pose& there = poses[k].world_from_body;
    const double t = to_seconds(poses[k].stamp - poses[i].stamp) / scale;
    for (Eigen::Index power = 0; power < n; ++power) {
      powers(row, power) = std::pow(t, static_cast<double>(power + 1));
    }
    steps.row(row).head<3>() = there.translation() - here.translation();
    steps.row(row).tail<3>() = so3::log(here.linear().transpose() * there.linear());
    ++row;
  }
  const Eigen::MatrixXd c = powers.partialPivLu().solve(steps);
  Eigen::Matrix<double, 6, 1> first_rates = c.row(0).transpose() / scale;
  Eigen::Matrix<double, 6, 1> second_rates = Eigen::Matrix<double, 6, 1>::Zero();
  if (n > 1) second_rates = 2.0 * c.row(1).transpose() / (scale * scale);
  return {{first_rates.head<3>(), second_rates.head<3>()},
          {first_rates.tail<3>(), second_rates.tail<3>()}};
}

/// The quintic polynomial over [0, 1] with these end values and derivatives; the interval lasts `h`
/// seconds and the derivatives are per second.
Coefficients quintic(const Vector3d& from, const Rates& begin, const Vector3d& to, const Rates& end,
                     double h) {
  const Vector3d v0 = h * begin.first;
  const Vector3d v1 = h * end.first;
  const Vector3d a0 = h * h * begin.second;
  const Vector3d a1 = h * h * end.second;
  const Vector3d d = to - from;
  Coefficients c;
  c << from, v0, 0.5 * a0, 10.0 * d - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1,
      -15.0 * d + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1, 6.0 * d - 3.0 * (v0 + v1) - 0.5 * (a0 - a1);
  return c;
}

/// Derivatives of the rotation vector `v` that give the body rate and acceleration `body`.
Rates vector_rates(const Vector3d& v, const Rates& body) {
  const Matrix3d inverse = so3::right_jacobian_inverse(v);
  const Vector3d first = inverse * body.first;
  return {first, inverse * (body.second - body_acceleration(v, first, Vector3d::Zero()))};
}

struct Derivatives {
  Vector3d value, first, second;
};

Vector3d value_at(const Coefficients& c, double u) {
  Vector3d value = c.col(5);
  for (int i = 4; i >= 0; --i) value = value * u + c.col(i);
  return value;
}

Derivatives derivatives_at(const Coefficients& c, double u, double h) {
  Vector3d first = 5.0 * c.col(5);
  for (int i = 4; i >= 1; --i) first = first * u + i * c.col(i);
  Vector3d second = 20.0 * c.col(5);
  for (int i = 4; i >= 2; --i) second = second * u + i * (i - 1) * c.col(i);
  return {value_at(c, u), first / h, second / (h * h)};
}

}  // namespace

ReplayFlight::ReplayFlight(const Trajectory& recording, const std::string& name) {
  const auto poses = recording.poses();
  if (poses.size() < 2) {
    throw InputError(name, "has " + std::to_string(poses.size()) + " pose(s)",
                     "a replay needs at least two");
  }
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const Node begin = node_at(poses, i);
    const Node end = node_at(poses, i + 1);
    const Pose& from = poses[i].world_from_body;
    const Pose& to = poses[i + 1].world_from_body;
    const double h = to_seconds(poses[i + 1].stamp - poses[i].stamp);
    const Vector3d rotation_vector = so3::log(from.linear().transpose() * to.linear());
    Piece piece{
        .world_from_begin = from.linear(),
        .position = quintic(from.translation(), begin.position, to.translation(), end.position, h),
        .rotation = quintic(Vector3d::Zero(), begin.rotation, rotation_vector,
                            vector_rates(rotation_vector, end.rotation), h),
        .begin = poses[i].stamp - recording.begin_time(),
        .length_s = h};
    pieces_.push_back(piece);
    ends_.push_back(poses[i + 1].stamp - recording.begin_time());
  }
}

const ReplayFlight::Piece& ReplayFlight::piece_at(Time t) const {
  const auto end = std::upper_bound(ends_.begin(), ends_.end() - 1, t);
  return pieces_[static_cast<std::size_t>(end - ends_.begin())];
}

Pose ReplayFlight::pose_at(Time t) const {
  const Time inside = std::clamp(t, Time{0}, duration());
  const Piece& piece = piece_at(inside);
  const double u = to_seconds(inside - piece.begin) / piece.length_s;
  return make_pose(Matrix3d(piece.world_from_begin * so3::exp(value_at(piece.rotation, u))),
                   value_at(piece.position, u));
}

Motion ReplayFlight::at(Time t) const {
  Motion motion{.world_from_body = pose_at(t)};
  if (t < Time{0} || t > duration()) return motion;
  const Piece& piece = piece_at(t);
  const double u = to_seconds(t - piece.begin) / piece.length_s;
  const Derivatives position = derivatives_at(piece.position, u, piece.length_s);
  const Derivatives rotation = derivatives_at(piece.rotation, u, piece.length_s);
  motion.velocity_world = position.first;
  motion.acceleration_world = position.second;
  motion.angular_rate_body = body_rate(rotation.value, rotation.first);
  motion.angular_acceleration_body =
      body_acceleration(rotation.value, rotation.first, rotation.second);
  return motion;
}

}  // namespace lidarena::flight
