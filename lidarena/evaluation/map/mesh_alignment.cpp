// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/mesh_alignment.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "lidarena/base/so3.hpp"
#include "lidarena/estimation/least_squares.hpp"
#include "lidarena/estimation/robust_kernel.hpp"
#include "lidarena/evaluation/map/map_error.hpp"
#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::evaluation {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kVoxel_m = 0.10;            // gives equal areas equal weight
constexpr std::size_t kPoints = 50'000;      // 2 cm of noise average to 0.1 mm
constexpr std::size_t kStartPoints = 3'000;  // enough to see where a start converges
constexpr std::size_t kMinPoints = 100;
constexpr double kTrim = 0.95;  // share of the points that are used, nearest first
constexpr double kStartTranslation_m = 0.20;
constexpr double kStartRotation_rad = 2.0 * std::numbers::pi / 180.0;
constexpr double kMinScale_m = 0.01;   // of the kernel; ranges are not more accurate
constexpr double kReach_m = 1.0;       // farther points have no match
constexpr double kMaxCostRatio = 1.5;  // cost ratio, see fit_from
constexpr int kMaxIterations = 40;     // per scale

/// Smaller steps end the iteration at one scale.
struct Tolerance {
  double m = 1e-4;
  double rad = 1e-5;
};
constexpr Tolerance kFine;
constexpr Tolerance kCoarse{2e-3, 2e-4};

/// Scales of the kernel (m); the last is computed from the residuals.
constexpr std::array<std::optional<double>, 3> kScales{1.0, 0.2, std::nullopt};

/// Points of the map, and a scaling of rotations with which a unit twist moves them by the same
/// distance in every direction.
struct Points {
  std::vector<Vector3d> positions;  ///< m, map frame
  Vector3d centroid = Vector3d::Zero();
  Matrix3d rad_per_m = Matrix3d::Identity();  ///< rotations that move the points by 1 m RMS
};

/// The inverse square root of the mean of hat(p)^T hat(p), p from the centroid, map frame.
Matrix3d rotations_of_one_meter(const std::vector<Vector3d>& positions, const Vector3d& centroid) {
  Matrix3d levers = Matrix3d::Zero();
  for (const Vector3d& p : positions) {
    const Matrix3d hat = so3::hat(p - centroid);
    levers += hat.transpose() * hat;
  }
  levers /= static_cast<double>(positions.size());
  levers += 1e-6 * Matrix3d::Identity();  // m^2; no division by zero for points on a line
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(levers).operatorInverseSqrt();
}

Points every(std::size_t limit, std::span<const Eigen::Vector3f> map,
             std::span<const std::uint32_t> chosen) {
  Points points;
  const std::size_t stride = std::max<std::size_t>(1, (chosen.size() + limit - 1) / limit);
  for (std::size_t i = 0; i < chosen.size(); i += stride) {
    points.positions.push_back(map[chosen[i]].cast<double>());
    points.centroid += points.positions.back();
  }
  points.centroid /= static_cast<double>(points.positions.size());
  points.rad_per_m = rotations_of_one_meter(points.positions, points.centroid);
  return points;
}

/// Center and rotation scaling of a twist, mesh frame.
struct TwistFrame {
  Vector3d center;
  Matrix3d rad_per_m;
  TwistFrame(const Points& points, const Pose& pose)
      : center(pose * points.centroid),
        rad_per_m(pose.linear() * points.rad_per_m * pose.linear().transpose()) {}
};

/// `pose` followed by a translation (m) and a rotation (rad) about the frame's center.
Pose moved_by(const Vector3d& move, const Vector3d& turn, const TwistFrame& frame,
              const Pose& pose) {
  const Matrix3d rotation = so3::exp(turn);
  Pose moved = Pose::Identity();
  moved.linear() = rotation * pose.linear();
  moved.translation() = rotation * (pose.translation() - frame.center) + frame.center + move;
  return orthonormalized(moved);
}

/// The points and their nearest points on the mesh at one pose.
struct Matches {
  std::vector<Vector3d> positions;
  std::vector<world::ClosestPoint> nearest;
  double gate = 0.0;    ///< m, farther points are not used
  double median = 0.0;  ///< m, of the distances within the gate
};

