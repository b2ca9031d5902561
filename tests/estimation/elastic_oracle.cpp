// SPDX-License-Identifier: BSD-3-Clause
#include "tests/estimation/elastic_oracle.hpp"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <array>
#include <cmath>
#include <vector>

namespace lidarena::estimation::oracle {

namespace {

/// A knot as Ceres holds it: quaternion x y z w, then position.
using Knot = std::array<double, 7>;
constexpr int kKnot = 7;

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Quaternion = Eigen::Quaternion<T>;

template <class T>
Quaternion<T> rotation_of(const T* knot) {
  return Quaternion<T>(Eigen::Map<const Eigen::Matrix<T, 4, 1>>(knot));
}
template <class T>
Vector3<T> position_of(const T* knot) {
  return Eigen::Map<const Vector3<T>>(knot + 4);
}
template <class T>
Vector3<T> rotation_vector(const Quaternion<T>& q) {
  const std::array<T, 4> wxyz{q.w(), q.x(), q.y(), q.z()};
  Vector3<T> vector;
  ceres::QuaternionToAngleAxis(wxyz.data(), vector.data());
  return vector;
}
template <class T>
Vector3<T> rotation_between(const T* from, const T* to) {
  return rotation_vector<T>(rotation_of(to) * rotation_of(from).conjugate());
}

struct MatchError {
  ElasticMatch match;
  double a;  ///< position in the segment, 0 to 1

  template <class T>
  bool operator()(const T* from, const T* to, T* residual) const {
    const Vector3<T> turn = T(a) * rotation_between(from, to);
    const Vector3<T> start = rotation_of(from) * match.point.cast<T>().eval();
    Vector3<T> rotated;
    ceres::AngleAxisRotatePoint(turn.data(), start.data(), rotated.data());
    const Vector3<T> position =
        rotated + position_of(from) + T(a) * (position_of(to) - position_of(from));
    residual[0] = T(match.weight) * match.normal.cast<T>().dot(position - match.anchor.cast<T>());
    return true;
  }
};

/// A term of the prior: `error` makes three residuals of one, two or three knots.
template <class Error>
struct PriorError {
  double weight;
  Error error;
  template <class T>
  bool operator()(const T* a, T* residual) const {
    return put<T>(std::array{a}, residual);
  }
  template <class T>
  bool operator()(const T* a, const T* b, T* residual) const {
    return put<T>(std::array{a, b}, residual);
  }
  template <class T>
  bool operator()(const T* a, const T* b, const T* c, T* residual) const {
    return put<T>(std::array{a, b, c}, residual);
  }
  template <class T, std::size_t N>
  bool put(const std::array<const T*, N>& knots, T* residual) const {
    Eigen::Map<Vector3<T>>{residual} = T(weight) * error(knots.data());
    return true;
  }
};

/// An ElasticProblem as a Ceres problem that changes `knots` in place.
class Adjustment {
 public:
  Adjustment(const ElasticProblem& problem, std::vector<Knot>& knots)
      : problem_(problem), knots_(knots) {
    using Manifold =
        ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>;
    for (Knot& knot : knots_) adjustment_.AddParameterBlock(knot.data(), kKnot, new Manifold);
    for (const ElasticMatch& match : problem_.matches) add(match);
    add_prior();
  }

  void solve(int iterations) {
    ceres::Solver::Options options;
    options.max_num_iterations = iterations;
    options.linear_solver_type = ceres::DENSE_QR;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &adjustment_, &summary);
  }

 private:
  void add(const ElasticMatch& match) {
    const double position = match.alpha * static_cast<double>(knots_.size() - 1);
    const std::size_t first = std::min(static_cast<std::size_t>(position), knots_.size() - 2);
    const double a = position - static_cast<double>(first);
    adjustment_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<MatchError, 1, kKnot, kKnot>(new MatchError{match, a}),
        new ceres::CauchyLoss(problem_.kernel_scale), knots_[first].data(),
        knots_[first + 1].data());
  }

