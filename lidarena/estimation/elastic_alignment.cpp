// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/elastic_alignment.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/least_squares.hpp"
#include "lidarena/estimation/robust_kernel.hpp"

namespace lidarena::estimation {

namespace {

constexpr double kConverged = 1e-9;  // m and rad, norm of the whole step
// Damping: this share of the largest diagonal element is added to all. It is far above rounding, so
// that directions without information from matches stay unchanged, and far below the information of
// any match.
constexpr double kDamping = 1e-10;

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
  const auto shape = match.shape.topRows(match.rows);
  const double squared_weight = match.weight * match.weight;
  const double squared_error = squared_weight * (shape * gap).squaredNorm();
  const double weight =
      squared_weight * robust_weight(problem.kernel, squared_error, problem.kernel_scale);
  for (int r = 0; r < match.rows; ++r) {
    const Eigen::Vector3d direction = shape.row(r);
    const auto row = problem.exact_slerp ? segment.row(match.point, a, direction)
                                         : segment.first_order_row(match.point, a, direction);
    equations.segments[index].add<1>(row, Eigen::Matrix<double, 1, 1>(direction.dot(gap)), weight);
  }
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
    if (prior.velocity > 0.0) add_step(open(prior.velocity, step - prior.step));
    if (prior.small_velocity > 0.0) add_step(open(prior.small_velocity, step));
    if (prior.angular_velocity > 0.0) {
      const RelativeRotation turn = rotation_between(begin, motion.end());
      PriorTerm& term = open(prior.angular_velocity, turn.vector - prior.turn);
      rotation(0, turn.by_from, term);
      rotation(last_, turn.by_to, term);
    }
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

/// The Gauss-Newton step: (translation, rotation) of each knot.
Eigen::VectorXd step_of(const ElasticProblem& problem, const ElasticMotion& motion,
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
  hessian.diagonal().array() += kDamping * hessian.diagonal().maxCoeff();
  return -hessian.ldlt().solve(gradient);
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

double cost_of(const ElasticProblem& problem, const ElasticMotion& motion) {
  const ElasticTrack track(motion);
  double cost = 0.0;
  for (const ElasticMatch& match : problem.matches) {
    const Eigen::Vector3d gap = track.place(match.point, match.alpha) - match.anchor;
    const double squared_error =
        match.weight * match.weight * (match.shape.topRows(match.rows) * gap).squaredNorm();
    cost += robust_cost(problem.kernel, squared_error, problem.kernel_scale);
  }
  const auto count = static_cast<double>(problem.matches.size());
  const PriorTerms prior(problem.prior, motion);
  for (const PriorTerm& term : prior.terms())
    cost += 0.5 * count * term.weight * term.error.squaredNorm();
  return cost;
}

ElasticMotion align_by_gauss_newton(const ElasticProblem& problem, ElasticMotion motion,
                                    int iterations, const Parallel& parallel) {
  for (int i = 0; i < iterations; ++i) {
    const Eigen::VectorXd step = step_of(problem, motion, parallel);
    apply(step, motion);
    if (!(step.norm() > kConverged)) break;
  }
  return motion;
}

}  // namespace lidarena::estimation
