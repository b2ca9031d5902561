// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/elastic_alignment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/least_squares.hpp"
#include "lidarena/estimation/robust_kernel.hpp"

namespace lidarena::estimation {

namespace {

// This share of the largest diagonal element is added to all. It is far above rounding, so that
// directions without information from matches stay unchanged, and far below the information of any
// match.
constexpr double kDamping = 1e-10;

// Levenberg-Marquardt, with the usual constants of such solvers (the same as Ceres has):
constexpr double kInitialDamping = 1e-4;  // share of a parameter's curvature
constexpr double kMinQuality = 1e-3;  // a step that gains a smaller share of its prediction fails
constexpr double kMinGain = 1e-6;     // share of the cost; the search ends below
constexpr double kMinStep = 1e-8;     // m and rad, norm of the whole step; likewise

/// Normal equations of the knots of a motion, kept per segment.
struct MotionEquations {
  std::vector<NormalEquations<12>> segments;

  MotionEquations& operator+=(const MotionEquations& other) {
    for (std::size_t i = 0; i < segments.size(); ++i) segments[i] += other.segments[i];
    return *this;
  }
};

void add_match(const ElasticProblem& problem, const ElasticTrack& track, const ElasticMatch& match,
               MotionEquations& equations) {
  const auto [index, a] = track.locate(match.alpha);
  const ElasticSegment& segment = track.segment(index);
  const Eigen::Vector3d gap = segment.place(match.point, a) - match.anchor;
  const double distance = match.normal.dot(gap);
  const double squared_weight = match.weight * match.weight;
  const double squared_error = squared_weight * (distance * distance);
  const double weight =
      squared_weight * robust_weight(RobustKernel::kCauchy, squared_error, problem.kernel_scale);
  const ElasticSegment::Row row = segment.row(match.point, a, match.normal);
  equations.segments[index].add<1>(row, Eigen::Matrix<double, 1, 1>(distance), weight);
}

MotionEquations equations_of(const ElasticProblem& problem, const ElasticTrack& track,
                             const Parallel& parallel) {
  constexpr std::size_t kGrain = 256;
  const MotionEquations none{std::vector<NormalEquations<12>>(track.size())};
  return parallel.reduce(
      problem.matches.size(), kGrain, none,
      [&](std::size_t begin, std::size_t end) {
        MotionEquations part = none;
        for (std::size_t i = begin; i < end; ++i)
          add_match(problem, track, problem.matches[i], part);
        return part;
      },
      [](MotionEquations& total, const MotionEquations& part) { total += part; });
}

/// One vector term of the prior: its error, and its derivative with respect to the increments of
/// the knots.
struct PriorTerm {
  double weight;
  Eigen::Vector3d error;
  Eigen::Matrix<double, 3, Eigen::Dynamic> jacobian;
};

/// Rotation vector in the world frame from one knot to another, and its derivatives with respect to
/// their increments.
struct RelativeRotation {
  Eigen::Vector3d vector;
  Eigen::Matrix3d by_from;
  Eigen::Matrix3d by_to;
};
RelativeRotation rotation_between(const Pose& from, const Pose& to) {
  const Eigen::Vector3d vector = so3::log(to.linear() * from.linear().transpose());
  return {vector, -so3::right_jacobian_inverse(vector), so3::left_jacobian_inverse(vector)};
}

class PriorTerms {
 public:
  PriorTerms(const MotionPrior& prior, const ElasticMotion& motion)
      : knots_(motion.knots), last_(static_cast<Eigen::Index>(motion.segments())) {
    const Pose& begin = motion.begin();
    const Eigen::Vector3d step = motion.end().translation() - begin.translation();
    if (prior.location > 0.0)
      position(0, 1.0, open(prior.location, begin.translation() - prior.begin.translation()));
    if (prior.orientation > 0.0) {
      const RelativeRotation turn = rotation_between(prior.begin, begin);
      rotation(0, turn.by_to, open(prior.orientation, turn.vector));
    }
    if (prior.alignment > 0.0) add_alignment(prior);
    if (prior.velocity > 0.0) add_step(open(prior.velocity, step - prior.step));
    if (prior.small_velocity > 0.0) add_step(open(prior.small_velocity, step));
    for (Eigen::Index i = 1; i < last_; ++i) add_bends(prior, i);
  }
  const std::vector<PriorTerm>& terms() const { return terms_; }

