// SPDX-License-Identifier: BSD-3-Clause
// Minimizes the same cost as elastic_alignment.cpp; the prior is written a second time, for
// automatic differentiation.
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/elastic_alignment.hpp"

namespace lidarena::estimation {

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
template <class T>
bool put(double weight, const Vector3<T>& error, T* residual) {
  Eigen::Map<Vector3<T>>{residual} = T(weight) * error;
  return true;
}

/// A point's error, with the analytic derivative of ElasticSegment: automatic differentiation takes
/// ten times as long.
template <int kRows>
class MatchCost : public ceres::SizedCostFunction<kRows, kKnot, kKnot> {
 public:
  /// `a`: position in the segment, 0 to 1.
  MatchCost(const ElasticMatch& match, double a) : match_(match), a_(a) {}

  bool Evaluate(double const* const* knots, double* residual, double** jacobians) const override {
    const ElasticSegment segment(pose_of(knots[0]), pose_of(knots[1]));
    const Eigen::Vector3d gap = segment.place(match_.point, a_) - match_.anchor;
    for (int r = 0; r < kRows; ++r) {
      const Eigen::Vector3d direction = match_.weight * match_.shape.row(r);
      residual[r] = direction.dot(gap);
      if (jacobians == nullptr) continue;
      const auto row = segment.row(match_.point, a_, direction);
      for (int k = 0; k < 2; ++k) {
        if (jacobians[k] == nullptr) continue;
        Eigen::Map<Eigen::RowVector4d>(jacobians[k] + r * kKnot) =
            by_quaternion(row.segment<3>(6 * k + 3), knots[k]);
        Eigen::Map<Eigen::RowVector3d>(jacobians[k] + r * kKnot + 4) = row.segment<3>(6 * k);
      }
    }
    return true;
  }

 private:
  static Pose pose_of(const double* knot) {
    return make_pose(rotation_of(knot).toRotationMatrix(), Eigen::Vector3d(position_of(knot)));
  }
  /// Converts a derivative with respect to a rotation vector on the left to one with respect to x y
  /// z w. The manifold's increment d maps q to the product (d, 1) q, which rotates by 2 d; its
  /// derivative G has orthonormal columns.
  static Eigen::RowVector4d by_quaternion(const Eigen::RowVector3d& by_rotation,
                                          const double* knot) {
    const Eigen::Vector3d v(knot[0], knot[1], knot[2]);
    Eigen::Matrix<double, 4, 3> g;
    g << knot[3] * Eigen::Matrix3d::Identity() - so3::hat(v), -v.transpose();
    return 2.0 * by_rotation * g.transpose();
  }

  const ElasticMatch& match_;
  double a_;
};

struct LocationCost {
  double weight;
  Eigen::Vector3d expected;
  template <class T>
  bool operator()(const T* knot, T* residual) const {
    return put<T>(weight, position_of(knot) - expected.cast<T>(), residual);
  }
};

struct OrientationCost {
  double weight;
  Eigen::Quaterniond expected;
  template <class T>
  bool operator()(const T* knot, T* residual) const {
    return put<T>(weight, rotation_vector<T>(rotation_of(knot) * expected.conjugate().cast<T>()),
                  residual);
  }
};

struct StepCost {
  double weight;
  Eigen::Vector3d expected;
  template <class T>
  bool operator()(const T* from, const T* to, T* residual) const {
    return put<T>(weight, position_of(to) - position_of(from) - expected.cast<T>(), residual);
  }
};

struct RotationCost {
  double weight;
  Eigen::Vector3d expected;
  template <class T>
  bool operator()(const T* from, const T* to, T* residual) const {
    return put<T>(weight, rotation_between(from, to) - expected.cast<T>(), residual);
  }
};

struct BendCost {
  double weight;
  template <class T>
  bool operator()(const T* before, const T* here, const T* after, T* residual) const {
    return put<T>(weight, position_of(before) - T(2.0) * position_of(here) + position_of(after),
                  residual);
  }
};

struct AngularBendCost {
  double weight;
  template <class T>
  bool operator()(const T* before, const T* here, const T* after, T* residual) const {
    return put<T>(weight, rotation_between(here, after) - rotation_between(before, here), residual);
  }
};

/// An ElasticProblem as a Ceres problem that changes `knots` in place.
class Adjustment {
 public:
  Adjustment(const ElasticProblem& problem, std::vector<Knot>& knots)
      : problem_(problem),
        knots_(knots),
        manifold_(ceres::EigenQuaternionManifold{}, ceres::EuclideanManifold<3>{}),
        loss_(make_ceres_loss(problem.kernel, problem.kernel_scale)),
        adjustment_(options()) {
    for (Knot& knot : knots_) adjustment_.AddParameterBlock(knot.data(), kKnot, &manifold_);
    for (const ElasticMatch& match : problem_.matches) add(match);
    add_prior();
  }

