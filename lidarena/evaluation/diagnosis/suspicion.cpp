// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/diagnosis/suspicion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lidarena/base/so3.hpp"
#include "lidarena/evaluation/trajectory/association.hpp"
#include "lidarena/evaluation/trajectory/motion_pairs.hpp"

namespace lidarena::evaluation {
namespace {

constexpr double kSameLength = 1.5;  // the durations may differ by up to this factor
constexpr double kMinMisfit_rad = 0.035;

struct Unit {
  double per_second;
  const char* name;
};
constexpr std::array kUnits{Unit{1e3, "milliseconds"}, Unit{1e6, "microseconds"},
                            Unit{1e9, "nanoseconds"}};

double duration_s(const Trajectory& trajectory) {
  return to_seconds(trajectory.end_time() - trajectory.begin_time());
}

/// The unit in which `longer` seems to be given, if it is that many times `shorter`.
const Unit* unit_of(double longer, double shorter) {
  for (const Unit& unit : kUnits) {
    const double ratio = longer / (shorter * unit.per_second);
    if (ratio < kSameLength && ratio > 1.0 / kSameLength) return &unit;
  }
  return nullptr;
}

/// Corrects quaternions that were read as x y z w from columns w x y z.
Trajectory reordered(const Trajectory& trajectory) {
  std::vector<StampedPose> poses;
  poses.reserve(trajectory.size());
  for (const StampedPose& pose : trajectory.poses()) {
    const Eigen::Quaterniond q(pose.world_from_body.linear());
    const Eigen::Quaterniond right(q.x(), q.y(), q.z(), q.w());
    poses.push_back({pose.stamp, make_pose(right, pose.world_from_body.translation())});
  }
  return Trajectory(std::move(poses));
}

/// RMS of the angle between the rotations of both motions, the estimate's mapped by
/// `body_from_estimate`.
double misfit(const std::vector<MotionPair>& motions, const Eigen::Matrix3d& body_from_estimate) {
  double sum = 0.0;
  for (const MotionPair& motion : motions) {
    const Eigen::Matrix3d rotation =
        body_from_estimate * motion.estimate.linear() * body_from_estimate.transpose();
    sum += std::pow(so3::angle(motion.truth.linear().transpose() * rotation), 2);
  }
  return motions.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(motions.size()));
}

double misfit(const Trajectory& estimate, const Trajectory& truth) {
  return misfit(motion_pairs(estimate, truth), Eigen::Matrix3d::Identity());
}

/// Misfit of the files as read: the smaller of that without and that with a constant mounting
/// rotation.
double misfit_as_read(const Trajectory& estimate, const Trajectory& truth) {
  const std::vector<MotionPair> motions = motion_pairs(estimate, truth);
  return std::min(misfit(motions, Eigen::Matrix3d::Identity()),
                  misfit(motions, mounting_of(motions)));
}

}  // namespace

std::string suspect_times(const Trajectory& estimate, const Trajectory& truth) {
  if (estimate.size() < 2 || truth.size() < 2) return {};
  const double estimate_s = duration_s(estimate);
  const double truth_s = duration_s(truth);
  if (const Unit* unit = unit_of(estimate_s, truth_s)) {
    return fmt::format(
        "the estimate lasts {:.4g} s, the truth {:.4g} s: the estimate's times look like {}",
        estimate_s, truth_s, unit->name);
  }
  if (const Unit* unit = unit_of(truth_s, estimate_s)) {
    return fmt::format(
        "the truth lasts {:.4g} s, the estimate {:.4g} s: the truth's times look like {}", truth_s,
        estimate_s, unit->name);
  }
  const bool meet =
      estimate.begin_time() <= truth.end_time() && truth.begin_time() <= estimate.end_time();
  if (meet) return {};
  return fmt::format(
      "the estimate begins {:.9g} s {} the truth: their clocks count from different instants",
      std::abs(to_seconds(estimate.begin_time() - truth.begin_time())),
      estimate.begin_time() > truth.begin_time() ? "after" : "before");
}

std::string suspect_length_unit(const Trajectory& estimate, const Trajectory& truth) {
  struct LengthUnit {
    double per_meter;
    const char* name;
  };
  constexpr std::array kLengthUnits{LengthUnit{1e3, "millimeters"}, LengthUnit{1e2, "centimeters"},
                                    LengthUnit{3.28084, "feet"}, LengthUnit{1e-3, "kilometers"}};
  constexpr double kSame = 1.1;  // an estimate that is scored at all has this accuracy
  double estimated = 0.0, real = 0.0;
  const std::vector<PosePair> pairs = matched_poses(estimate, truth);
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    const auto moved = [&](Pose PosePair::*which) {
      return ((pairs[i].*which).translation() - (pairs[i - 1].*which).translation()).norm();
    };
    estimated += moved(&PosePair::estimate);
    real += moved(&PosePair::truth);
  }
  if (estimated <= 0.0 || real <= 0.0) return {};
  for (const LengthUnit& unit : kLengthUnits) {
    for (const bool in_estimate : {true, false}) {
      const double ratio = (in_estimate ? estimated / real : real / estimated) / unit.per_meter;
      if (ratio > kSame || ratio < 1.0 / kSame) continue;
      return fmt::format(
          "the path is {:.4g} m long in the estimate and {:.4g} m in the truth: the "
          "{}'s positions look like {}",
          estimated, real, in_estimate ? "estimate" : "truth", unit.name);
    }
  }
  return {};
}

std::string suspect_constant_rotation(const Trajectory& estimate, const Trajectory& truth) {
  constexpr double kTurn = 0.17;  // rad
  constexpr double kSame = 1e-6;  // rad, rounding
  const auto turn_of = [](const Trajectory& trajectory) {
    double most = 0.0;
    for (const StampedPose& pose : trajectory.poses()) {
      const auto& first = trajectory.poses().front().world_from_body;
      most = std::max(most, so3::angle(first.linear().transpose() * pose.world_from_body.linear()));
    }
    return most;
  };
  const double estimated = turn_of(estimate), real = turn_of(truth);
  const bool in_estimate = estimated < kSame && real > kTurn;
  const bool in_truth = real < kSame && estimated > kTurn;
  if (!in_estimate && !in_truth) return {};
  return fmt::format(
      "the {}'s rotations are all the same: it holds positions only, figures that need rotations "
      "(all "
      "but the ATE's translation) mean nothing",
      in_estimate ? "estimate" : "truth");
}

std::string suspect_quaternion_order(const Trajectory& estimate, const Trajectory& truth) {
  const double as_read = misfit_as_read(estimate, truth);
  if (as_read < kMinMisfit_rad) return {};
  const auto suspect = [&](double in_the_other_order, const char* whose) -> std::string {
    if (in_the_other_order > 0.5 * as_read) return {};
    return fmt::format("the {}'s quaternions look like w x y z but were read as x y z w", whose);
  };
  const std::string first = suspect(misfit(reordered(estimate), truth), "estimate");
  return first.empty() ? suspect(misfit(estimate, reordered(truth)), "truth") : first;
}

}  // namespace lidarena::evaluation
