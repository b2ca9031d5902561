// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/trajectory/motion_pairs.hpp"

#include <Eigen/SVD>

#include "lidarena/base/so3.hpp"
#include "lidarena/evaluation/trajectory/association.hpp"

namespace lidarena::evaluation {
namespace {

constexpr Time kPiece = std::chrono::seconds(1);
constexpr std::size_t kMaxPairs = 1000;

}  // namespace

std::vector<MotionPair> motion_pairs(const Trajectory& estimate, const Trajectory& truth) {
  const auto poses = estimate.poses();
  const std::size_t stride = poses.size() / kMaxPairs + 1;
  const Time longest = kPiece + gap_limit_of(estimate);
  const Time gap_limit = gap_limit_of(truth);
  std::vector<MotionPair> pairs;
  for (std::size_t i = 0, j = 0; i < poses.size(); i += stride) {
    while (j < poses.size() && poses[j].stamp < poses[i].stamp + kPiece) ++j;
    if (j == poses.size()) break;
    if (poses[j].stamp - poses[i].stamp > longest) continue;
    const std::optional<Pose> a = pose_between(truth, poses[i].stamp, gap_limit);
    const std::optional<Pose> b = pose_between(truth, poses[j].stamp, gap_limit);
    if (!a || !b) continue;
    pairs.push_back(
        {a->inverse() * *b, poses[i].world_from_body.inverse() * poses[j].world_from_body});
  }
  return pairs;
}

Eigen::Matrix3d mounting_of(std::span<const MotionPair> motions) {
  constexpr double kTwoAxes = 1e-4;  // ratio of the second to the first singular value
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  for (const MotionPair& motion : motions) {
    cross += so3::log(motion.truth.linear()) * so3::log(motion.estimate.linear()).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (svd.singularValues()[1] <= kTwoAxes * svd.singularValues()[0]) {
    return Eigen::Matrix3d::Identity();
  }
  Eigen::Vector3d s = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) s.z() = -1.0;
  return svd.matrixU() * s.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace lidarena::evaluation
