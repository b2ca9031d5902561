// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/find_place.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <vector>

#include "lidarena/base/error.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;

constexpr double kPathStep_m = 0.2;  // between the points of the path that are looked at
constexpr double kRouteStep_m = 1.0;
constexpr int kDirections = 24;
constexpr int kHeights = 8;  // a quarter of a meter apart, centered at the route

/// Points of the path, a far one after the other, so that a bad place is soon known.
std::vector<Vector3d> points_of(const Flight& flight) {
  std::vector<Vector3d> points{flight.pose_at(Time{0}).translation()};
  for (Time t{0}; t <= flight.duration(); t += std::chrono::milliseconds(10)) {
    const Vector3d here = flight.pose_at(t).translation();
    if ((here - points.back()).norm() >= kPathStep_m) points.push_back(here);
  }
  std::vector<Vector3d> order;
  constexpr std::size_t kStride = 16;
  for (std::size_t begin = 0; begin < kStride; ++begin)
    for (std::size_t i = begin; i < points.size(); i += kStride) order.push_back(points[i]);
  return order;
}

/// The point of the path next to the middle of its bounding box.
Vector3d middle_of(const std::vector<Vector3d>& points) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& point : points) box.extend(point);
  const Vector3d center = box.center();
  return *std::ranges::min_element(points, {},
                                   [&](const Vector3d& p) { return (p - center).squaredNorm(); });
}

std::vector<Vector3d> anchors_of(const world::WorldModel& model) {
  std::vector<Vector3d> anchors;
  for (const auto& route : model.routes) {
    for (std::size_t i = 0; i + 1 < route.size(); ++i) {
      const Vector3d step = route[i + 1] - route[i];
      for (double s = 0.0; s < step.norm(); s += kRouteStep_m)
        anchors.push_back(route[i] + s * step.normalized());
    }
  }
  return anchors;
}

/// The least distance of the placed points to a surface; stops below `enough`.
double room_at(const Pose& place, const std::vector<Vector3d>& points, const world::World& world,
               double enough) {
  double room = std::numeric_limits<double>::infinity();
  for (const Vector3d& point : points) {
    room = std::min(room, world.closest_point(place * point).distance);
    if (room <= enough) break;
  }
  return room;
}

}  // namespace

Pose find_place(const Flight& flight, const world::WorldModel& model, const world::World& world,
                double clearance_m, const std::string& name) {
  const std::vector<Vector3d> points = points_of(flight);
  const Vector3d middle = middle_of(points);
  // Between two points nearer to each other than their room lies no surface.
  double best = std::max(clearance_m, kPathStep_m);
  std::optional<Pose> found;
  for (const Vector3d& anchor : anchors_of(model)) {
    for (int height = 0; height <= kHeights; ++height) {
      const Vector3d there = anchor + Vector3d(0, 0, 0.25 * (height - kHeights / 2));
      for (int direction = 0; direction < kDirections; ++direction) {
        const double yaw = 2.0 * std::numbers::pi * direction / kDirections;
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
        const Pose place = make_pose(turn, there - turn * middle);
        const double room = room_at(place, points, world, best);
        if (room <= best) continue;
        best = room;
        found = place;
      }
    }
  }
  if (found) return *found;
  throw InputError(name,
                   fmt::format("the world '{}' has no place along its {} route(s) where the path "
                               "stays {:.2f} m from every surface",
                               model.name, model.routes.size(), best),
                   "take a world with more room, reduce clearance_m (not below 0.2), or set "
                   "world_from_recording by hand");
}

}  // namespace lidarena::flight
