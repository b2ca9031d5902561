// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/loop/icp.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/least_squares.hpp"

namespace lidarena::loop {
namespace {

using Equations =
    estimation::NormalEquations<6>;  // rotation about the target's origin, translation
using Eigen::Vector3d;

constexpr std::size_t kPlanePoints = 6;
constexpr double kFlat = 0.1;                    // maximum ratio of the variances across and along
constexpr double kPlaneReach = 1.0;              // m: minimum search radius for points of a plane
constexpr std::size_t kMinCorrespondences = 10;  // minimum number of correspondences
constexpr double kConvergedStep = 3e-4;          // m, rad: converged below this step
constexpr double kShrink = 0.7;                  // factor on the maximum distance per iteration
constexpr double kInlierDistance = 0.3;          // m: closer points overlap; final maximum distance
constexpr int kMaxPointIterations = 100;
constexpr int kMaxPlaneIterations = 40;

/// Calls `visit` with the squared distance (m^2) of each point, placed by `pose`, to the nearest
/// target point within `reach` (m).
template <class Visit>
void for_each_distance(std::span<const Eigen::Vector3f> source, const map::KdTree& target,
                       const Pose& pose, double reach, Visit&& visit) {
  for (const Eigen::Vector3f& point : source) {
    std::array<map::Neighbor, 1> near;
    const Eigen::Vector3f moved = (pose * point.cast<double>()).cast<float>();
    if (target.nearest(moved, near, static_cast<float>(reach)) > 0)
      visit(double{near[0].squared_distance});
  }
}

double mean(double sum, std::size_t count) {
  return count == 0 ? std::numeric_limits<double>::infinity() : sum / static_cast<double>(count);
}

/// Moves `target_from_source` by the least-squares step; returns its largest component (m, rad), or
/// nothing if `sum` determines none.
std::optional<double> improve(const Equations& sum, Pose& target_from_source) {
  const Equations::Vector step = sum.solve();
  if (sum.count < kMinCorrespondences || !step.allFinite()) return std::nullopt;
  target_from_source =
      orthonormalized(make_pose(so3::exp(step.head<3>()), step.tail<3>()) * target_from_source);
  return step.cwiseAbs().maxCoeff();
}

/// Fits a plane to the points `near`; returns whether they are flat.
bool find_normal(std::span<const map::Neighbor> near, Vector3d& normal) {
  Vector3d center = Vector3d::Zero();
  for (const map::Neighbor& n : near)
    center += n.point.cast<double>() / static_cast<double>(near.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const map::Neighbor& n : near) {
    const Vector3d d = n.point.cast<double>() - center;
    spread += d * d.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(spread);
  normal = solver.eigenvectors().col(0);
  return solver.eigenvalues()[0] < kFlat * solver.eigenvalues()[1];
}

void add_plane(const Vector3d& moved, const map::KdTree& target, double reach, Equations& sum) {
  std::array<map::Neighbor, kPlanePoints> near;
  const std::size_t found =
      target.nearest(moved.cast<float>(), near, static_cast<float>(std::max(reach, kPlaneReach)));
  if (found < kPlanePoints || double{near[0].squared_distance} > reach * reach) return;
  Vector3d normal;
  if (!find_normal(near, normal)) return;
  const double distance = normal.dot(moved - near[0].point.cast<double>());
  Eigen::Matrix<double, 1, 6> j;
  j << moved.cross(normal).transpose(), normal.transpose();
  // Geman-McClure: points that do not belong to the place have little influence
  const double scale = 0.3 * reach;
  const double weight = 1.0 / (1.0 + distance * distance / (scale * scale));
  sum.add<1>(j, Eigen::Matrix<double, 1, 1>(distance), weight * weight);
}

Equations point_equations(std::span<const Eigen::Vector3f> source, const map::KdTree& target,
                          const Pose& pose, double reach, const Parallel& parallel) {
  return estimation::accumulate_normal_equations<6>(
      parallel, source.size(), [&](std::size_t i, Equations& sum) {
        const Vector3d moved = pose * source[i].cast<double>();
        std::array<map::Neighbor, 1> near;
        if (target.nearest(moved.cast<float>(), near, static_cast<float>(reach)) == 0) return;
        Eigen::Matrix<double, 3, 6> jacobian;
        jacobian << -so3::hat(moved), Eigen::Matrix3d::Identity();
        sum.add<3>(jacobian, moved - near[0].point.cast<double>(), 1.0);
      });
}

Equations plane_equations(std::span<const Eigen::Vector3f> source, const map::KdTree& target,
                          const Pose& pose, double reach, const Parallel& parallel) {
  return estimation::accumulate_normal_equations<6>(
      parallel, source.size(), [&](std::size_t i, Equations& sum) {
        add_plane(pose * source[i].cast<double>(), target, reach, sum);
      });
}

void measure(std::span<const Eigen::Vector3f> source, const map::KdTree& target,
             IcpResult& result) {
  double sum = 0.0;
  std::size_t reached = 0;
  std::size_t inliers = 0;
  for_each_distance(source, target, result.target_from_source, kInlierDistance,
                    [&](double squared) {
                      sum += squared;
                      ++reached;
                      if (squared <= kInlierDistance * kInlierDistance) ++inliers;
                    });
  result.fitness = mean(sum, reached);
  result.overlap =
      source.empty() ? 0.0 : static_cast<double>(inliers) / static_cast<double>(source.size());
}

/// Share of the least constrained direction in all information; rotations are about `center`, and
/// `lever` (m) scales them to translations.
double constraint_of(Equations sum, double lever, const Vector3d& center) {
  Eigen::Matrix<double, 6, 6> to_center = Eigen::Matrix<double, 6, 6>::Identity();
  to_center.bottomLeftCorner<3, 3>() = so3::hat(center);
  Eigen::Matrix<double, 6, 6> hessian = to_center.transpose() * sum.hessian * to_center;
  Eigen::Matrix<double, 6, 1> unit = Eigen::Matrix<double, 6, 1>::Ones();
  unit.head<3>().setConstant(1.0 / lever);
  hessian = (unit.asDiagonal() * hessian * unit.asDiagonal()).eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(hessian,
                                                                          Eigen::EigenvaluesOnly);
  const double all = hessian.trace();
  return all > 0.0 ? solver.eigenvalues()[0] / all : 0.0;
}

}  // namespace

PointAlignment align_points(std::span<const Eigen::Vector3f> source, const map::KdTree& target,
                            const Pose& guess, double reach, const Parallel& parallel) {
  PointAlignment result{.target_from_source = guess};
  for (int i = 0; i < kMaxPointIterations && !result.converged; ++i) {
    const Equations sum =
        point_equations(source, target, result.target_from_source, reach, parallel);
    const std::optional<double> step = improve(sum, result.target_from_source);
    if (!step) break;
    result.converged = *step < kConvergedStep;
  }
  double squares = 0.0;
  std::size_t reached = 0;
  for_each_distance(source, target, result.target_from_source, reach, [&](double squared) {
    squares += squared;
    ++reached;
  });
  result.fitness = mean(squares, reached);
  return result;
}

IcpResult align_clouds(std::span<const Eigen::Vector3f> source, const map::KdTree& target,
                       const Pose& guess, const Parallel& parallel) {
  IcpResult result;
  result.target_from_source = guess;
  double reach = kIcpReach;
  Equations sum;
  while (result.iterations < kMaxPlaneIterations && !result.converged) {
    ++result.iterations;
    const bool at_last = reach <= kInlierDistance;
    sum = plane_equations(source, target, result.target_from_source, reach, parallel);
    const std::optional<double> step = improve(sum, result.target_from_source);
    if (!step) break;
    result.converged = at_last && *step < kConvergedStep;
    reach = std::max(kInlierDistance, kShrink * reach);
  }
  measure(source, target, result);
  Vector3d center = Vector3d::Zero();
  for (const Eigen::Vector3f& p : source)
    center += p.cast<double>() / static_cast<double>(source.size());
  double squared = 1e-6;
  for (const Eigen::Vector3f& p : source)
    squared += (p.cast<double>() - center).squaredNorm() / static_cast<double>(source.size());
  result.constraint = constraint_of(sum, std::sqrt(squared), result.target_from_source * center);
  return result;
}

}  // namespace lidarena::loop