  /// Adds one term of the prior over the knots with these indices, unless its weight is zero.
  template <class Error, class... Indices>
  void add_term(double weight, Error error, Indices... indices) {
    if (!(weight > 0.0)) return;
    const double root = std::sqrt(weight * static_cast<double>(problem_.matches.size()));
    using Term = PriorError<Error>;
    using Function = ceres::AutoDiffCostFunction<Term, 3, ((void)sizeof(Indices), kKnot)...>;
    adjustment_.AddResidualBlock(new Function(new Term{root, error}), nullptr,
                                 knots_[indices].data()...);
  }

  void add_prior() {
    const MotionPrior& prior = problem_.prior;
    const std::size_t last = knots_.size() - 1;
    const Eigen::Vector3d begin = prior.begin.translation();
    const Eigen::Quaterniond q_begin(prior.begin.linear());
    const std::size_t first = 0;
    add_term(
        prior.location,
        [begin](const auto* knots) {
          return (position_of(knots[0]) - begin.cast<std::decay_t<decltype(*knots[0])>>()).eval();
        },
        first);
    add_term(
        prior.orientation,
        [q_begin](const auto* knots) {
          using T = std::decay_t<decltype(*knots[0])>;
          return rotation_vector<T>(rotation_of(knots[0]) * q_begin.conjugate().cast<T>());
        },
        first);
    add_term(
        prior.alignment,
        [q_begin](const auto* knots) {
          using T = std::decay_t<decltype(*knots[0])>;
          const T dot = rotation_of(knots[0]).dot(q_begin.cast<T>());
          return Vector3<T>(T(1.0) - dot * dot, T(0.0), T(0.0));
        },
        first);
    add_step(prior.velocity, prior.step, last);
    add_step(prior.small_velocity, Eigen::Vector3d::Zero(), last);
    for (std::size_t i = 1; i < last; ++i) add_bends(i);
  }

  void add_step(double weight, const Eigen::Vector3d& expected, std::size_t last) {
    const std::size_t first = 0;
    add_term(
        weight,
        [expected](const auto* knots) {
          using T = std::decay_t<decltype(*knots[0])>;
          return (position_of(knots[1]) - position_of(knots[0]) - expected.cast<T>()).eval();
        },
        first, last);
  }

  void add_bends(std::size_t i) {
    add_term(
        problem_.prior.velocity_change,
        [](const auto* knots) {
          using T = std::decay_t<decltype(*knots[0])>;
          return (position_of(knots[0]) - T(2.0) * position_of(knots[1]) + position_of(knots[2]))
              .eval();
        },
        i - 1, i, i + 1);
    add_term(
        problem_.prior.angular_velocity_change,
        [](const auto* knots) {
          return (rotation_between(knots[1], knots[2]) - rotation_between(knots[0], knots[1]))
              .eval();
        },
        i - 1, i, i + 1);
  }

  const ElasticProblem& problem_;
  std::vector<Knot>& knots_;
  ceres::Problem adjustment_;
};

Knot knot_of(const Pose& pose) {
  Knot knot;
  Eigen::Map<Eigen::Vector4d>{knot.data()} = Eigen::Quaterniond(pose.linear()).coeffs();
  Eigen::Map<Eigen::Vector3d>{knot.data() + 4} = pose.translation();
  return knot;
}

}  // namespace

ElasticMotion align_by_ceres(const ElasticProblem& problem, ElasticMotion motion, int iterations) {
  std::vector<Knot> knots;
  for (const Pose& pose : motion.knots) knots.push_back(knot_of(pose));
  Adjustment(problem, knots).solve(iterations);
  for (std::size_t i = 0; i < knots.size(); ++i)
    motion.knots[i] =
        make_pose(rotation_of<double>(knots[i].data()), position_of<double>(knots[i].data()));
  return motion;
}

}  // namespace lidarena::estimation::oracle