  void solve(int iterations) {
    ceres::Solver::Options options;
    options.max_num_iterations = iterations;
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &adjustment_, &summary);
  }

 private:
  static ceres::Problem::Options options() {
    ceres::Problem::Options options;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  void add(const ElasticMatch& match) {
    const double position = match.alpha * static_cast<double>(knots_.size() - 1);
    const std::size_t first = std::min(static_cast<std::size_t>(position), knots_.size() - 2);
    const double a = position - static_cast<double>(first);
    ceres::CostFunction* cost = nullptr;
    if (match.rows == 1) cost = new MatchCost<1>(match, a);
    if (match.rows == 3) cost = new MatchCost<3>(match, a);
    adjustment_.AddResidualBlock(cost, loss_.get(), knots_[first].data(), knots_[first + 1].data());
  }

  /// Adds one term of the prior over the knots with these indices, unless its weight is zero.
  template <class Cost, class... Blocks>
  void add_term(double weight, Cost cost, Blocks... knots) {
    if (!(weight > 0.0)) return;
    cost.weight = std::sqrt(weight * static_cast<double>(problem_.matches.size()));
    using Function = ceres::AutoDiffCostFunction<Cost, 3, ((void)sizeof(Blocks), kKnot)...>;
    adjustment_.AddResidualBlock(new Function(new Cost(cost)), nullptr, knots_[knots].data()...);
  }

  void add_prior() {
    const MotionPrior& prior = problem_.prior;
    const std::size_t first = 0;
    const std::size_t last = knots_.size() - 1;
    add_term(prior.location, LocationCost{0.0, prior.begin.translation()}, first);
    add_term(prior.orientation, OrientationCost{0.0, Eigen::Quaterniond(prior.begin.linear())},
             first);
    add_term(prior.velocity, StepCost{0.0, prior.step}, first, last);
    add_term(prior.small_velocity, StepCost{0.0, Eigen::Vector3d::Zero()}, first, last);
    add_term(prior.angular_velocity, RotationCost{0.0, prior.turn}, first, last);
    for (std::size_t i = 1; i < last; ++i) {
      add_term(prior.velocity_change, BendCost{0.0}, i - 1, i, i + 1);
      add_term(prior.angular_velocity_change, AngularBendCost{0.0}, i - 1, i, i + 1);
    }
  }

  const ElasticProblem& problem_;
  std::vector<Knot>& knots_;
  ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>> manifold_;
  std::unique_ptr<ceres::LossFunction> loss_;
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
  if (problem.matches.empty()) return motion;
  std::vector<Knot> knots;
  for (const Pose& pose : motion.knots) knots.push_back(knot_of(pose));
  Adjustment(problem, knots).solve(iterations);
  for (std::size_t i = 0; i < knots.size(); ++i)
    motion.knots[i] =
        make_pose(rotation_of<double>(knots[i].data()), position_of<double>(knots[i].data()));
  return motion;
}

}  // namespace lidarena::estimation
