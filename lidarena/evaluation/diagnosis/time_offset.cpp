// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/diagnosis/time_offset.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "lidarena/evaluation/trajectory/association.hpp"

namespace lidarena::evaluation {
namespace {

constexpr double kStep_s = 0.01;      // of the search; a parabola interpolates the minimum
constexpr double kMaxSigma_s = 0.02;  // less certain offsets are not reported
constexpr Time kPiece = std::chrono::seconds(1);
constexpr std::size_t kMaxPieces = 1000;

/// Motion of the estimate between two of its own poses (so that only the truth is interpolated).
struct Piece {
  Time begin{0};
  Time end{0};
  Pose motion = Pose::Identity();
};

std::vector<Piece> pieces_of(const Trajectory& estimate) {
  const auto poses = estimate.poses();
  const std::size_t stride = poses.size() / kMaxPieces + 1;
  const Time longest = kPiece + gap_limit_of(estimate);
  std::vector<Piece> pieces;
  for (std::size_t i = 0, j = 0; i < poses.size(); i += stride) {
    while (j < poses.size() && poses[j].stamp < poses[i].stamp + kPiece) ++j;
    if (j == poses.size()) break;
    if (poses[j].stamp - poses[i].stamp > longest) continue;
    pieces.push_back({poses[i].stamp, poses[j].stamp,
                      poses[i].world_from_body.inverse() * poses[j].world_from_body});
  }
  return pieces;
}

/// Mean square of the relative translation error with the estimate's stamps `shift` earlier; empty
/// when less than half of the pieces have a truth.
std::optional<double> misfit(const std::vector<Piece>& pieces, const Trajectory& truth,
                             Time gap_limit, Time shift) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const Piece& piece : pieces) {
    const std::optional<Pose> a = pose_between(truth, piece.begin - shift, gap_limit);
    const std::optional<Pose> b = pose_between(truth, piece.end - shift, gap_limit);
    if (!a || !b) continue;
    const Eigen::Vector3d moved = a->linear().transpose() * (b->translation() - a->translation());
    sum += (piece.motion.translation() - moved).squaredNorm();
    ++count;
  }
  if (count == 0 || 2 * count < pieces.size()) return std::nullopt;
  return sum / static_cast<double>(count);
}

/// Vertex of the parabola through the misfits at three neighboring offsets.
std::optional<TimeOffset> vertex(double before, double minimum, double after, double shift_s,
                                 double independent_pieces) {
  const double curvature = (before - 2.0 * minimum + after) / (kStep_s * kStep_s);
  if (!(curvature > 0.0)) return std::nullopt;
  const double slope = (after - before) / (2.0 * kStep_s);
  const double rest = std::max(0.0, minimum - 0.5 * slope * slope / curvature);
  // sum of squares n J(d) ~ n (rest + curvature d^2 / 2): variance of its minimum in d
  const double sigma = std::sqrt(2.0 * rest / (curvature * independent_pieces));
  if (sigma > kMaxSigma_s) return std::nullopt;
  return TimeOffset{shift_s - slope / curvature, sigma};
}

}  // namespace

std::optional<TimeOffset> time_offset(const Trajectory& estimate, const Trajectory& truth,
                                      double range_s) {
  const std::vector<Piece> pieces = pieces_of(estimate);
  if (pieces.empty()) return std::nullopt;
  const Time gap_limit = gap_limit_of(truth);
  const auto steps = static_cast<int>(std::ceil(range_s / kStep_s));
  std::vector<double> misfits;
  for (int k = -steps; k <= steps; ++k) {
    const std::optional<double> value = misfit(pieces, truth, gap_limit, from_seconds(k * kStep_s));
    misfits.push_back(value.value_or(std::numeric_limits<double>::infinity()));
  }
  const auto minimum = std::min_element(misfits.begin(), misfits.end());
  if (minimum == misfits.begin() || minimum + 1 == misfits.end()) return std::nullopt;
  const double shift_s = (static_cast<double>(minimum - misfits.begin()) - steps) * kStep_s;
  const double seconds = to_seconds(pieces.back().end - pieces.front().begin);
  return vertex(*(minimum - 1), *minimum, *(minimum + 1), shift_s, std::max(1.0, seconds));
}

}  // namespace lidarena::evaluation