Matches match(const Points& points, const Pose& pose, double reach, const world::World& world,
              const Parallel& parallel) {
  Matches matches;
  for (const Vector3d& p : points.positions) matches.positions.push_back(pose * p);
  matches.nearest.resize(matches.positions.size());
  world.closest_points(matches.positions, reach, matches.nearest, parallel);
  std::vector<double> distances;
  for (const world::ClosestPoint& nearest : matches.nearest) {
    if (nearest.valid()) distances.push_back(nearest.distance);
  }
  if (distances.empty()) return matches;
  matches.gate = results::quantile(distances, kTrim);
  matches.median = results::quantile(distances, 0.5);
  return matches;
}

estimation::NormalEquations<6> equations_of(const Matches& matches, const TwistFrame& frame,
                                            double scale, const world::World& world,
                                            const Parallel& parallel) {
  const world::TriangleMesh& mesh = world.mesh();
  return estimation::accumulate_normal_equations<6>(
      parallel, matches.positions.size(),
      [&](std::size_t i, estimation::NormalEquations<6>& equations) {
        const world::ClosestPoint& nearest = matches.nearest[i];
        if (!nearest.valid() || nearest.distance > matches.gate) return;
        const double weight = estimation::robust_weight(estimation::RobustKernel::kTukey,
                                                        nearest.distance * nearest.distance, scale);
        if (weight == 0.0) return;
        const Vector3d normal = mesh.cross(nearest.triangle).normalized();
        Eigen::Matrix<double, 1, 6> jacobian;
        const Vector3d lever = (matches.positions[i] - frame.center).cross(normal);
        jacobian << normal.transpose(), lever.transpose() * frame.rad_per_m;
        const Eigen::Matrix<double, 1, 1> residual(
            normal.dot(matches.positions[i] - nearest.point));
        equations.add<1>(jacobian, residual, weight);
      });
}

/// The Gauss-Newton step without its components along unobservable directions.
Vector6d observable_step(const estimation::NormalEquations<6>& equations, Vector6d& eigenvalues) {
  const double weight = static_cast<double>(equations.count);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(equations.hessian / weight);
  eigenvalues = solver.eigenvalues();
  Vector6d step = Vector6d::Zero();
  for (int k = 0; k < 6; ++k) {
    if (eigenvalues[k] < MeshAlignment::kUnobservable) continue;
    const Vector6d direction = solver.eigenvectors().col(k);
    step -= direction * (direction.dot(equations.gradient / weight) / eigenvalues[k]);
  }
  return step;
}

struct Fit {
  Pose pose = Pose::Identity();
  int iterations = 0;
  std::size_t scales = 0;                                 ///< number of kScales that were kept
  double cost = std::numeric_limits<double>::infinity();  ///< m^2, see rate()
  double inlier_share = 0.0;
  Matrix6d hessian = Matrix6d::Zero();  ///< per point
  Vector6d eigenvalues = Vector6d::Zero();
};

/// Iterates with one scale of the kernel (m), or with the residuals' own when none is given.
void descend(const Points& points, std::optional<double> fixed_scale, const Tolerance& tolerance,
             const world::World& world, const Parallel& parallel, Fit& fit) {
  for (int i = 0; i < kMaxIterations; ++i) {
    const double reach = fixed_scale.value_or(kReach_m);
    Matches matches = match(points, fit.pose, reach, world, parallel);
    if (fixed_scale == kScales.front()) matches.gate = reach;  // no trimming at the first scale
    const double scale = fixed_scale.value_or(std::max(kMinScale_m, 3.0 * 1.4826 * matches.median));
    const TwistFrame frame(points, fit.pose);
    const estimation::NormalEquations<6> equations =
        equations_of(matches, frame, scale, world, parallel);
    if (equations.count < kMinPoints / 2) return;
    fit.hessian = equations.hessian / static_cast<double>(equations.count);
    const Vector6d step = observable_step(equations, fit.eigenvalues);
    const Vector3d turn = frame.rad_per_m * step.tail<3>();
    fit.pose = moved_by(step.head<3>(), turn, frame, fit.pose);
    ++fit.iterations;
    if (step.head<3>().norm() < tolerance.m && turn.norm() < tolerance.rad) return;
  }
}

