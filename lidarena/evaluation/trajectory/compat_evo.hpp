// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/evaluation/trajectory/alignment.hpp"
#include "lidarena/evaluation/trajectory/association.hpp"

/// Reproduces the numbers of another tool, evo (v1.36.5), for the same options, so that published
/// results can be checked. Its definitions differ from ours (see docs/metrics.md). Written from a
/// description of its behavior.
namespace lidarena::evaluation {

enum class EvoMetric {
  kApe,  ///< absolute pose error
  kRpe,  ///< relative pose error
};

/// Which part of the error transform E between two poses (APE) or two motions (RPE) is measured.
enum class EvoRelation {
  kTranslation,         ///< |t(E)|, m
  kRotation,            ///< Frobenius norm of R(E) - I, no unit
  kFull,                ///< Frobenius norm of E - I: meters and rotation mixed
  kAngleDegrees,        ///< angle of R(E), deg
  kAngleRadians,        ///< angle of R(E), rad
  kPointDistance,       ///< APE: |t(E)|; RPE: difference of the translations' lengths, m
  kPointDistanceRatio,  ///< RPE only: that in percent of the reference's translation
};

/// Unit of `delta`, the length of a piece (RPE).
enum class EvoUnit { kFrames, kMeters, kDegrees, kRadians };

constexpr auto enum_names(EvoMetric) {
  return std::array{std::pair{"ape", EvoMetric::kApe}, std::pair{"rpe", EvoMetric::kRpe}};
}
constexpr auto enum_names(EvoRelation) {
  return std::array{std::pair{"trans_part", EvoRelation::kTranslation},
                    std::pair{"rot_part", EvoRelation::kRotation},
                    std::pair{"full", EvoRelation::kFull},
                    std::pair{"angle_deg", EvoRelation::kAngleDegrees},
                    std::pair{"angle_rad", EvoRelation::kAngleRadians},
                    std::pair{"point_distance", EvoRelation::kPointDistance},
                    std::pair{"point_distance_error_ratio", EvoRelation::kPointDistanceRatio}};
}
constexpr auto enum_names(EvoUnit) {
  return std::array{std::pair{"f", EvoUnit::kFrames}, std::pair{"m", EvoUnit::kMeters},
                    std::pair{"d", EvoUnit::kDegrees}, std::pair{"r", EvoUnit::kRadians}};
}

struct EvoOptions {
  EvoMetric metric = EvoMetric::kApe;
  EvoRelation relation = EvoRelation::kTranslation;
  // association
  double max_difference_s = 0.01;  ///< maximum difference of stamps that are paired
  double offset_s = 0.0;           ///< added to the estimate's stamps
  // alignment; if none of these is set, the trajectories are compared as they are
  bool align = false;          ///< fit rotation and translation (Umeyama)
  bool scale = false;          ///< fit the scale (Umeyama); with `align` a similarity
  bool align_origin = false;   ///< make the first poses coincide
  std::size_t n_to_align = 0;  ///< fit only the first n pairs; 0 = all
  // pieces of the RPE
  double delta = 1.0;
  EvoUnit unit = EvoUnit::kFrames;
  double delta_tolerance = 0.1;       ///< relative to `delta`; for all_pairs in meters or angles
  bool all_pairs = false;             ///< a piece starts at every pose, else consecutive pieces
  bool pairs_from_reference = false;  ///< measure pieces on the reference, else on the estimate
};

/// evo's statistics; `std` divides by n, not by n - 1.
struct EvoStatistics {
  double rmse = 0.0, mean = 0.0, median = 0.0, std = 0.0, min = 0.0, max = 0.0, sse = 0.0;
};

struct EvoResult {
  std::size_t matched = 0;  ///< pairs of poses
  Similarity reference_from_estimate;
  EvoStatistics statistics;
  std::vector<double> errors;
};

/// Scores `estimate` as evo does. Rows are in the order of time and may repeat times, which evo
/// keeps. Throws InputError where evo refuses: no common stamps, positions
/// to be aligned (the first `n_to_align`) that lie on a line or a point, no pieces, a delta that is
/// not positive, not a whole number of frames, or above 180 degrees, options that exclude each
/// other.
EvoResult compat_evo(std::span<const StampedPose> reference, std::span<const StampedPose> estimate,
                     const EvoOptions& options);

/// Unit of the errors: "m", "deg", "rad", "%", or "" for the Frobenius norms.
const char* unit_of(EvoRelation relation);

/// Pairs of indices (reference, estimate). Each stamp of the trajectory with fewer poses is paired
/// with the nearest stamp of the other one, if they differ by at most `max_difference_s`; a pose of
/// the longer trajectory may be paired twice.
std::vector<std::pair<std::size_t, std::size_t>> evo_association(
    std::span<const StampedPose> reference, std::span<const StampedPose> estimate,
    double max_difference_s, double offset_s);

/// Pieces of the length given by the options' delta, as pairs of pose indices (begin, end).
std::vector<std::pair<std::size_t, std::size_t>> evo_pieces(std::span<const Pose> poses,
                                                            const EvoOptions& options);

}  // namespace lidarena::evaluation
