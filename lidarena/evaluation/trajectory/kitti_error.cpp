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

/// Sums of the errors of all pieces of one length.
struct Sums {
  std::size_t pieces = 0;
  double translation_percent = 0.0;
  double rotation_rad_per_m = 0.0;
};

Sums sums_of(const std::vector<PosePair>& pairs, const std::vector<double>& s, double length_m) {
  Sums sums;
  for (std::size_t i = 0; i < s.size(); i += kStartEvery) {
    const auto beyond = std::upper_bound(s.begin(), s.end(), s[i] + length_m);
    if (beyond == s.end()) break;
    const auto j = static_cast<std::size_t>(beyond - s.begin());
    const Pose q = pairs[i].truth.inverse() * pairs[j].truth;
    const Pose p = pairs[i].estimate.inverse() * pairs[j].estimate;
    const Pose error = p.inverse() * q;
    sums.translation_percent += 100.0 * error.translation().norm() / length_m;
    sums.rotation_rad_per_m += so3::angle(error.linear()) / length_m;
    ++sums.pieces;
  }
  return sums;
}

/// Sets the means of `out`, which stay empty without a piece.
template <class Means>
void set_means(const Sums& sums, Means& out) {
  out.pieces = sums.pieces;
  if (sums.pieces == 0) return;
  out.translation_percent = sums.translation_percent / static_cast<double>(sums.pieces);
  out.rotation_rad_per_m = sums.rotation_rad_per_m / static_cast<double>(sums.pieces);
}

/// E.g. "kitti[est-poses,ref-arc,every10,first-beyond,100-800m]".
std::string definition_of(std::span<const double> lengths_m) {
  if (lengths_m.empty()) return "kitti[est-poses,ref-arc,every10,first-beyond]";
  return fmt::format("kitti[est-poses,ref-arc,every10,first-beyond,{:g}-{:g}m]", lengths_m.front(),
                     lengths_m.back());
}

}  // namespace

KittiError kitti_error(const Trajectory& estimate, const Trajectory& truth,
                       std::span<const double> lengths_m) {
  const std::vector<PosePair> pairs = matched_poses(estimate, truth);
  const std::vector<double> s = paths_of(pairs, truth);
  KittiError error;
  error.definition = definition_of(lengths_m);
  Sums all;
  for (const double length_m : lengths_m) {
    const Sums sums = sums_of(pairs, s, length_m);
    all.pieces += sums.pieces;
    all.translation_percent += sums.translation_percent;
    all.rotation_rad_per_m += sums.rotation_rad_per_m;
    set_means(sums, error.lengths.emplace_back(results::KittiLength{length_m, 0, {}, {}}));
  }
  set_means(all, error);
  if (error.pieces == 0) {
    const double flown = s.empty() ? 0.0 : s.back() - s.front();
    const double shortest =
        lengths_m.empty() ? 0.0 : *std::min_element(lengths_m.begin(), lengths_m.end());
    error.refused =
        fmt::format("the common path is {:.3g} m, no piece of {:g} m fits", flown, shortest);
    error.lengths.clear();
  }
  return error;
}

}  // namespace lidarena::evaluation
