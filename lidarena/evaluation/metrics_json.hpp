// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/evaluation/diagnosis/lever_arm.hpp"
#include "lidarena/evaluation/diagnosis/time_offset.hpp"
#include "lidarena/evaluation/map/map_error.hpp"
#include "lidarena/evaluation/trajectory/hover_jitter.hpp"
#include "lidarena/evaluation/trajectory/kitti_error.hpp"
#include "lidarena/evaluation/trajectory/trajectory_error.hpp"

/// Metrics as JSON. Names contain the units; a number that does not exist is null, never zero or
/// NaN; each metric has the id of its definition in docs/metrics.md.
namespace lidarena::evaluation {

/// E.g. "rpe_1m[ref-arc,1m,disjoint,interp,gap1.5]".
std::string definition_id(const RelativePoseError& rpe);
/// E.g. "ate_se3[est-stamps,ref-interp,gap1.5]".
std::string definition_id(const AbsoluteTrajectoryError& ate);
/// "kitti[est-poses,ref-arc,every10,first-beyond,100-800m]".
std::string definition_id(const KittiError& error);
/// "map_error[point-triangle,all-points,20cm]".
std::string definition_id(const MapError& error);

/// {count, rmse_UNIT, mean_UNIT, median_UNIT, p95_UNIT, p99_UNIT, max_UNIT}; null when empty.
Json to_json(const Summary& summary, const std::string& unit);
Json to_json(const Association& association, const std::optional<TimeOffset>& offset);
/// Components with a sigma of 10 cm or 0.1 rad or more are null.
Json to_json(const std::optional<LeverArm>& arm);
Json to_json(const RelativePoseError& rpe);
Json to_json(const AbsoluteTrajectoryError& ate);
/// Means are null for lengths without a piece; "refused" when no length has one.
Json to_json(const KittiError& error);
Json to_json(const MapError& error);
/// Null without a hover.
Json to_json(const HoverJitter& jitter);

/// Columns t_s (since `start`), translation_m, rotation_rad; at most `limit` rows, each the largest
/// error of several consecutive ones, so that no peak is lost. Rounded to 1e-6.
Json errors_over_time(std::span<const SegmentError> segments, Time start, std::size_t limit = 2000);
Json errors_over_time(std::span<const PoseError> poses, Time start, std::size_t limit = 2000);

}  // namespace lidarena::evaluation