/// Computes the cost (mean of the squared distances, each at most 1 m) and the share within 20 cm.
void rate(const Points& points, const world::World& world, const Parallel& parallel, Fit& fit) {
  const Matches matches = match(points, fit.pose, kReach_m, world, parallel);
  double squares = 0.0;
  std::size_t inliers = 0;
  for (const world::ClosestPoint& nearest : matches.nearest) {
    const double d = nearest.valid() ? nearest.distance : kReach_m;
    squares += d * d;
    if (d <= MapError::kOutlier_m) ++inliers;
  }
  const auto n = static_cast<double>(matches.nearest.size());
  fit.cost = squares / n;
  fit.inlier_share = static_cast<double>(inliers) / n;
}

/// Fits with up to `max_scales` scales. A narrower kernel may align one part of a bent map with
/// the mesh and ignore the rest; a result whose total cost is clearly higher is not kept.
Fit fit_from(const Pose& start, std::size_t max_scales, const Points& points,
             const world::World& world, const Parallel& parallel) {
  Fit fit;
  fit.pose = start;
  while (fit.scales < max_scales) {
    Fit next = fit;
    descend(points, kScales[fit.scales], kCoarse, world, parallel, next);
    rate(points, world, parallel, next);
    if (next.cost > kMaxCostRatio * fit.cost) return fit;
    fit = next;
    ++fit.scales;
  }
  return fit;
}

/// The given pose, and four that move the points by 20 cm and 2 degrees towards the corners of a
/// tetrahedron.
std::vector<Pose> starts_around(const Pose& start, const Points& points) {
  const std::vector<Vector3d> corners{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  std::vector<Pose> starts{start};
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vector3d turn = kStartRotation_rad * corners[(k + 1) % corners.size()].normalized();
    starts.push_back(moved_by(kStartTranslation_m * corners[k].normalized(), turn,
                              TwistFrame(points, start), start));
  }
  return starts;
}

/// RMS motion (m) of the points from one pose to the other along observable directions.
double rms_motion_between(const Pose& a, const Pose& b, const Points& points,
                          const Matrix6d& hessian) {
  const TwistFrame frame(points, a);
  Vector6d twist;
  twist << (b * points.centroid - a * points.centroid),
      frame.rad_per_m.inverse() * so3::log(b.linear() * a.linear().transpose());
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(hessian);
  double squares = 0.0;
  for (int k = 0; k < 6; ++k) {
    if (solver.eigenvalues()[k] < MeshAlignment::kUnobservable) continue;
    const double along = solver.eigenvectors().col(k).dot(twist);
    squares += along * along;
  }
  return std::sqrt(squares);
}

/// Result of the iterations from all starts.
struct Starts {
  Pose pose = Pose::Identity();
  int agreeing = 0;
  std::size_t scales = 1;
  int iterations = 0;
};

/// Iterates from all starts; if their results differ, again with one narrow scale less.
Starts narrowest_agreeing_fit(const Pose& start, const Points& points, const world::World& world,
                              const Parallel& parallel) {
  Starts result;
  result.scales = kScales.size();
  while (true) {
    std::vector<Fit> fits;
    for (const Pose& from : starts_around(start, points)) {
      fits.push_back(fit_from(from, result.scales, points, world, parallel));
      result.scales = fits.front().scales;  // as the given start, to compare the results
      result.iterations += fits.back().iterations;
    }
    const auto cheaper = [](const Fit& a, const Fit& b) { return a.cost < b.cost; };
    const Fit& best = *std::min_element(fits.begin(), fits.end(), cheaper);
    const auto agrees = [&](const Fit& fit) {
      return rms_motion_between(fit.pose, best.pose, points, best.hessian) <
             MeshAlignment::kAgree_m;
    };
    result.agreeing = static_cast<int>(std::count_if(fits.begin(), fits.end(), agrees));
    // prefer the given start, because its result keeps the unobservable directions of the start
    result.pose = agrees(fits.front()) ? fits.front().pose : best.pose;
    if (2 * result.agreeing > MeshAlignment::kStarts || result.scales == 1) return result;
    --result.scales;
  }
}

