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
#include "lidarena/evaluation/alignment.hpp"
#include "lidarena/evaluation/association.hpp"

/// The figures of another tool, evo (v1.36.5), for the same options, so that published numbers can
/// be checked. Its definitions differ from ours (docs/metrics.md says how); written from a
/// description of what it does.
namespace lidarena {

enum class EvoMetric {
  kApe,  ///< absolute pose error
  kRpe,  ///< relative pose error
};

/// What is measured of the error E of two poses (APE) or of two motions (RPE).
enum class EvoRelation {
  kTranslation,         ///< |t(E)|, m
  kRotation,            ///< Frobenius norm of R(E) - I, no unit
  kFull,                ///< Frobenius norm of E - I: meters and rotation mixed
  kAngleDegrees,        ///< angle of R(E), deg
  kAngleRadians,        ///< angle of R(E), rad
  kPointDistance,       ///< APE: |t(E)|; RPE: difference of the chords' lengths, m
  kPointDistanceRatio,  ///< RPE alone: that in percent of the reference's chord
};

/// In which unit `delta` gives the length of a piece (RPE).
enum class EvoUnit { kFrames, kMeters, kDegrees, kRadians };

template <>
struct EnumNames<EvoMetric> {
  static constexpr std::array names{std::pair{"ape", EvoMetric::kApe},
                                    std::pair{"rpe", EvoMetric::kRpe}};
};
template <>
struct EnumNames<EvoRelation> {
  static constexpr std::array names{
      std::pair{"trans_part", EvoRelation::kTranslation},
      std::pair{"rot_part", EvoRelation::kRotation},
      std::pair{"full", EvoRelation::kFull},
      std::pair{"angle_deg", EvoRelation::kAngleDegrees},
      std::pair{"angle_rad", EvoRelation::kAngleRadians},
      std::pair{"point_distance", EvoRelation::kPointDistance},
      std::pair{"point_distance_error_ratio", EvoRelation::kPointDistanceRatio}};
};
template <>
struct EnumNames<EvoUnit> {
  static constexpr std::array names{
      std::pair{"f", EvoUnit::kFrames}, std::pair{"m", EvoUnit::kMeters},
      std::pair{"d", EvoUnit::kDegrees}, std::pair{"r", EvoUnit::kRadians}};
};

struct EvoOptions {
  EvoMetric metric = EvoMetric::kApe;
  EvoRelation relation = EvoRelation::kTranslation;
  // association
  double max_difference_s = 0.01;  ///< between stamps that are taken for one instant
  double offset_s = 0.0;           ///< added to the estimate's stamps
  // alignment; none of them: the trajectories are compared as they are
  bool align = false;          ///< rotation and translation by Umeyama
  bool scale = false;          ///< scale by Umeyama; with `align` a similarity
  bool align_origin = false;   ///< first poses on each other
  std::size_t n_to_align = 0;  ///< fit the first n pairs alone; 0 = all
  // pieces of the RPE
  double delta = 1.0;
  EvoUnit unit = EvoUnit::kFrames;
  double delta_tolerance = 0.1;       ///< of `delta`, for all pairs by meters and angles
  bool all_pairs = false;             ///< a piece from every pose, else one after the other
  bool pairs_from_reference = false;  ///< path and angle of the reference, else of the estimate
};

/// evo's statistics; the deviation divides by n.
struct EvoStatistics {
  double rmse = 0.0, mean = 0.0, median = 0.0, std = 0.0, min = 0.0, max = 0.0, sse = 0.0;
};

struct EvoResult {
  std::size_t matched = 0;  ///< pairs of poses
  Similarity reference_from_estimate;
  EvoStatistics statistics;
  std::vector<double> errors;
};

/// Scores `estimate` as evo does. Throws InputError where it refuses: no stamps in common, an
/// alignment without two directions (of `n_to_align` poses), no pieces, a delta that is not
/// positive, no whole number of frames, or above 180 degrees, options that exclude each other.
EvoResult compat_evo(const Trajectory& reference, const Trajectory& estimate,
                     const EvoOptions& options);

/// "m", "deg", "rad", "%", or "" for the Frobenius norms.
const char* unit_of(EvoRelation relation);

/// Pairs of indices (reference, estimate): to each stamp of the shorter trajectory the nearest of
/// the longer, if not farther than `max_difference_s`; a pose of the longer one may serve twice.
std::vector<std::pair<std::size_t, std::size_t>> evo_association(const Trajectory& reference,
                                                                 const Trajectory& estimate,
                                                                 double max_difference_s,
                                                                 double offset_s);

/// Pieces (begin, end) of `poses` by the options' delta.
std::vector<std::pair<std::size_t, std::size_t>> evo_pieces(std::span<const Pose> poses,
                                                            const EvoOptions& options);

}  // namespace lidarena
