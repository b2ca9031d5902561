// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/diagnosis/lever_arm.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lidarena/base/so3.hpp"
#include "lidarena/evaluation/trajectory/motion_pairs.hpp"

namespace lidarena::evaluation {
namespace {

using se3::Matrix6;
using se3::Vector6;
using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, 6>;

constexpr std::size_t kMinMotions = 10;
constexpr double kMinRotation_rad = 0.0175;  // RMS over 1 s; with less, no arm is observable
constexpr int kIterations = 20;
constexpr double kStep = 1e-6;            // of the numeric derivatives, m and rad
constexpr double kStepTolerance = 1e-10;  // steps below end the iteration, m and rad
// Keeps unobservable directions at their initial values; relative to the largest diagonal element
// of the Hessian, hence negligible for the others.
constexpr double kDamping = 1e-9;

/// Weights of the translation and rotation residuals: one over the RMS of each.
struct Weights {
  double translation = 1.0;
  double rotation = 1.0;
};

/// (X^-1 Q X)^-1 P of each motion, as meters and radians, weighted.
Eigen::VectorXd residuals(const std::vector<MotionPair>& motions, const Pose& x, Weights w) {
  Eigen::VectorXd r(6 * static_cast<Eigen::Index>(motions.size()));
  const Pose x_inverse = x.inverse();
  Eigen::Index row = 0;
  for (const MotionPair& motion : motions) {
    const Pose error = (x_inverse * motion.truth * x).inverse() * motion.estimate;
    r.segment<3>(row) = w.translation * error.translation();
    r.segment<3>(row + 3) = w.rotation * so3::log(error.linear());
    row += 6;
  }
  return r;
}

/// X changed by `d`: translation in the body, rotation about the estimate's own axes.
Pose moved(const Pose& x, const Vector6& d) {
  return make_pose(Eigen::Matrix3d(x.linear() * so3::exp(d.tail<3>())),
                   x.translation() + d.head<3>());
}

Jacobian derivatives(const std::vector<MotionPair>& motions, const Pose& x, Weights w) {
  Jacobian j(6 * static_cast<Eigen::Index>(motions.size()), 6);
  for (int i = 0; i < 6; ++i) {
    const Vector6 d = kStep * Vector6::Unit(i);
    j.col(i) =
        (residuals(motions, moved(x, d), w) - residuals(motions, moved(x, -d), w)) / (2.0 * kStep);
  }
  return j;
}

double rms_of_rows(const Eigen::VectorXd& r, Eigen::Index first) {
  double sum = 0.0;
  for (Eigen::Index i = first; i < r.size(); i += 6) sum += r.segment<3>(i).squaredNorm();
  return std::sqrt(6.0 * sum / static_cast<double>(r.size()));
}

Weights weights_at(const std::vector<MotionPair>& motions, const Pose& x) {
  const Eigen::VectorXd r = residuals(motions, x, {});
  return {1.0 / std::max(1e-6, rms_of_rows(r, 0)), 1.0 / std::max(1e-6, rms_of_rows(r, 3))};
}

Matrix6 damped(const Jacobian& j) {
  Matrix6 h = j.transpose() * j;
  h += kDamping * h.diagonal().maxCoeff() * Matrix6::Identity();
  return h;
}

Pose solve(const std::vector<MotionPair>& motions, Pose x, Weights w) {
  for (int i = 0; i < kIterations; ++i) {
    const Jacobian j = derivatives(motions, x, w);
    const Vector6 d = -damped(j).ldlt().solve(j.transpose() * residuals(motions, x, w));
    x = moved(x, d);
    if (d.norm() < kStepTolerance) break;
  }
  return x;
}

Vector6 sigma_at(const std::vector<MotionPair>& motions, const Pose& x, Weights w) {
  const Matrix6 h = damped(derivatives(motions, x, w));
  const Matrix6 inverse = h.ldlt().solve(Matrix6::Identity());
  const double n = static_cast<double>(6 * motions.size());
  const double variance = residuals(motions, x, w).squaredNorm() / (n - 6.0);
  return (variance * inverse.diagonal()).cwiseSqrt();
}

double rms_rotation(const std::vector<MotionPair>& motions) {
  double sum = 0.0;
  for (const MotionPair& motion : motions) sum += std::pow(so3::angle(motion.truth.linear()), 2);
  return std::sqrt(sum / static_cast<double>(motions.size()));
}

}  // namespace

Trajectory moved_to_body(const Trajectory& estimate, const Pose& body_from_estimate) {
  const Pose estimate_from_body = body_from_estimate.inverse();
  std::vector<StampedPose> poses;
  poses.reserve(estimate.size());
  for (const StampedPose& pose : estimate.poses()) {
    poses.push_back({pose.stamp, pose.world_from_body * estimate_from_body});
  }
  return Trajectory(std::move(poses));
}

Trajectory moved_by(const Trajectory& trajectory, const Eigen::Vector3d& offset) {
  std::vector<StampedPose> poses(trajectory.poses().begin(), trajectory.poses().end());
  for (StampedPose& pose : poses) pose.world_from_body.pretranslate(offset);
  return Trajectory(std::move(poses));
}

std::optional<LeverArm> find_lever_arm(const Trajectory& estimate, const Trajectory& truth) {
  const std::vector<MotionPair> motions = motion_pairs(estimate, truth);
  if (motions.size() < kMinMotions || rms_rotation(motions) < kMinRotation_rad) return std::nullopt;
  Pose x = make_pose(mounting_of(motions), Eigen::Vector3d::Zero());
  x = solve(motions, x, {});
  const Weights weights = weights_at(motions, x);
  x = solve(motions, x, weights);
  LeverArm arm;
  arm.body_from_estimate = x;
  arm.sigma = sigma_at(motions, x, weights);
  arm.misfit_without_m = rms_of_rows(residuals(motions, Pose::Identity(), {}), 0);
  arm.misfit_m = rms_of_rows(residuals(motions, x, {}), 0);
  if (!x.matrix().allFinite() || !arm.sigma.allFinite()) return std::nullopt;
  return arm;
}

std::string warning_of(const LeverArm& arm) {
  const Eigen::Vector3d t = arm.body_from_estimate.translation();
  const Eigen::Vector3d rotation_vector = so3::log(arm.body_from_estimate.linear());
  const auto beyond = [&](const Eigen::Vector3d& value, Eigen::Index first) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      if (std::abs(value[i]) > 3.0 * arm.sigma[first + i] + 0.01) return true;
    }
    return false;
  };
  if (!beyond(t, 0) && !beyond(rotation_vector, 3)) return {};
  if (2.0 * arm.misfit_m > arm.misfit_without_m) return {};
  return fmt::format(
      "the estimate seems to be of another frame of the body, {:.3g} m away and rotated by {:.3g} "
      "deg (not corrected): if so, give --lever body_from_estimate",
      t.norm(), rotation_vector.norm() * 180.0 / std::numbers::pi);
}

}  // namespace lidarena::evaluation
