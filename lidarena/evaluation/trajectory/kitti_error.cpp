// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/trajectory/kitti_error.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lidarena/base/so3.hpp"
#include "lidarena/evaluation/trajectory/arc_length.hpp"
#include "lidarena/evaluation/trajectory/association.hpp"

namespace lidarena::evaluation {
namespace {

constexpr std::size_t kStartEvery = 10;  // frames: one second of KITTI

/// Path length of the truth at each pair, m.
std::vector<double> paths_of(const std::vector<PosePair>& pairs, const Trajectory& truth) {
  std::vector<double> s;
  if (pairs.empty()) return s;
  const ArcLength arc(truth, {truth.begin_time(), truth.end_time()});
  s.reserve(pairs.size());
  for (const PosePair& pair : pairs) s.push_back(arc.at(pair.stamp));
  return s;
}

KittiLength score(const std::vector<PosePair>& pairs, const std::vector<double>& s,
                  double length_m) {
  KittiLength score;
  score.length_m = length_m;
  for (std::size_t i = 0; i < s.size(); i += kStartEvery) {
    const auto beyond = std::upper_bound(s.begin(), s.end(), s[i] + length_m);
    if (beyond == s.end()) break;
    const auto j = static_cast<std::size_t>(beyond - s.begin());
    const Pose q = pairs[i].truth.inverse() * pairs[j].truth;
    const Pose p = pairs[i].estimate.inverse() * pairs[j].estimate;
    const Pose error = p.inverse() * q;
    score.translation_percent += 100.0 * error.translation().norm() / length_m;
    score.rotation_rad_per_m += so3::angle(error.linear()) / length_m;
    ++score.pieces;
  }
  return score;
}

}  // namespace

KittiError kitti_error(const Trajectory& estimate, const Trajectory& truth,
                       std::span<const double> lengths_m) {
  const std::vector<PosePair> pairs = matched_poses(estimate, truth);
  const std::vector<double> s = paths_of(pairs, truth);
  KittiError error;
  for (const double length_m : lengths_m) {
    KittiLength sums = score(pairs, s, length_m);
    error.pieces += sums.pieces;
    error.translation_percent += sums.translation_percent;
    error.rotation_rad_per_m += sums.rotation_rad_per_m;
    const double n = std::max<double>(1.0, static_cast<double>(sums.pieces));
    sums.translation_percent /= n;
    sums.rotation_rad_per_m /= n;
    error.lengths.push_back(sums);
  }
  if (error.pieces == 0) {
    const double flown = s.empty() ? 0.0 : s.back() - s.front();
    const double shortest =
        lengths_m.empty() ? 0.0 : *std::min_element(lengths_m.begin(), lengths_m.end());
    error.refusal =
        fmt::format("the common path is {:.3g} m, no piece of {:g} m fits", flown, shortest);
    return error;
  }
  error.translation_percent /= static_cast<double>(error.pieces);
  error.rotation_rad_per_m /= static_cast<double>(error.pieces);
  return error;
}

}  // namespace lidarena::evaluation
