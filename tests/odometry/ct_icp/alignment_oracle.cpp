// SPDX-License-Identifier: BSD-3-Clause
#include "tests/odometry/ct_icp/alignment_oracle.hpp"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <array>
#include <cmath>

namespace lidarena::odometry::ct_icp::oracle {

namespace {

/// A pose as Ceres holds it: quaternion x y z w, then position.
constexpr int kPose = 7;
using PoseBlock = std::array<double, kPose>;

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Quaternion = Eigen::Quaternion<T>;

template <class T>
Quaternion<T> rotation_of(const T* pose) {
  return Quaternion<T>(Eigen::Map<const Eigen::Matrix<T, 4, 1>>(pose));
}
template <class T>
Vector3<T> position_of(const T* pose) {
  return Eigen::Map<const Vector3<T>>(pose + 4);
}

struct MatchError {
  ElasticMatch match;

  template <class T>
  bool operator()(const T* from, const T* to, T* residual) const {
    const Quaternion<T> q = rotation_of(to) * rotation_of(from).conjugate();
    const std::array<T, 4> wxyz{q.w(), q.x(), q.y(), q.z()};
    Vector3<T> turn;
    ceres::QuaternionToAngleAxis(wxyz.data(), turn.data());
    turn *= T(match.alpha);
    const Vector3<T> start = rotation_of(from) * match.point.cast<T>().eval();
    Vector3<T> rotated;
    ceres::AngleAxisRotatePoint(turn.data(), start.data(), rotated.data());
    const Vector3<T> position =
        rotated + position_of(from) + T(match.alpha) * (position_of(to) - position_of(from));
    residual[0] = T(match.weight) * match.normal.cast<T>().dot(position - match.anchor.cast<T>());
    return true;
  }
};

/// The begin's position is the expected one.
struct LocationError {
  double weight;
  Eigen::Vector3d expected;
  template <class T>
  bool operator()(const T* begin, T* residual) const {
    Eigen::Map<Vector3<T>>{residual} = T(weight) * (position_of(begin) - expected.cast<T>());
    return true;
  }
};

/// The begin's rotation is the expected one.
struct OrientationError {
  double weight;
  Eigen::Quaterniond expected;
  template <class T>
  bool operator()(const T* begin, T* residual) const {
    const T dot = rotation_of(begin).dot(expected.cast<T>());
    residual[0] = T(weight) * (T(1.0) - dot * dot);
    return true;
  }
};

/// The translation from begin to end is the expected one.
struct StepError {
  double weight;
  Eigen::Vector3d expected;
  template <class T>
  bool operator()(const T* begin, const T* end, T* residual) const {
    Eigen::Map<Vector3<T>>{residual} =
        T(weight) * (position_of(end) - position_of(begin) - expected.cast<T>());
    return true;
  }
};

PoseBlock block_of(const Pose& pose) {
  PoseBlock block;
  Eigen::Map<Eigen::Vector4d>{block.data()} = Eigen::Quaterniond(pose.linear()).coeffs();
  Eigen::Map<Eigen::Vector3d>{block.data() + 4} = pose.translation();
  return block;
}

Pose pose_from(const PoseBlock& block) {
  return make_pose(rotation_of<double>(block.data()), position_of<double>(block.data()));
}

}  // namespace

ElasticMotion align_by_ceres(const ElasticProblem& problem, const ElasticMotion& motion,
                             int iterations) {
  using Manifold =
      ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>;
  PoseBlock begin = block_of(motion.begin);
  PoseBlock end = block_of(motion.end);
  ceres::Problem adjustment;
  adjustment.AddParameterBlock(begin.data(), kPose, new Manifold);
  adjustment.AddParameterBlock(end.data(), kPose, new Manifold);
  for (const ElasticMatch& match : problem.matches)
    adjustment.AddResidualBlock(
        new ceres::AutoDiffCostFunction<MatchError, 1, kPose, kPose>(new MatchError{match}),
        new ceres::CauchyLoss(problem.kernel_scale), begin.data(), end.data());

  const MotionPrior& prior = problem.prior;
  const auto root = [&](double weight) {
    return std::sqrt(weight * static_cast<double>(problem.matches.size()));
  };
  using Location = ceres::AutoDiffCostFunction<LocationError, 3, kPose>;
  using Orientation = ceres::AutoDiffCostFunction<OrientationError, 1, kPose>;
  using Step = ceres::AutoDiffCostFunction<StepError, 3, kPose, kPose>;
  adjustment.AddResidualBlock(
      new Location(new LocationError{root(prior.location), prior.begin.translation()}), nullptr,
      begin.data());
  adjustment.AddResidualBlock(
      new Orientation(
          new OrientationError{root(prior.orientation), Eigen::Quaterniond(prior.begin.linear())}),
      nullptr, begin.data());
  adjustment.AddResidualBlock(new Step(new StepError{root(prior.velocity), prior.step}), nullptr,
                              begin.data(), end.data());
  adjustment.AddResidualBlock(
      new Step(new StepError{root(prior.small_velocity), Eigen::Vector3d::Zero()}), nullptr,
      begin.data(), end.data());

  ceres::Solver::Options options;
  options.max_num_iterations = iterations;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &adjustment, &summary);
  return {pose_from(begin), pose_from(end)};
}

}  // namespace lidarena::odometry::ct_icp::oracle
