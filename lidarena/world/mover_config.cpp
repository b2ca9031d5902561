// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/mover_config.hpp"

#include <cmath>
#include <numbers>

#include "lidarena/base/error.hpp"

namespace lidarena::world {
namespace {

using Eigen::Vector3d;

Pose facing(const Vector3d& place, const Vector3d& ahead, double turn = 0.0) {
  const double yaw = std::atan2(ahead.y(), ahead.x()) + turn;
  return make_pose(Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vector3d::UnitZ())), place);
}

double length_of(const std::vector<Vector3d>& path) {
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) length += (path[i] - path[i - 1]).norm();
  return length;
}

/// At the distance `s` along the path.
Pose on_path(const std::vector<Vector3d>& path, double s, bool backwards) {
  std::size_t i = 1;
  double rest = s;
  while (i + 1 < path.size() && rest > (path[i] - path[i - 1]).norm()) {
    rest -= (path[i] - path[i - 1]).norm();
    ++i;
  }
  const Vector3d step = path[i] - path[i - 1];
  const Vector3d place = path[i - 1] + rest / step.norm() * step;
  return facing(place, backwards ? Vector3d(-step) : step);
}

}  // namespace

Pose mover_pose(const MoverConfig& mover, Time t) {
  const double seconds = to_seconds(t) + mover.start_s;
  if (mover.kind == MoverKind::kDoor) {
    const double open = 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * seconds / mover.period_s));
    const double turn = mover.opening_deg * std::numbers::pi / 180.0 * open;
    return facing(mover.path[0], mover.path[1] - mover.path[0], turn);
  }
  if (mover.path.size() == 1) return facing(mover.path[0], Vector3d::UnitX());
  const double length = length_of(mover.path);
  const bool is_round = mover.path.front() == mover.path.back();
  const double way = std::max(0.0, mover.speed * seconds);
  const double s = std::fmod(way, is_round ? length : 2.0 * length);
  return s <= length ? on_path(mover.path, s, false) : on_path(mover.path, 2.0 * length - s, true);
}

void check_mover(const MoverConfig& mover, const std::string& place) {
  const std::string name = "the mover '" + mover.name + "' ";
  if (mover.path.empty())
    throw InputError(place, name + "has no path", "give it one point or more");
  if (mover.kind == MoverKind::kDoor && mover.path.size() != 2)
    throw InputError(place, name + "is a door whose path is not two points",
                     "give the hinge and the other end of the closed leaf");
  for (std::size_t i = 1; i < mover.path.size(); ++i) {
    if ((mover.path[i] - mover.path[i - 1]).head<2>().norm() < 1e-6)
      throw InputError(place, name + "has a path with two equal points in a row");
  }
}

}  // namespace lidarena::world