std::string named(const char* what, Vector3d axis) {
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  if (axis[largest] < 0.0) axis = -axis;
  axis = (100.0 * axis).array().round() / 100.0 + 0.0;  // no negative zero
  return fmt::format("{} ({:.2f}, {:.2f}, {:.2f})", what, axis.x(), axis.y(), axis.z());
}

/// Names the unobservable directions: translations, then rotations that stay unobservable when the
/// points may also translate (Schur complement).
std::vector<std::string> unobservable_directions(const Matrix6d& hessian,
                                                 const Matrix3d& rad_per_m) {
  std::vector<std::string> names;
  const Matrix3d tt = hessian.topLeftCorner<3, 3>();
  const Matrix3d tr = hessian.topRightCorner<3, 3>();
  const Matrix3d rr = hessian.bottomRightCorner<3, 3>();
  const Eigen::SelfAdjointEigenSolver<Matrix3d> translation(tt);
  Matrix3d inverse = Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const Vector3d axis = translation.eigenvectors().col(k);
    const double value = translation.eigenvalues()[k];
    if (value < MeshAlignment::kUnobservable) {
      names.push_back(named("translation along", axis));
    } else {
      inverse += axis * axis.transpose() / value;
    }
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> rotation(rr - tr.transpose() * inverse * tr);
  for (int k = 0; k < 3; ++k) {
    if (rotation.eigenvalues()[k] >= MeshAlignment::kUnobservable) continue;
    const Vector3d axis = rad_per_m * rotation.eigenvectors().col(k);
    names.push_back(named("rotation about", axis.normalized()));
  }
  return names;
}

std::string refusal_of(const MeshAlignment& alignment) {
  if (alignment.fit.inliers_percent < 100.0 * MeshAlignment::kMinInliers) {
    return fmt::format("only {:.0f} % of the map's points lie within 20 cm of the mesh",
                       alignment.fit.inliers_percent);
  }
  if (2 * alignment.fit.starts_agreeing <= MeshAlignment::kStarts) {
    return fmt::format("only {} of {} starts converge to the same pose",
                       alignment.fit.starts_agreeing, MeshAlignment::kStarts);
  }
  return {};
}

}  // namespace

MeshAlignment align_to_mesh(std::span<const Eigen::Vector3f> map, const Pose& start,
                            const world::World& world, const Parallel& parallel) {
  MeshAlignment alignment;
  alignment.mesh_from_map = start;
  const std::vector<std::uint32_t> chosen = map::first_of_each_voxel(map, kVoxel_m);
  if (chosen.size() < kMinPoints) {
    alignment.refusal = fmt::format("only {} voxels of 10 cm to align", chosen.size());
    return alignment;
  }
  const Points few = every(kStartPoints, map, chosen);
  const Starts starts = narrowest_agreeing_fit(start, few, world, parallel);
  alignment.fit.starts_agreeing = starts.agreeing;

  const Points many = every(kPoints, map, chosen);
  Fit fit;
  fit.pose = starts.pose;
  descend(many, kScales[starts.scales - 1], kFine, world, parallel, fit);
  rate(many, world, parallel, fit);
  alignment.mesh_from_map = fit.pose;
  results::MeshFit& found = alignment.fit;
  found.points = many.positions.size();
  found.iterations = starts.iterations + fit.iterations;
  found.inliers_percent = 100.0 * fit.inlier_share;
  Vector6d::Map(found.eigenvalues.data()) = fit.eigenvalues;
  found.frozen = unobservable_directions(fit.hessian, TwistFrame(many, fit.pose).rad_per_m);
  found.moved_m = (fit.pose * many.centroid - start * many.centroid).norm();
  found.turned_rad = so3::angle(fit.pose.linear() * start.linear().transpose());
  alignment.refusal = refusal_of(alignment);
  return alignment;
}

}  // namespace lidarena::evaluation
