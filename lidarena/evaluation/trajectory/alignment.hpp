// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/evaluation/trajectory/association.hpp"

namespace lidarena::evaluation {

/// How the estimate's world frame is aligned with the truth's.
enum class AlignmentKind {
  kFirstPose,  ///< the first common pose; nothing is fitted
  kSe3,        ///< least squares over all positions, 6 unknowns (Umeyama, no scale)
  kPosYaw,     ///< position and heading only, 4 unknowns; needs an estimate with z straight up
};
/// "first_pose", "se3", "posyaw".
const char* to_string(AlignmentKind kind);

/// Least-squares similarity q ~ scale * rotation * p + translation from estimate p to truth q.
struct Similarity {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double scale = 1.0;
  /// Singular values of the positions' cross covariance, m^2, in descending order.
  Eigen::Vector3d singular_values = Eigen::Vector3d::Zero();
};

/// Umeyama, "Least-squares estimation of transformation parameters between two point patterns"
/// (PAMI 1991), eq. 34-43: from estimate to truth, with or without scale.
Similarity umeyama(std::span<const PosePair> pairs, bool with_scale);

/// The transform truth_from_estimate, or the reason why it is not determined.
struct Alignment {
  AlignmentKind kind = AlignmentKind::kSe3;
  Pose truth_from_estimate = Pose::Identity();
  std::string refusal;      ///< empty when the transform is determined
  std::string warning;      ///< e.g. heading-only fit of an estimate whose z axis is tilted
  double scale_hint = 1.0;  ///< scale that a similarity fit would find; never applied
  double tilt_rad = 0.0;    ///< angle by which the SE(3) fit tilts the estimate's z axis
  bool determined() const { return refusal.empty(); }
};

/// Refuses a fit with fewer than 3 poses, with positions that spread less than 1 cm (kPosYaw:
/// horizontally), and (kSe3) with positions on a line, because the roll about that line is
/// arbitrary. kFirstPose is refused only without a common pose.
Alignment align(std::span<const PosePair> pairs, AlignmentKind kind);
Alignment align(const Trajectory& estimate, const Trajectory& truth, AlignmentKind kind);

}  // namespace lidarena::evaluation
