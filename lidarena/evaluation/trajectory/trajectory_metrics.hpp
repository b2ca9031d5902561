// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>

#include "lidarena/evaluation/diagnosis/lever_arm.hpp"
#include "lidarena/evaluation/diagnosis/time_offset.hpp"
#include "lidarena/evaluation/trajectory/association.hpp"
#include "lidarena/evaluation/trajectory/trajectory_error.hpp"
#include "lidarena/results/trajectory_metrics.hpp"

/// What of a trajectory's errors goes into the results.
namespace lidarena::evaluation {

/// E.g. "rpe_1m[ref-arc,1m,disjoint,interp,gap1.5]".
std::string definition_id(const RelativePoseError& rpe);
/// E.g. "ate_se3[est-stamps,ref-interp,gap1.5]".
std::string definition_id(const AbsoluteTrajectoryError& ate);

results::AssociationMetrics metrics_of(const Association& association,
                                       const std::optional<TimeOffset>& offset,
                                       const std::optional<LeverArm>& arm);
/// With its floor if the error `of_perfect`, an estimate without error at the same instants, is
/// given and has pieces.
results::RpeMetrics metrics_of(const RelativePoseError& rpe,
                               const RelativePoseError* of_perfect = nullptr);
results::RpeAtOffset metrics_of(const RpeAtBestOffset& best);
/// With the definition of errors against the truth by the LiDAR's clock.
results::RpeMetrics metrics_at_clock(const RelativePoseError& rpe);
results::AteMetrics metrics_of(const AbsoluteTrajectoryError& ate);

/// At most `limit` rows with times since `start`, each the largest error of several consecutive
/// ones, so that no peak is lost. Rounded to 1e-6.
results::ErrorsOverTime errors_over_time(std::span<const SegmentError> segments, Time start,
                                         std::size_t limit = 2000);
results::ErrorsOverTime errors_over_time(std::span<const PoseError> poses, Time start,
                                         std::size_t limit = 2000);

}  // namespace lidarena::evaluation
