// SPDX-License-Identifier: BSD-3-Clause
#include <numbers>

#include "lidarena/scenes/furniture.hpp"
#include "lidarena/scenes/mesh_builder.hpp"

namespace lidarena::scenes::furniture {
namespace {

using Eigen::Vector3d;
using shape::box;
using shape::scaled;
using shape::translated;

using std::numbers::pi;
constexpr double kRail = 0.95;  // m, height of a handrail

/// A handrail on posts `spacing` meters apart; `a` and `b` are the points on the floor below its
/// ends.
world::TriangleMesh railing(Craft& craft, const Vector3d& a, const Vector3d& b, double spacing) {
  const Vector3d up(0, 0, kRail);
  world::TriangleMesh mesh = shape::bar({a + up, b + up}, 0.025, craft.fine(18));
  const int posts = static_cast<int>(std::ceil((b - a).norm() / spacing));
  for (int i = 0; i <= posts; ++i) {
    const Vector3d foot = a + (b - a) * i / posts;
    mesh.append(shape::bar({foot, foot + up}, 0.011, craft.fine(12)));
  }
  return mesh;
}

}  // namespace

Piece bathtub(Craft& craft) {
  const int n = craft.fine(72);
  std::vector<Eigen::Vector2d> profile{
      {0, 0.0}, {0.30, 0.0}, {0.34, 0.1}, {0.37, 0.52}, {0.40, 0.56}};
  for (const Eigen::Vector2d& p : shape::arc({0.385, 0.56}, 0.015, 0, pi, 6)) profile.push_back(p);
  for (const Eigen::Vector2d& p : std::vector<Eigen::Vector2d>{
           {0.35, 0.5}, {0.32, 0.25}, {0.27, 0.15}, {0.15, 0.12}, {0, 0.12}}) {
    profile.push_back(p);
  }
  world::TriangleMesh mesh =
      translated(scaled(shape::lathe(profile, n), {2.1, 1, 1}), {0, 0.41, 0});
  mesh.append(
      shape::bar({{0.6, 0.04, 0.56}, {0.6, 0.04, 0.75}, {0.6, 0.12, 0.78}, {0.6, 0.16, 0.74}},
                 0.015, craft.fine(14)));
  return {"bathtub", std::move(mesh)};
}

Piece toilet(Craft& craft) {
  world::TriangleMesh mesh =
      translated(shape::rounded_box({0.38, 0.17, 0.36}, 0.03, craft.fine(14)), {0, 0.09, 0.42});
  const std::vector<Eigen::Vector2d> profile{{0, 0},       {0.12, 0},    {0.1, 0.15},  {0.17, 0.36},
                                             {0.19, 0.4},  {0.19, 0.44}, {0.13, 0.44}, {0.12, 0.4},
                                             {0.07, 0.25}, {0, 0.22}};
  mesh.append(translated(scaled(shape::lathe(profile, craft.fine(48)), {1, 1.3, 1}), {0, 0.4, 0}));
  mesh.append(box({-0.1, 0.02, 0}, {0.1, 0.3, 0.42}));
  return {"toilet", std::move(mesh)};
}

Piece basin(Craft& craft) {
  const std::vector<Eigen::Vector2d> profile{{0, 0.68},     {0.1, 0.7},  {0.22, 0.78}, {0.25, 0.86},
                                             {0.235, 0.86}, {0.2, 0.78}, {0.08, 0.73}, {0, 0.725}};
  world::TriangleMesh mesh =
      translated(scaled(shape::lathe(profile, craft.fine(52)), {1.15, 0.9, 1}), {0, 0.24, 0});
  mesh.append(translated(
      shape::lathe({{0, 0}, {0.11, 0}, {0.07, 0.3}, {0.08, 0.7}, {0, 0.7}}, craft.fine(32)),
      {0, 0.2, 0}));
  mesh.append(shape::bar({{0, 0.05, 0.85}, {0, 0.05, 0.98}, {0, 0.12, 1.0}, {0, 0.16, 0.97}}, 0.012,
                         craft.fine(14)));
  return {"basin", std::move(mesh)};
}

Piece towel_rail(Craft& craft) {
  world::TriangleMesh mesh = shape::bar(
      {{-0.3, 0, 0.3}, {-0.3, 0.06, 0.3}, {0.3, 0.06, 0.3}, {0.3, 0, 0.3}}, 0.009, craft.fine(12));
  const double phase = craft.random.uniform(0, 2 * pi);
  mesh.append(shape::grid(craft.fine(40), craft.fine(30), [&](double u, double v) {
    const double ripple = 0.008 * std::sin(18 * u + phase) * v;
    return Vector3d(-0.22 + 0.44 * u, 0.075 + ripple, 0.31 - 0.45 * v);
  }));
  return {"towel rail", std::move(mesh)};
}

Piece stairs(Craft& craft, double width, double run, double rise, int steps) {
  constexpr double kTread = 0.045;
  const double half = 0.5 * width;
  world::TriangleMesh mesh;
  for (int i = 0; i < steps; ++i) {
    const double y = run * (steps - 1 - i) / steps;
    const double z = rise * (i + 1) / steps;
    mesh.append(translated(
        shape::rounded_box({width - 0.06, run / steps + 0.03, kTread}, 0.012, craft.fine(10)),
        {0, y + 0.5 * run / steps, z - kTread}));
  }
  for (const double x : {-half + 0.02, half - 0.02}) {  // stringers
    mesh.append(shape::grid(1, 4, [&](double u, double v) {
      // Follows the outline of the cross section of a plank inclined like the stairs.
      const int corner = static_cast<int>(std::lround(4 * v)) % 4;
      const double across = corner == 1 || corner == 2 ? 0.018 : -0.018;
      const double below = corner >= 2 ? -0.2 : 0.02;
      const double top = std::max(0.0, rise * (1 - u) + below);
      return Vector3d(x + across, run * u, top);
    }));
  }
  mesh.append(railing(craft, {half - 0.03, run, 0.05}, {half - 0.03, 0.1, rise}, 0.25));
  return {"stairs", std::move(mesh)};
}

Piece gallery(Craft& craft, const Vector3d& size, double gap) {
  constexpr double kSlab = 0.18;
  const double half = 0.5 * size.x();
  world::TriangleMesh mesh = box({-half, 0, size.z() - kSlab}, {half, size.y(), size.z()});
  const double y = size.y() - 0.05;
  mesh.append(railing(craft, {-half + gap, y, size.z()}, {half - 0.05, y, size.z()}, 0.14));
  return {"gallery", std::move(mesh)};
}

Piece column(Craft& craft, double height) {
  const double r = 0.07;
  world::TriangleMesh mesh = shape::lathe({{0, 0},
                                           {1.6 * r, 0},
                                           {1.6 * r, 0.06},
                                           {r, 0.1},
                                           {0.9 * r, 0.5 * height},
                                           {0.85 * r, height - 0.1},
                                           {1.5 * r, height - 0.04},
                                           {1.5 * r, height},
                                           {0, height}},
                                          craft.fine(40));
  return {"column", translated(std::move(mesh), {0, 1.6 * r, 0})};
}

}  // namespace lidarena::scenes::furniture
