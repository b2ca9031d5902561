// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "lidarena/base/config.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/base/time.hpp"

namespace lidarena::world {

enum class MoverKind { kPerson, kDoor, kBox };
constexpr auto enum_names(MoverKind) {
  return std::array{std::pair{"person", MoverKind::kPerson}, std::pair{"door", MoverKind::kDoor},
                    std::pair{"box", MoverKind::kBox}};
}

/// A body that moves through a world, as a function of time alone. A person and a box follow their
/// path, facing along it: round and round if its last point equals the first, else forth and back.
/// A door turns about the vertical at the first point of its path; its second point is the other
/// end of the closed leaf.
struct MoverConfig {
  std::string name;
  MoverKind kind = MoverKind::kPerson;
  std::vector<Eigen::Vector3d> path;
  double speed = 1.2;
  double start_s = 0.0;
  Eigen::Vector3d size = Eigen::Vector3d::Constant(0.6);
  double height_m = 1.75;
  double opening_deg = 90.0;
  double period_s = 8.0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "name in messages");
    v("kind", self.kind, "", "person, door or box");
    v("path", self.path, "m", "points on the floor, x y z each; one point: it stands still");
    v("speed", self.speed, "m/s", "speed along the path (people walk at 1.2)", between(0, 20));
    v("start_s", self.start_s, "s", "how long it has been moving at the start of the flight",
      between(0, 1e6));
    v("size", self.size, "m", "length, width and height of a box", above(0));
    v("height_m", self.height_m, "m", "height of a person or a door", between(0.5, 5));
    v("opening_deg", self.opening_deg, "deg",
      "angle to which a door opens, counterclockwise from above", between(-180, 180));
    v("period_s", self.period_s, "s", "time from closed to closed of a door", above(0));
  }
};

/// Pose of the mover's frame (on the floor, x along its way; a door's at its hinge, x along the
/// leaf) at `t` after the start of the flight.
Pose mover_pose(const MoverConfig& mover, Time t);

/// Throws InputError (place `place`) if the path is too short for the kind or has equal neighbors.
void check_mover(const MoverConfig& mover, const std::string& place);

}  // namespace lidarena::world
