// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/rounded_path.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "lidarena/base/error.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;

constexpr double kMinStep = 1e-3;        // m; waypoints closer than this are an input error
constexpr double kMinRadius = 1e-3;      // m; at a tighter corner the path stops
constexpr double kStraightAngle = 1e-6;  // rad; corners below this angle are ignored

/// The arc that rounds a corner; `reach` (m) is the length that it replaces on both segments.
struct Corner {
  double angle = 0.0, radius = 0.0, reach = 0.0;
  Vector3d normal = Vector3d::Zero();
  bool is_straight() const { return angle < kStraightAngle; }
  bool is_stop() const { return !is_straight() && radius < kMinRadius; }
  bool is_arc() const { return !is_straight() && !is_stop(); }
};

Corner corner_at(const Vector3d& in, const Vector3d& out, double reach, double tolerance) {
  Corner corner;
  corner.angle = std::atan2(in.cross(out).norm(), in.dot(out));
  if (corner.is_straight()) return corner;
  const double half = 0.5 * corner.angle;
  const double corner_distance =
      1.0 / std::cos(half) - 1.0;  // distance from corner to arc, per radius
  corner.radius = std::min(tolerance / corner_distance, reach / std::tan(half));
  if (corner.is_stop()) return corner;
  corner.reach = corner.radius * std::tan(half);
  corner.normal = (out - out.dot(in) * in).normalized();
  return corner;
}

}  // namespace

RoundedPath::RoundedPath(std::vector<PathPiece> pieces) : pieces_(std::move(pieces)) {
  begins_.push_back(0.0);
  for (const PathPiece& piece : pieces_) begins_.push_back(begins_.back() + piece.length);
}

std::size_t RoundedPath::piece_at(double s) const {
  const auto next = std::upper_bound(begins_.begin(), begins_.end() - 1, s);
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(next - begins_.begin() - 1, 0));
}

Vector3d RoundedPath::point(double s) const {
  const std::size_t k = piece_at(s);
  const PathPiece& piece = pieces_[k];
  const double along = std::clamp(s - begins_[k], 0.0, piece.length);
  if (piece.curvature == 0.0) return piece.begin + along * piece.tangent;
  const double angle = piece.curvature * along;
  const double chord = std::sin(0.5 * angle);  // 1 - cos = 2 sin^2, exact for small angles
  return piece.begin +
         (std::sin(angle) * piece.tangent + 2.0 * chord * chord * piece.normal) / piece.curvature;
}

Vector3d RoundedPath::direction(double s) const {
  const std::size_t k = piece_at(s);
  const PathPiece& piece = pieces_[k];
  const double angle = piece.curvature * std::clamp(s - begins_[k], 0.0, piece.length);
  return std::cos(angle) * piece.tangent + std::sin(angle) * piece.normal;
}

RoundedPath round_corners(std::span<const Vector3d> waypoints, double tolerance) {
  std::vector<PathPiece> pieces;
  Corner last;  // no rounding at the start of the path
  for (std::size_t i = 0; i + 1 < waypoints.size(); ++i) {
    const Vector3d step = waypoints[i + 1] - waypoints[i];
    const double length = step.norm();
    const Vector3d along = step / length;
    Corner next;
    if (i + 2 < waypoints.size()) {
      const Vector3d after = waypoints[i + 2] - waypoints[i + 1];
      const double reach = 0.5 * std::min(length, after.norm());
      next = corner_at(along, after.normalized(), reach, tolerance);
    }
    const double straight = length - last.reach - next.reach;
    if (straight > 0.0) {
      pieces.push_back({.begin = waypoints[i] + last.reach * along,
                        .tangent = along,
                        .length = straight,
                        .from_stop = last.is_stop()});
    }
    if (next.is_arc()) {
      pieces.push_back({.begin = waypoints[i + 1] - next.reach * along,
                        .tangent = along,
                        .normal = next.normal,
                        .curvature = 1.0 / next.radius,
                        .length = next.radius * next.angle});
    }
    last = next;
  }
  return RoundedPath(std::move(pieces));
}

void check_waypoints(std::span<const Vector3d> waypoints, const std::string& place) {
  if (waypoints.size() < 2) {
    throw InputError(place, fmt::format("has {} waypoint(s)", waypoints.size()),
                     "a flight needs at least two");
  }
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    if ((waypoints[i] - waypoints[i - 1]).norm() >= kMinStep) continue;
    const Vector3d& p = waypoints[i];
    throw InputError(place,
                     fmt::format("waypoint {} repeats the previous one: ({:g}, {:g}, {:g})", i + 1,
                                 p.x(), p.y(), p.z()),
                     "remove it");
  }
}

}  // namespace lidarena::flight
