// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/time_law.hpp"

#include <algorithm>
#include <cmath>

namespace lidarena::flight {
namespace {

constexpr double kCell = 0.02;  // m, maximum length of a cell of constant acceleration

// In an arc the acceleration is divided into parts across and along the path: 0.8^2 + 0.6^2 = 1.
constexpr double kAcross = 0.8;
constexpr double kAlong = 0.6;

struct CellLimits {
  double speed, along;
};

CellLimits limits_in(const PathPiece& piece, const PathLimits& limits) {
  if (piece.curvature == 0.0) return {limits.max_speed, limits.max_acceleration};
  const double across = std::sqrt(kAcross * limits.max_acceleration / piece.curvature);
  return {std::min({limits.max_speed, across, limits.max_turn_rate / piece.curvature}),
          kAlong * limits.max_acceleration};
}

}  // namespace

TimeLaw::TimeLaw(const RoundedPath& path, const PathLimits& limits, double end) {
  std::vector<double> along;  // acceleration limit of each cell
  std::vector<bool> pause{false};
  nodes_.push_back({0.0, 0.0, 0.0, 0.0});
  double begin = 0.0;
  for (const PathPiece& piece : path.pieces()) {
    if (begin >= end) break;
    const double length = std::min(piece.length, end - begin);
    const CellLimits cell = limits_in(piece, limits);
    // at least two, so that there is a node with nonzero speed between two stops
    const auto count = std::max<std::size_t>(2, static_cast<std::size_t>(length / kCell) + 1);
    nodes_.back().speed = piece.from_stop ? 0.0 : std::min(nodes_.back().speed, cell.speed);
    pause.back() = piece.from_stop;
    for (std::size_t i = 1; i <= count; ++i) {
      const double s = begin + length * static_cast<double>(i) / static_cast<double>(count);
      nodes_.push_back({s, cell.speed, 0.0, 0.0});
    }
    along.resize(along.size() + count, cell.along);
    pause.resize(pause.size() + count, false);
    begin += length;
  }
  nodes_.back().speed = 0.0;
  make_reachable(along);

  for (std::size_t k = 0; k + 1 < nodes_.size(); ++k) {
    const Node& node = nodes_[k];
    Node& next = nodes_[k + 1];
    next.arrival = node.departure + 2.0 * (next.s - node.s) / (node.speed + next.speed);
    next.departure = next.arrival + (pause[k + 1] ? limits.stop_s : 0.0);
  }
}

void TimeLaw::make_reachable(const std::vector<double>& along) {
  const auto lower = [](const Node& from, double acceleration, Node& to) {
    const double gain = 2.0 * acceleration * std::abs(to.s - from.s);
    to.speed = std::min(to.speed, std::sqrt(from.speed * from.speed + gain));
  };
  const std::size_t last = nodes_.size() - 1;
  for (std::size_t k = 0; k < last; ++k) lower(nodes_[k], along[k], nodes_[k + 1]);
  for (std::size_t k = last; k-- > 0;) lower(nodes_[k + 1], along[k], nodes_[k]);
}

double TimeLaw::distance_at(double t) const {
  const auto later = [](double value, const Node& node) { return value < node.arrival; };
  const auto next = std::upper_bound(nodes_.begin(), nodes_.end(), t, later);
  if (next == nodes_.begin()) return 0.0;
  const Node& a = *(next - 1);
  if (next == nodes_.end() || t <= a.departure) return a.s;
  const double span = next->arrival - a.departure;
  const double tau = t - a.departure;
  return a.s + tau * (a.speed + 0.5 * tau * (next->speed - a.speed) / span);
}

TimeLaw law_of_duration(const RoundedPath& path, const PathLimits& limits, double duration) {
  double low = 0.0;
  double high = path.length();
  // after 50 bisections the interval is below a picometer for any realistic path
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (TimeLaw(path, limits, middle).duration() < duration ? low : high) = middle;
  }
  return {path, limits, high};
}

}  // namespace lidarena::flight
