// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/trajectory/hover_jitter.hpp"

#include <cmath>

namespace lidarena::evaluation {
namespace {

bool hovers(const PosePair& a, const PosePair& b, Time gap_limit) {
  if (b.stamp - a.stamp > gap_limit) return false;
  const double meters = (b.truth.translation() - a.truth.translation()).norm();
  return meters < HoverJitter::kSpeed_mps * to_seconds(b.stamp - a.stamp);
}

/// Sum of the squared position errors about their mean.
double sum_of_squares(std::span<const PosePair> hover) {
  const Eigen::Matrix3d truth_from_estimate =
      hover.front().truth.linear() * hover.front().estimate.linear().transpose();
  const auto error = [&](const PosePair& pair) -> Eigen::Vector3d {
    return truth_from_estimate * pair.estimate.translation() - pair.truth.translation();
  };
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const PosePair& pair : hover) mean += error(pair) / static_cast<double>(hover.size());
  double sum = 0.0;
  for (const PosePair& pair : hover) sum += (error(pair) - mean).squaredNorm();
  return sum;
}

}  // namespace

HoverJitter hover_jitter(std::span<const PosePair> pairs, Time gap_limit) {
  HoverJitter jitter;
  double squares = 0.0;
  for (std::size_t begin = 0, end = 0; begin < pairs.size(); begin = end) {
    end = begin + 1;
    while (end < pairs.size() && hovers(pairs[end - 1], pairs[end], gap_limit)) ++end;
    const double seconds = to_seconds(pairs[end - 1].stamp - pairs[begin].stamp);
    if (seconds < HoverJitter::kMin_s) continue;
    squares += sum_of_squares(pairs.subspan(begin, end - begin));
    jitter.poses += end - begin;
    jitter.seconds += seconds;
  }
  if (jitter.poses > 0) jitter.rms_m = std::sqrt(squares / static_cast<double>(jitter.poses));
  return jitter;
}

}  // namespace lidarena::evaluation
