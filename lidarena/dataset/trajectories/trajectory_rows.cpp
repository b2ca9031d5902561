// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/trajectories/trajectory_rows.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <cmath>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::dataset {
namespace {

/// Maximum deviation of a quaternion's norm from 1, and of R R' from the identity, that is accepted
/// as rounding in files.
constexpr double kRotationTolerance = 1e-3;

}  // namespace

void TrajectoryRows::add(Time stamp, const Pose& pose, const std::string& place) {
  if (!poses_.empty() && stamp <= poses_.back().stamp) {
    const bool same = stamp == poses_.back().stamp;
    if (same && repeated_ != nullptr) return repeated_->push_back({stamp, pose});
    throw InputError(place,
                     fmt::format("the time {} {} the previous row ({})", format_seconds(stamp),
                                 same ? "repeats that of" : "is earlier than that of",
                                 format_seconds(poses_.back().stamp)),
                     "sort the rows by time and remove duplicates; where times are seconds and "
                     "nanoseconds, write the latter with nine digits (5.005000000, not 5.5000000)");
  }
  poses_.push_back({stamp, pose});
}

Trajectory TrajectoryRows::finish(const std::string& file) {
  if (poses_.empty()) {
    throw InputError(file, "holds no pose", "check that the program that wrote it finished");
  }
  return Trajectory(std::move(poses_), file);
}

Pose pose_from_row(const Eigen::Vector3d& position, const Eigen::Quaterniond& rotation,
                   const std::string& place) {
  const double norm = rotation.norm();
  if (!(std::abs(norm - 1.0) <= kRotationTolerance)) {
    throw InputError(place, fmt::format("the quaternion's norm is {:.6g}, not 1", norm),
                     "check the order of the columns and that every row has a rotation");
  }
  return make_pose(rotation, position);
}

Pose pose_from_row(const Eigen::Matrix<double, 3, 4>& matrix, const std::string& place) {
  const Eigen::Matrix3d r = matrix.leftCols<3>();
  const double off = (r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kRotationTolerance) || r.determinant() < 0.0) {
    throw InputError(place,
                     fmt::format("the 3x3 part is not a rotation (R R' - I reaches {:.2g}, "
                                 "determinant {:.3g})",
                                 off, r.determinant()),
                     "rows are r11 r12 r13 tx r21 r22 r23 ty r31 r32 r33 tz");
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(r, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
  return make_pose(nearest, matrix.col(3));
}

}  // namespace lidarena::dataset
