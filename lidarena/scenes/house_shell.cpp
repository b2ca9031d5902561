// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/house_shell.hpp"

#include <algorithm>
#include <numbers>
#include <set>

#include "lidarena/scenes/mesh_builder.hpp"

namespace lidarena::scenes {
namespace {

constexpr double kSlab = 0.2;    // m, thickness of floor and ceilings
constexpr double kFrame = 0.05;  // m, width of window frames
constexpr double kPane = 0.008;  // m, thickness of window panes
constexpr double kTrim = 0.07;   // m, width of the trims around doors

/// Pose of a wall's frame (x along the wall, y across it, z up) in the world.
Pose world_from_wall(int axis, double line) {
  Pose pose = Pose::Identity();
  if (axis == 0) {
    pose.translation().y() = line;
  } else {
    pose.linear() = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()).matrix();
    pose.translation().x() = line;
  }
  return pose;
}

/// The maximum height of the rooms that touch the section from `a` to `b` of a line; 0 when none
/// does.
double height_beside(const HousePlan& plan, int axis, double line, double a, double b) {
  double height = 0;
  for (const Room& room : plan.rooms) {
    const bool touches = room.floor.min()[1 - axis] == line || room.floor.max()[1 - axis] == line;
    const double middle = 0.5 * (a + b);
    if (touches && room.floor.min()[axis] < middle && middle < room.floor.max()[axis]) {
      height = std::max(height, room.height);
    }
  }
  return height;
}

void add_quad(world::TriangleMesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
              const Eigen::Vector3d& c, const Eigen::Vector3d& d) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c, d});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

/// A plate of the given thickness in the xz plane with rectangular holes, as one closed surface.
/// The holes' edges divide it into cells; each solid cell gets a front, a back, and a side towards
/// each neighbor that is not solid.
world::TriangleMesh plate(const Eigen::AlignedBox2d& extent, double thickness,
                          const std::vector<Eigen::AlignedBox2d>& holes) {
  std::array<std::set<double>, 2> sets;
  for (int k = 0; k < 2; ++k) {
    auto& cuts = sets[static_cast<std::size_t>(k)];
    for (const double value : {extent.min()[k], extent.max()[k]}) cuts.insert(value);
    for (const auto& hole : holes) {
      for (const double value : {hole.min()[k], hole.max()[k]}) {
        cuts.insert(std::clamp(value, extent.min()[k], extent.max()[k]));
      }
    }
  }
  const std::vector<double> xs(sets[0].begin(), sets[0].end());
  const std::vector<double> zs(sets[1].begin(), sets[1].end());
  const auto solid = [&](std::size_t i, std::size_t j) {
    if (i >= xs.size() - 1 || j >= zs.size() - 1) return false;  // outside (0 - 1 wraps)
    const Eigen::Vector2d middle(0.5 * (xs[i] + xs[i + 1]), 0.5 * (zs[j] + zs[j + 1]));
    return std::ranges::none_of(holes, [&](const auto& hole) { return hole.contains(middle); });
  };
  const double h = 0.5 * thickness;
  world::TriangleMesh mesh;
  for (std::size_t i = 0; i + 1 < xs.size(); ++i) {
    for (std::size_t j = 0; j + 1 < zs.size(); ++j) {
      if (!solid(i, j)) continue;
      const auto at = [&](std::size_t di, double y, std::size_t dj) {
        return Eigen::Vector3d(xs[i + di], y, zs[j + dj]);
      };
      add_quad(mesh, at(0, -h, 0), at(1, -h, 0), at(1, -h, 1), at(0, -h, 1));
      add_quad(mesh, at(1, h, 0), at(0, h, 0), at(0, h, 1), at(1, h, 1));
      if (!solid(i - 1, j)) add_quad(mesh, at(0, h, 0), at(0, -h, 0), at(0, -h, 1), at(0, h, 1));
      if (!solid(i + 1, j)) add_quad(mesh, at(1, -h, 0), at(1, h, 0), at(1, h, 1), at(1, -h, 1));
      if (!solid(i, j - 1)) add_quad(mesh, at(0, h, 0), at(1, h, 0), at(1, -h, 0), at(0, -h, 0));
      if (!solid(i, j + 1)) add_quad(mesh, at(0, -h, 1), at(1, -h, 1), at(1, h, 1), at(0, h, 1));
    }
  }
  return mesh;
}

Eigen::AlignedBox2d hole_of(const Opening& opening) {
  return {Eigen::Vector2d(opening.center - 0.5 * opening.width, opening.sill),
          Eigen::Vector2d(opening.center + 0.5 * opening.width, opening.head)};
}

