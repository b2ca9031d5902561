// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/pose_graph.hpp"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Cholesky>
#include <string>

#include "lidarena/base/error.hpp"
#include "lidarena/base/so3.hpp"

namespace lidarena::estimation {
namespace {

constexpr double kFixedVariance = 1e-8;  // m^2, rad^2, of the first node of a chain

/// The parameters of a node in the solver.
struct Parameters {
  Eigen::Quaterniond rotation;
  Eigen::Vector3d translation;
};

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Quaternion = Eigen::Quaternion<T>;

/// (translation, rotation vector) from the measured to the estimated motion.
template <class T>
Eigen::Matrix<T, 6, 1> difference(const Quaternion<T>& rotation, const Vector3<T>& translation,
                                  const Pose& measured) {
  const Quaternion<T> turned =
      Eigen::Quaterniond(measured.linear()).conjugate().cast<T>() * rotation;
  const T wxyz[4] = {turned.w(), turned.x(), turned.y(), turned.z()};
  Eigen::Matrix<T, 6, 1> error;
  error.template head<3>() = translation - measured.translation().cast<T>();
  ceres::QuaternionToAngleAxis(wxyz, error.data() + 3);
  return error;
}

struct PriorError {
  Pose measured;
  PoseGraph::Covariance root;  ///< square root of the information

  template <class T>
  bool operator()(const T* rotation, const T* translation, T* residual) const {
    const Quaternion<T> q(rotation);
    const Quaternion<T> back = Eigen::Quaterniond(measured.linear()).conjugate().cast<T>();
    const Vector3<T> moved =
        back * (Eigen::Map<const Vector3<T>>(translation) - measured.translation().cast<T>());
    const Pose turned = make_pose(Eigen::Quaterniond(measured.linear()), Eigen::Vector3d::Zero());
    Eigen::Map<Eigen::Matrix<T, 6, 1>>{residual} = root.cast<T>() * difference<T>(q, moved, turned);
    return true;
  }
};

struct BetweenError {
  Pose measured;
  PoseGraph::Covariance root;

  template <class T>
  bool operator()(const T* rotation_a, const T* translation_a, const T* rotation_b,
                  const T* translation_b, T* residual) const {
    const Quaternion<T> back = Quaternion<T>(rotation_a).conjugate();
    const Vector3<T> relative_translation = back * (Eigen::Map<const Vector3<T>>(translation_b) -
                                                    Eigen::Map<const Vector3<T>>(translation_a));
    const Quaternion<T> turned = back * Quaternion<T>(rotation_b);
    Eigen::Map<Eigen::Matrix<T, 6, 1>>{residual} =
        root.cast<T>() * difference<T>(turned, relative_translation, measured);
    return true;
  }
};

struct PositionError {
  Eigen::Vector3d measured;
  Eigen::Matrix3d root;

  template <class T>
  bool operator()(const T* translation, T* residual) const {
    Eigen::Map<Vector3<T>>{residual} =
        root.cast<T>() * (Eigen::Map<const Vector3<T>>(translation) - measured.cast<T>());
    return true;
  }
};

/// U with U^T U the inverse of `covariance`.
template <int N>
Eigen::Matrix<double, N, N> root_of_information(const Eigen::Matrix<double, N, N>& covariance) {
  const Eigen::LLT<Eigen::Matrix<double, N, N>> factor(covariance);
  if (!covariance.allFinite() || factor.info() != Eigen::Success) {
    throw InputError("pose graph", "a covariance is not positive definite",
                     "give every direction a variance above zero");
  }
  return factor.matrixL().solve(Eigen::Matrix<double, N, N>::Identity());
}

/// Builds the Ceres problem, which owns the objects created by `new` here.
class Problem {
 public:
  explicit Problem(const PoseGraph& graph) {
    for (const Pose& node : graph.nodes) {
      if (!node.matrix().allFinite()) {
        throw InputError("pose graph", "the pose of a node is not finite",
                         "leave out poses that diverged");
      }
      parameters_.push_back({Eigen::Quaterniond(node.linear()), node.translation()});
    }
    for (Parameters& node : parameters_) {
      problem_.AddParameterBlock(node.rotation.coeffs().data(), 4,
                                 new ceres::EigenQuaternionManifold);
      problem_.AddParameterBlock(node.translation.data(), 3);
    }
    for (const auto& prior : graph.priors) add(prior);
    for (const auto& between : graph.betweens) add(between);
    for (const auto& position : graph.positions) add(position);
    if (graph.priors.empty() && graph.positions.empty() && !parameters_.empty()) {
      problem_.SetParameterBlockConstant(rotation(0));
      problem_.SetParameterBlockConstant(translation(0));
    }
  }

