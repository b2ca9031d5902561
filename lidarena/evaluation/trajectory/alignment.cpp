// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/trajectory/alignment.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

namespace lidarena::evaluation {
namespace {

// Positions that spread less than this (1 cm) determine no direction: noise dominates.
constexpr double kMinSpread_m = 0.01;
// A flight whose width is under a thousandth of its length counts as a line: the roll about it has
// an uncertainty of (position error) / (width), more than a radian for 1 cm in 10 m.
constexpr double kMinWidthOfLength = 1e-3;
// With a larger tilt of the z axis a heading-only fit is wrong by more than 3.5 cm per meter.
constexpr double kMaxTilt_rad = 0.035;

/// Means and cross covariance C = mean (q - q_mean) (p - p_mean)^T of truth q and estimate p.
struct Moments {
  Eigen::Vector3d truth_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d estimate_mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  double estimate_variance = 0.0;
};

Moments moments_of(std::span<const PosePair> pairs) {
  Moments m;
  const auto n = static_cast<double>(pairs.size());
  for (const PosePair& pair : pairs) {
    m.truth_mean += pair.truth.translation() / n;
    m.estimate_mean += pair.estimate.translation() / n;
  }
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d q = pair.truth.translation() - m.truth_mean;
    const Eigen::Vector3d p = pair.estimate.translation() - m.estimate_mean;
    m.cross += q * p.transpose() / n;
    m.estimate_variance += p.squaredNorm() / n;
  }
  return m;
}

double tilt_of(const Eigen::Matrix3d& rotation) {
  const Eigen::Vector3d z = rotation.col(2);
  return std::atan2(z.head<2>().norm(), z.z());
}

/// Translation and the best heading: argmax over theta of tr(Rz(theta)^T C).
Pose fit_position_and_yaw(const Moments& m) {
  const Eigen::Matrix3d& c = m.cross;
  const double yaw = std::atan2(c(1, 0) - c(0, 1), c(0, 0) + c(1, 1));
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return make_pose(rotation, m.truth_mean - rotation * m.estimate_mean);
}

/// Why the fit is not determined; empty when it is.
std::string refusal_of(std::span<const PosePair> pairs, const Moments& m,
                       const Eigen::Vector3d& singular_values, AlignmentKind kind) {
  if (pairs.empty()) return "no estimate lies inside the truth's time span";
  if (kind == AlignmentKind::kFirstPose) return {};
  if (pairs.size() < 3) return fmt::format("only {} common poses, 3 are needed", pairs.size());
  const double length = std::sqrt(singular_values[0]);
  if (length < kMinSpread_m) {
    return fmt::format("the positions spread only {:.2g} m: rotation undetermined", length);
  }
  const double width = std::sqrt(singular_values[1]);
  if (kind == AlignmentKind::kSe3 && width < kMinWidthOfLength * length) {
    return fmt::format("the flight is a line ({:.2g} m wide, {:.2g} m long): roll undetermined",
                       width, length);
  }
  const Eigen::Matrix2d horizontal = m.cross.topLeftCorner<2, 2>();
  const double turned = std::hypot(horizontal(1, 0) - horizontal(0, 1), horizontal.trace());
  if (kind == AlignmentKind::kPosYaw && std::sqrt(turned) < kMinSpread_m) {
    return "the positions do not spread horizontally: heading undetermined";
  }
  return {};
}

}  // namespace

const char* to_string(AlignmentKind kind) {
  switch (kind) {
    case AlignmentKind::kFirstPose:
      return "first_pose";
    case AlignmentKind::kSe3:
      return "se3";
    case AlignmentKind::kPosYaw:
      return "posyaw";
  }
  return "unknown";
}

Similarity umeyama(std::span<const PosePair> pairs, bool with_scale) {
  const Moments m = moments_of(pairs);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m.cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Similarity fit;
  if (svd.info() != Eigen::Success) return fit;  // positions so large that their squares overflow
  Eigen::Vector3d s = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) s.z() = -1.0;
  fit.singular_values = svd.singularValues();
  fit.rotation = svd.matrixU() * s.asDiagonal() * svd.matrixV().transpose();
  if (with_scale && m.estimate_variance > 0.0) {
    fit.scale = fit.singular_values.dot(s) / m.estimate_variance;
  }
  fit.translation = m.truth_mean - fit.scale * fit.rotation * m.estimate_mean;
  return fit;
}

Alignment align(std::span<const PosePair> pairs, AlignmentKind kind) {
  Alignment alignment;
  alignment.kind = kind;
  const Moments m = moments_of(pairs);
  const Similarity fit = umeyama(pairs, true);
  alignment.refusal = refusal_of(pairs, m, fit.singular_values, kind);
  if (!alignment.determined()) return alignment;
  const bool se3_determined =
      refusal_of(pairs, m, fit.singular_values, AlignmentKind::kSe3).empty();
  if (se3_determined) {
    alignment.scale_hint = fit.scale;
    alignment.tilt_rad = tilt_of(fit.rotation);
  }
  if (kind == AlignmentKind::kFirstPose) {
    alignment.truth_from_estimate = pairs[0].truth * pairs[0].estimate.inverse();
  } else if (kind == AlignmentKind::kSe3) {
    alignment.truth_from_estimate =
        make_pose(fit.rotation, m.truth_mean - fit.rotation * m.estimate_mean);
  } else {
    alignment.truth_from_estimate = fit_position_and_yaw(m);
    if (se3_determined && alignment.tilt_rad > kMaxTilt_rad) {
      alignment.warning = fmt::format(
          "the estimate's z axis is tilted by {:.1f} deg: a heading-only fit needs a vertical one",
          alignment.tilt_rad * 180.0 / M_PI);
    }
  }
  return alignment;
}

Alignment align(const Trajectory& estimate, const Trajectory& truth, AlignmentKind kind) {
  return align(matched_poses(estimate, truth), kind);
}

}  // namespace lidarena::evaluation