/// The wall's plate in its own frame, whose x is the world's x or y.
world::TriangleMesh build_wall(const Wall& wall, const HousePlan& plan, const HouseConfig& config) {
  std::vector<Eigen::AlignedBox2d> holes;
  for (const auto* openings : {&plan.doors, &plan.windows}) {
    for (const Opening& opening : *openings) {
      if (opening.axis == wall.axis && opening.line == wall.line && opening.center > wall.from &&
          opening.center < wall.to) {
        holes.push_back(hole_of(opening));
      }
    }
  }
  const Eigen::AlignedBox2d extent(Eigen::Vector2d(wall.from, 0),
                                   Eigen::Vector2d(wall.to, wall.top + kSlab));
  return plate(extent, config.wall_thickness_m, holes);
}

/// The four bars of a frame of width `width` along the inner side of a hole's edge (outer side if
/// negative); `foot`: with the lower bar.
world::TriangleMesh frame(const Eigen::AlignedBox2d& hole, double width, double depth, bool foot) {
  const Eigen::Vector2d w = Eigen::Vector2d::Constant(width);
  Eigen::AlignedBox2d inner(hole.min() + w.cwiseMax(0), hole.max() - w.cwiseMax(0));
  Eigen::AlignedBox2d outer(hole.min() + w.cwiseMin(0), hole.max() - w.cwiseMin(0));
  if (!foot) inner.min().y() = outer.min().y() = hole.min().y();
  return plate(outer, depth, {inner});
}

world::TriangleMesh build_window(const Opening& window, const HouseConfig& config) {
  const Eigen::AlignedBox2d hole = hole_of(window);
  world::TriangleMesh mesh = frame(hole, kFrame, kFrame, true);
  const double x = window.center;
  mesh.append(shape::box({x - 0.5 * kFrame, -0.5 * kFrame, window.sill},
                         {x + 0.5 * kFrame, 0.5 * kFrame, window.head}));
  mesh.paint(world::materials::kWood.of("window"));
  if (config.panes) {
    world::TriangleMesh pane = shape::box({hole.min().x(), -0.5 * kPane, hole.min().y()},
                                          {hole.max().x(), 0.5 * kPane, hole.max().y()});
    pane.paint(world::materials::kGlass.of("window"));
    mesh.append(pane);
  }
  return mesh;
}

/// Trims on both faces of the wall around a door; they do not narrow the opening.
world::TriangleMesh build_trims(const Opening& door, const HouseConfig& config) {
  constexpr double kThick = 0.015;  // m
  world::TriangleMesh mesh;
  for (const double side : {-0.5, 0.5}) {
    mesh.append(shape::translated(frame(hole_of(door), -kTrim, kThick, false),
                                  {0, side * (config.wall_thickness_m + kThick), 0}));
  }
  mesh.paint(world::materials::kWood.of("door frame"));
  return mesh;
}

}  // namespace

std::vector<Wall> plan_walls(const HousePlan& plan) {
  std::vector<Wall> walls;
  for (const int axis : {0, 1}) {
    std::set<double> lines;
    std::set<double> ends;
    for (const Room& room : plan.rooms) {
      lines.insert({room.floor.min()[1 - axis], room.floor.max()[1 - axis]});
      ends.insert({room.floor.min()[axis], room.floor.max()[axis]});
    }
    for (const double line : lines) {
      for (auto a = ends.begin(), b = std::next(a); b != ends.end(); ++a, ++b) {
        const double height = height_beside(plan, axis, line, *a, *b);
        if (height == 0) continue;
        Wall* last = walls.empty() ? nullptr : &walls.back();
        if (last != nullptr && last->axis == axis && last->line == line && last->to == *a &&
            last->top == height) {
          last->to = *b;
        } else {
          walls.push_back({axis, line, *a, *b, height});
        }
      }
    }
  }
  return walls;
}

world::TriangleMesh build_shell(const HousePlan& plan, const HouseConfig& config) {
  const double half = 0.5 * config.wall_thickness_m;
  const world::Material& plaster = world::materials::kPlaster;
  world::TriangleMesh mesh = shape::painted(
      shape::box({-half, -half, -kSlab}, {config.width_m + half, config.depth_m + half, 0}),
      plaster.of("floor"));
  for (const Room& room : plan.rooms) {
    if (!config.ceilings) break;
    mesh.append(shape::painted(
        shape::box({room.floor.min().x(), room.floor.min().y(), room.height},
                   {room.floor.max().x(), room.floor.max().y(), room.height + kSlab}),
        plaster.of("ceiling")));
  }
  for (Wall wall : plan_walls(plan)) {
    const double end = wall.axis == 0 ? config.width_m : config.depth_m;
    if (wall.axis == 0 && wall.from == 0) wall.from -= half;  // fills the corners of the house
    if (wall.axis == 0 && wall.to == end) wall.to += half;
    mesh.append(shape::painted(build_wall(wall, plan, config), plaster.of("wall")),
                world_from_wall(wall.axis, wall.line));
  }
  for (const Opening& window : plan.windows) {
    mesh.append(build_window(window, config), world_from_wall(window.axis, window.line));
  }
  for (const Opening& door : plan.doors) {
    mesh.append(build_trims(door, config), world_from_wall(door.axis, door.line));
  }
  return mesh;
}

}  // namespace lidarena::scenes