  ceres::Solver::Summary solve(int max_iterations) {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    options.num_threads = 1;
    options.max_num_iterations = max_iterations;
    // A large trust region, so nearly Gauss-Newton: a long chain of poses has little stiffness
    // against bending, and the default damping would keep it from moving.
    options.initial_trust_region_radius = 1e12;
    options.function_tolerance = 1e-10;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    return summary;
  }

  std::vector<Pose> nodes() const {
    std::vector<Pose> nodes;
    for (const Parameters& p : parameters_) nodes.push_back(make_pose(p.rotation, p.translation));
    return nodes;
  }

 private:
  double* rotation(std::size_t node) { return checked(node).rotation.coeffs().data(); }
  double* translation(std::size_t node) { return checked(node).translation.data(); }
  Parameters& checked(std::size_t node) {
    if (node < parameters_.size()) return parameters_[node];
    throw InputError("pose graph", "there is no node " + std::to_string(node),
                     "add its pose to `nodes` first");
  }

  // Nodes are looked up (which may throw) before a cost function is created, because the solver
  // owns that only once it is added.
  void add(const PoseGraph::Prior& prior) {
    double* const blocks[] = {rotation(prior.node), translation(prior.node)};
    auto* error = new ceres::AutoDiffCostFunction<PriorError, 6, 4, 3>(
        new PriorError{prior.world_from_node, root_of_information(prior.covariance)});
    problem_.AddResidualBlock(error, nullptr, blocks, 2);
  }
  void add(const PoseGraph::Between& between) {
    double* const blocks[] = {rotation(between.first), translation(between.first),
                              rotation(between.second), translation(between.second)};
    auto* error = new ceres::AutoDiffCostFunction<BetweenError, 6, 4, 3, 4, 3>(
        new BetweenError{between.first_from_second, root_of_information(between.covariance)});
    problem_.AddResidualBlock(error, make_ceres_loss(between.loss.kernel, between.loss.scale),
                              blocks, 4);
  }
  void add(const PoseGraph::Position& position) {
    double* const block = translation(position.node);
    auto* error = new ceres::AutoDiffCostFunction<PositionError, 3, 3>(
        new PositionError{position.position, root_of_information(position.covariance)});
    problem_.AddResidualBlock(error, make_ceres_loss(position.loss.kernel, position.loss.scale),
                              block);
  }

  std::vector<Parameters> parameters_;
  ceres::Problem problem_;
};

}  // namespace

PoseGraph::Covariance diagonal_covariance(double translation, double rotation) {
  PoseGraph::Covariance covariance = PoseGraph::Covariance::Zero();
  covariance.diagonal().head<3>().setConstant(translation);
  covariance.diagonal().tail<3>().setConstant(rotation);
  return covariance;
}

void append_to_chain(const Pose& previous_from_next, const PoseGraph::Covariance& covariance,
                     PoseGraph& graph) {
  const std::size_t next = graph.nodes.size();
  if (next == 0) {
    graph.nodes.push_back(previous_from_next);
    graph.priors.push_back(
        {0, previous_from_next, diagonal_covariance(kFixedVariance, kFixedVariance)});
    return;
  }
  graph.nodes.push_back(orthonormalized(graph.nodes.back() * previous_from_next));
  graph.betweens.push_back({next - 1, next, previous_from_next, covariance});
}

std::uint64_t memory_bytes(const PoseGraph& graph) {
  return graph.nodes.capacity() * sizeof(Pose) +
         graph.betweens.capacity() * sizeof(PoseGraph::Between);
}

double squared_mahalanobis(const PoseGraph& graph, const PoseGraph::Between& measurement) {
  const Pose estimated =
      graph.nodes.at(measurement.first).inverse() * graph.nodes.at(measurement.second);
  const auto error = difference<double>(Eigen::Quaterniond(estimated.linear()),
                                        estimated.translation(), measurement.first_from_second);
  return (root_of_information(measurement.covariance) * error).squaredNorm();
}

PoseGraphSolution optimize(const PoseGraph& graph, int max_iterations) {
  Problem problem(graph);
  const ceres::Solver::Summary summary = problem.solve(max_iterations);
  PoseGraphSolution solution;
  solution.nodes = problem.nodes();
  solution.initial_cost = summary.initial_cost;
  solution.final_cost = summary.final_cost;
  solution.iterations = static_cast<int>(summary.iterations.size());
  solution.converged = summary.termination_type == ceres::CONVERGENCE;
  return solution;
}

}  // namespace lidarena::estimation