 private:
  const Pose& knot(Eigen::Index i) const { return knots_[static_cast<std::size_t>(i)]; }
  PriorTerm& open(double weight, const Eigen::Vector3d& error) {
    return terms_.emplace_back(PriorTerm{
        weight, error, Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, 6 * (last_ + 1))});
  }
  static void position(Eigen::Index knot, double sign, PriorTerm& term) {
    term.jacobian.middleCols<3>(6 * knot) += sign * Eigen::Matrix3d::Identity();
  }
  static void rotation(Eigen::Index knot, const Eigen::Matrix3d& by, PriorTerm& term) {
    term.jacobian.middleCols<3>(6 * knot + 3) += by;
  }
  void add_step(PriorTerm& term) const {
    position(0, -1.0, term);
    position(last_, 1.0, term);
  }
  void add_alignment(const MotionPrior& prior) {
    const Eigen::Vector3d turn = rotation_between(prior.begin, knot(0)).vector;
    const double angle = turn.norm();
    const double half_sine = std::sin(0.5 * angle);
    PriorTerm& term = open(prior.alignment, Eigen::Vector3d::UnitX() * (half_sine * half_sine));
    // an increment along the axis is the change of the angle; the slope at zero is zero
    if (angle > 0.0)
      term.jacobian.row(0).segment<3>(3) = (0.5 * std::sin(angle) / angle * turn).transpose();
  }
  /// Adds the second differences at an inner knot.
  void add_bends(const MotionPrior& prior, Eigen::Index i) {
    if (prior.velocity_change > 0.0) {
      PriorTerm& term =
          open(prior.velocity_change,
               knot(i - 1).translation() - 2.0 * knot(i).translation() + knot(i + 1).translation());
      position(i - 1, 1.0, term);
      position(i, -2.0, term);
      position(i + 1, 1.0, term);
    }
    if (prior.angular_velocity_change > 0.0) {
      const RelativeRotation before = rotation_between(knot(i - 1), knot(i));
      const RelativeRotation after = rotation_between(knot(i), knot(i + 1));
      PriorTerm& term = open(prior.angular_velocity_change, after.vector - before.vector);
      rotation(i - 1, -before.by_from, term);
      rotation(i, after.by_from - before.by_to, term);
      rotation(i + 1, after.by_to, term);
    }
  }

  std::span<const Pose> knots_;
  Eigen::Index last_;
  std::vector<PriorTerm> terms_;
};

/// Normal equations of all knots: (translation, rotation) of each.
struct Linearization {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
};

Linearization linearized(const ElasticProblem& problem, const ElasticMotion& motion,
                         const Parallel& parallel) {
  const auto unknowns = static_cast<Eigen::Index>(6 * motion.knots.size());
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(unknowns);
  const MotionEquations equations = equations_of(problem, ElasticTrack(motion), parallel);
  for (std::size_t i = 0; i < equations.segments.size(); ++i) {
    const auto first = static_cast<Eigen::Index>(6 * i);
    hessian.block<12, 12>(first, first) += equations.segments[i].hessian;
    gradient.segment<12>(first) += equations.segments[i].gradient;
  }
  const auto count = static_cast<double>(problem.matches.size());
  const PriorTerms prior(problem.prior, motion);
  for (const PriorTerm& term : prior.terms()) {
    hessian.noalias() += count * term.weight * term.jacobian.transpose() * term.jacobian;
    gradient.noalias() += count * term.weight * term.jacobian.transpose() * term.error;
  }
  return {std::move(hessian), std::move(gradient)};
}

/// The step to the minimum, where `damping` of each parameter's curvature is added to it.
Eigen::VectorXd step_of(const Linearization& equations, double damping) {
  Eigen::MatrixXd hessian = equations.hessian;
  const double least = kDamping * hessian.diagonal().maxCoeff();
  hessian.diagonal() *= 1.0 + damping;
  hessian.diagonal().array() += least;
  return -hessian.ldlt().solve(equations.gradient);
}

double predicted_gain(const Linearization& equations, const Eigen::VectorXd& step) {
  return -step.dot(equations.gradient) - 0.5 * step.dot(equations.hessian * step);
}

void apply(const Eigen::VectorXd& step, ElasticMotion& motion) {
  for (std::size_t i = 0; i < motion.knots.size(); ++i) {
    const auto first = static_cast<Eigen::Index>(6 * i);
    Pose& knot = motion.knots[i];
    knot = orthonormalized(
        make_pose(Eigen::Matrix3d(so3::exp(step.segment<3>(first + 3)) * knot.linear()),
                  Eigen::Vector3d(knot.translation() + step.segment<3>(first))));
  }
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
    cost += robust_cost(RobustKernel::kCauchy, error * error, problem.kernel_scale);
  }
  const auto count = static_cast<double>(problem.matches.size());
  const PriorTerms prior(problem.prior, motion);
  for (const PriorTerm& term : prior.terms())
    cost += 0.5 * count * term.weight * term.error.squaredNorm();
  return cost;
}

ElasticMotion gauss_newton_step(const ElasticProblem& problem, ElasticMotion motion,
                                const Parallel& parallel) {
  apply(step_of(linearized(problem, motion, parallel), 0.0), motion);
  return motion;
}

ElasticMotion align_by_levenberg_marquardt(const ElasticProblem& problem, ElasticMotion motion,
                                           int iterations, const Parallel& parallel) {
  double damping = kInitialDamping;
  double damping_growth = 2.0;
  double cost = cost_of(problem, motion);
  for (int i = 0; i < iterations; ++i) {
    const Linearization equations = linearized(problem, motion, parallel);
    const Eigen::VectorXd step = step_of(equations, damping);
    if (!(step.norm() > kMinStep)) break;
    ElasticMotion candidate = motion;
    apply(step, candidate);
    const double gain = cost - cost_of(problem, candidate);
    if (std::abs(gain) <= kMinGain * cost) break;
    const double quality = gain / predicted_gain(equations, step);
    if (quality > kMinQuality) {
      motion = std::move(candidate);
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

}  // namespace lidarena::estimation
