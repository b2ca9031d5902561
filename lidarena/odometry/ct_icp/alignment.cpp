// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/alignment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/least_squares.hpp"
#include "lidarena/estimation/robust_kernel.hpp"

namespace lidarena::odometry::ct_icp {

namespace {

// Levenberg-Marquardt, with the usual constants of such solvers (the same as Ceres has):
constexpr double kInitialDamping = 1e-4;  // share of a parameter's curvature
constexpr double kMinQuality = 1e-3;  // a step that gains a smaller share of its prediction fails
constexpr double kMinGain = 1e-6;     // share of the cost; the search ends below
constexpr double kMinStep = 1e-8;     // m and rad, norm of the whole step; likewise
// This share of the largest diagonal element is added to all. It is far above rounding, so that
// directions without information from matches stay unchanged, and far below the information of any
// match.
constexpr double kLeastDamping = 1e-10;

/// In the increments (translation, rotation) of begin and of end.
using Equations = estimation::NormalEquations<12>;

/// One term of the prior: its error, and its derivative with respect to those increments.
struct PriorTerm {
  double weight;
  Eigen::Vector3d error;
  Eigen::Matrix<double, 3, 12> jacobian;
};

/// Its one error is the first of three.
PriorTerm orientation_term(const MotionPrior& prior, const ElasticMotion& motion) {
  const Eigen::Vector3d turn = so3::log(motion.begin.linear() * prior.begin.linear().transpose());
  const double angle = turn.norm();
  const double half_sine = std::sin(0.5 * angle);
  PriorTerm term{prior.orientation, Eigen::Vector3d::UnitX() * (half_sine * half_sine),
                 Eigen::Matrix<double, 3, 12>::Zero()};
  // an increment along the axis is the change of the angle; the slope at zero is zero
  if (angle > 0.0)
    term.jacobian.row(0).segment<3>(3) = (0.5 * std::sin(angle) / angle * turn).transpose();
  return term;
}

std::array<PriorTerm, 4> terms_of(const MotionPrior& prior, const ElasticMotion& motion) {
  const Eigen::Vector3d begin = motion.begin.translation();
  const Eigen::Vector3d step = motion.end.translation() - begin;
  Eigen::Matrix<double, 3, 12> by_begin = Eigen::Matrix<double, 3, 12>::Zero();
  by_begin.leftCols<3>().setIdentity();
  Eigen::Matrix<double, 3, 12> by_step = -by_begin;
  by_step.middleCols<3>(6).setIdentity();
  return {PriorTerm{prior.location, begin - prior.begin.translation(), by_begin},
          orientation_term(prior, motion), PriorTerm{prior.velocity, step - prior.step, by_step},
          PriorTerm{prior.small_velocity, step, by_step}};
}

void add_match(const ElasticProblem& problem, const ElasticTrack& track, const ElasticMatch& match,
               Equations& equations) {
  const Eigen::Vector3d gap = track.place(match.point, match.alpha) - match.anchor;
  const double distance = match.normal.dot(gap);
  const double squared_weight = match.weight * match.weight;
  const double squared_error = squared_weight * (distance * distance);
  const double weight =
      squared_weight * estimation::robust_weight(estimation::RobustKernel::kCauchy, squared_error,
                                                 problem.kernel_scale);
  const ElasticTrack::Row row = track.row(match.point, match.alpha, match.normal);
  equations.add<1>(row, Eigen::Matrix<double, 1, 1>(distance), weight);
}

Equations linearized(const ElasticProblem& problem, const ElasticMotion& motion,
                     const Parallel& parallel) {
  const ElasticTrack track(motion);
  Equations equations = estimation::accumulate_normal_equations<12>(
      parallel, problem.matches.size(),
      [&](std::size_t i, Equations& part) { add_match(problem, track, problem.matches[i], part); });
  const auto count = static_cast<double>(problem.matches.size());
  for (const PriorTerm& term : terms_of(problem.prior, motion))
    equations.add<3>(term.jacobian, term.error, count * term.weight);
  return equations;
}

/// The step to the minimum, where `damping` of each parameter's curvature is added to it.
Equations::Vector step_of(const Equations& equations, double damping) {
  Equations::Matrix hessian = equations.hessian;
  const double least = kLeastDamping * hessian.diagonal().maxCoeff();
  hessian.diagonal() *= 1.0 + damping;
  hessian.diagonal().array() += least;
  return -hessian.ldlt().solve(equations.gradient);
}

double predicted_gain(const Equations& equations, const Equations::Vector& step) {
  return -step.dot(equations.gradient) - 0.5 * step.dot(equations.hessian * step);
}

Pose stepped(const Pose& pose, const Eigen::Matrix<double, 6, 1>& step) {
  return orthonormalized(make_pose(Eigen::Matrix3d(so3::exp(step.tail<3>()) * pose.linear()),
                                   Eigen::Vector3d(pose.translation() + step.head<3>())));
}

}  // namespace

double observability_of(std::span<const ElasticMatch> matches) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const ElasticMatch& match : matches) sum += match.normal * match.normal.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(sum / sum.trace(), Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[0];
}

double cost_of(const ElasticProblem& problem, const ElasticMotion& motion) {
  const ElasticTrack track(motion);
  double cost = 0.0;
  for (const ElasticMatch& match : problem.matches) {
    const Eigen::Vector3d gap = track.place(match.point, match.alpha) - match.anchor;
    const double error = match.weight * match.normal.dot(gap);
    cost += estimation::robust_cost(estimation::RobustKernel::kCauchy, error * error,
                                    problem.kernel_scale);
  }
  const auto count = static_cast<double>(problem.matches.size());
  for (const PriorTerm& term : terms_of(problem.prior, motion))
    cost += 0.5 * count * term.weight * term.error.squaredNorm();
  return cost;
}

ElasticMotion align(const ElasticProblem& problem, ElasticMotion motion, int iterations,
                    const Parallel& parallel) {
  double damping = kInitialDamping;
  double damping_growth = 2.0;
  double cost = cost_of(problem, motion);
  for (int i = 0; i < iterations; ++i) {
    const Equations equations = linearized(problem, motion, parallel);
    const Equations::Vector step = step_of(equations, damping);
    if (!(step.norm() > kMinStep)) break;
    const ElasticMotion candidate{stepped(motion.begin, step.head<6>()),
                                  stepped(motion.end, step.tail<6>())};
    const double gain = cost - cost_of(problem, candidate);
    if (std::abs(gain) <= kMinGain * cost) break;
    const double quality = gain / predicted_gain(equations, step);
    if (quality > kMinQuality) {
      motion = candidate;
      cost -= gain;
      damping *= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * quality - 1.0, 3.0));
      damping_growth = 2.0;
    } else {
      damping *= damping_growth;
      damping_growth *= 2.0;
    }
  }
  return motion;
}

}  // namespace lidarena::odometry::ct_icp
