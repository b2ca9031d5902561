// SPDX-License-Identifier: BSD-3-Clause
#include <numbers>

#include "lidarena/scenes/furniture.hpp"
#include "lidarena/scenes/mesh_builder.hpp"

namespace lidarena::scenes::furniture {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using shape::translated;

using std::numbers::pi;

/// An open cone of cloth from radius r0 at z0 to r1 at z1, pleated.
world::TriangleMesh shade(Craft& craft, double r0, double z0, double r1, double z1) {
  const int pleats = craft.random.integer(14, 26);
  return shape::grid(craft.fine(120), craft.fine(10), [&](double u, double v) {
    const double angle = 2 * pi * u;
    const double r = (r0 + (r1 - r0) * v) * (1 + 0.025 * std::cos(pleats * angle));
    return Vector3d(r * std::cos(angle), r * std::sin(angle), z0 + (z1 - z0) * v);
  });
}

/// A smooth profile through the given (radius, height) points: cubic Hermite (Catmull-Rom) pieces.
std::vector<Vector2d> smooth(const std::vector<Vector2d>& points, int steps) {
  std::vector<Vector2d> profile;
  const auto tangent = [&](std::size_t i) -> Vector2d {
    const std::size_t next = std::min(i + 1, points.size() - 1);
    return 0.5 * (points[next] - points[i == 0 ? 0 : i - 1]);
  };
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    for (int k = 0; k < steps; ++k) {
      const double t = static_cast<double>(k) / steps;
      Vector2d p =
          (2 * t * t * t - 3 * t * t + 1) * points[i] + (t * t * t - 2 * t * t + t) * tangent(i) +
          (3 * t * t - 2 * t * t * t) * points[i + 1] + (t * t * t - t * t) * tangent(i + 1);
      p.x() = std::max(p.x(), 0.0);
      profile.push_back(p);
    }
  }
  profile.push_back(points.back());
  return profile;
}

/// A leaf of the given length and width that leaves the stem in direction `heading`, rising by
/// `rise` rad and drooping towards its tip.
world::TriangleMesh leaf(Craft& craft, double length, double width, double heading, double rise) {
  const Vector3d out(std::cos(heading), std::sin(heading), 0);
  const Vector3d side(-out.y(), out.x(), 0);
  return shape::grid(craft.fine(10), 4, [&](double u, double v) -> Vector3d {
    const double across = (v - 0.5) * width * std::sin(pi * std::pow(u, 0.7));
    const double height = length * (u * std::sin(rise) - 0.55 * u * u);
    const double keel = 0.4 * std::abs(across);  // folded along its center line
    return length * u * std::cos(0.6 * rise) * out + across * side +
           (height + keel) * Vector3d::UnitZ();
  });
}

}  // namespace

Piece floor_lamp(Craft& craft) {
  const double height = craft.random.uniform(1.4, 1.65);
  world::TriangleMesh mesh = shape::cylinder(0.14, 0.025, craft.fine(40));
  mesh.append(shape::bar({{0, 0, 0.02}, {0, 0, height - 0.1}}, 0.012, craft.fine(14)));
  mesh.append(shade(craft, 0.22, height - 0.28, 0.13, height));
  mesh.append(translated(shape::ball(0.04, craft.fine(20)), {0, 0, height - 0.1}));
  return {"floor lamp", translated(std::move(mesh), {0, 0.25, 0})};
}

Piece table_lamp(Craft& craft) {
  const double r = craft.random.uniform(0.06, 0.09);
  world::TriangleMesh mesh = shape::lathe(
      smooth({{0, 0}, {0.8 * r, 0}, {r, 0.1}, {0.35 * r, 0.2}, {0.01, 0.3}, {0, 0.32}}, 8),
      craft.fine(36));
  mesh.append(shade(craft, 0.15, 0.26, 0.09, 0.44));
  return {"table lamp", translated(std::move(mesh), {0, 0.16, 0})};
}

Piece pendant_lamp(Craft& craft, double drop) {
  const double r = craft.random.uniform(0.16, 0.24);
  world::TriangleMesh mesh = translated(shape::cylinder(0.05, 0.03, craft.fine(24)), {0, 0, -0.03});
  mesh.append(shape::bar({{0, 0, -0.02}, {0, 0, -drop + 0.16}}, 0.004, 6));
  mesh.append(shape::lathe(
      smooth({{r, -drop}, {0.85 * r, -drop + 0.09}, {0.3 * r, -drop + 0.15}, {0, -drop + 0.17}}, 8),
      craft.fine(48)));
  mesh.append(translated(shape::ball(0.045, craft.fine(20)), {0, 0, -drop + 0.08}));
  return {"pendant lamp", std::move(mesh)};
}

Piece plant(Craft& craft, double height) {
  const double pot_height = 0.28 * height;
  const double r = 0.14 * height + 0.05;
  world::TriangleMesh mesh = shape::lathe({{0, 0},
                                           {0.7 * r, 0},
                                           {0.95 * r, 0.9 * pot_height},
                                           {r, pot_height},
                                           {0.92 * r, pot_height},
                                           {0.88 * r, 0.85 * pot_height},
                                           {0, 0.85 * pot_height}},
                                          craft.fine(40));
  const int stems = craft.random.integer(3, 5);
  for (int i = 0; i < stems; ++i) {
    const double lean = craft.random.uniform(0, 2 * pi);
    const double stem = (height - pot_height) * craft.random.uniform(0.55, 0.85);
    const Vector3d foot(0.25 * r * std::cos(lean), 0.25 * r * std::sin(lean), 0.8 * pot_height);
    const Vector3d tip = foot + Vector3d(0.5 * r * std::cos(lean), 0.5 * r * std::sin(lean), stem);
    mesh.append(shape::bar({foot, tip}, 0.006, 6));
    for (int k = 0; k < 14; ++k) {
      const double share = 0.25 + 0.75 * k / 13;
      const double length = height * craft.random.uniform(0.14, 0.22);
      mesh.append(translated(leaf(craft, length, 0.4 * length, craft.random.uniform(0, 2 * pi),
                                  craft.random.uniform(0.3, 1.1)),
                             foot + share * (tip - foot)));
    }
  }
  const double back = -mesh.bounds().min().y();
  return {"plant", translated(std::move(mesh), {0, back, 0})};
}

Piece vase(Craft& craft) {
  const double h = craft.random.uniform(0.18, 0.32);
  const double r = craft.random.uniform(0.05, 0.09);
  const std::vector<Vector2d> profile = smooth({{0, 0},
                                                {0.6 * r, 0.01},
                                                {r, 0.35 * h},
                                                {0.4 * r, 0.8 * h},
                                                {0.6 * r, h},
                                                {0.33 * r, 0.8 * h},
                                                {0, 0.3 * h}},
                                               8);
  return {"vase", translated(shape::lathe(profile, craft.fine(40)), {0, r, 0})};
}

Piece bowl(Craft& craft) {
  const double r = craft.random.uniform(0.1, 0.16);
  world::TriangleMesh mesh = shape::lathe(
      smooth({{0, 0}, {0.5 * r, 0.01}, {r, 0.09}, {0.9 * r, 0.09}, {0.4 * r, 0.025}, {0, 0.02}}, 6),
      craft.fine(44));
  for (int i = 0; i < 4; ++i) {  // fruit
    const double angle = pi * i / 2 + 0.3;
    mesh.append(translated(shape::ball(0.035, craft.fine(20)),
                           {0.4 * r * std::cos(angle), 0.4 * r * std::sin(angle), 0.065}));
  }
  return {"bowl", translated(std::move(mesh), {0, r, 0})};
}

Piece pot(Craft& craft) {
  const double r = craft.random.uniform(0.09, 0.13);
  const double h = craft.random.uniform(0.1, 0.16);
  world::TriangleMesh mesh = shape::lathe({{0, 0},
                                           {r, 0},
                                           {r, h},
                                           {0.7 * r, h + 0.02},
                                           {0.02, h + 0.03},
                                           {0.02, h + 0.05},
                                           {0, h + 0.05}},
                                          craft.fine(40));
  for (const double side : {-1.0, 1.0}) {
    mesh.append(shape::bar({{side * r, -0.03, 0.8 * h},
                            {side * (r + 0.04), -0.02, 0.8 * h},
                            {side * (r + 0.04), 0.02, 0.8 * h},
                            {side * r, 0.03, 0.8 * h}},
                           0.007, 8));
  }
  return {"pot", translated(std::move(mesh), {0, r, 0})};
}

Piece book_pile(Craft& craft) {
  world::TriangleMesh mesh;
  double z = 0;
  for (int i = craft.random.integer(2, 5); i > 0; --i) {
    const double thick = craft.random.uniform(0.015, 0.045);
    const double w = craft.random.uniform(0.07, 0.1);
    const double d = craft.random.uniform(0.1, 0.13);
    const world::TriangleMesh book = shape::box({-w, -d, 0}, {w, d, thick});
    const double turn = craft.random.uniform(-0.3, 0.3);
    mesh.append(translated(shape::rotated(book, turn, Vector3d::UnitZ()), {0, 0.16, z}));
    z += thick;
  }
  return {"books", std::move(mesh)};
}

Piece basket(Craft& craft, const std::string& kind, double radius, double height) {
  const int n = craft.fine(96);
  const int rows = craft.fine(24);
  const auto weave = [&](double r0, double r1, double z0, double z1) {
    return shape::grid(n, rows, [=](double u, double v) {
      const double angle = 2 * pi * u;
      const double r =
          r0 + (r1 - r0) * v + 0.006 * std::cos(24 * angle) * std::cos(12 * pi * v);  // wickerwork
      return Vector3d(r * std::cos(angle), r * std::sin(angle), z0 + (z1 - z0) * v);
    });
  };
  world::TriangleMesh mesh = shape::cylinder(0.85 * radius, 0.01, n);
  mesh.append(weave(0.85 * radius, radius, 0.0, height));
  mesh.append(weave(0.92 * radius, 0.78 * radius, height, 0.01));
  return {kind, translated(std::move(mesh), {0, radius + 0.01, 0})};
}

Piece toy_ball(Craft& craft) {
  const double r = craft.random.uniform(0.09, 0.16);
  return {"ball", translated(shape::ball(r, craft.fine(48)), {0, r, r})};
}

Piece rug(Craft& craft, double width, double depth) {
  const double phase = craft.random.uniform(0, 2 * pi);
  world::TriangleMesh mesh = shape::grid(craft.fine(70), craft.fine(50), [&](double u, double v) {
    const double edge = std::min({u, 1 - u, v, 1 - v}) * 40;  // the edge is flush with the floor
    const double pile = 0.012 + 0.003 * std::sin(31 * u + phase) * std::sin(27 * v + phase);
    return Vector3d((u - 0.5) * width, v * depth, std::min(1.0, edge) * pile);
  });
  return {"rug", std::move(mesh)};
}

Piece curtain(Craft& craft, double width, double height) {
  const double panel = 0.24 * width;
  const double folds = std::round(panel / 0.07);
  const double x = 0.5 * width;
  world::TriangleMesh mesh =
      shape::bar({{-x, 0, height}, {-x, 0.07, height}, {x, 0.07, height}, {x, 0, height}}, 0.012,
                 craft.fine(12));
  for (const double side : {-1.0, 1.0}) {
    const double phase = craft.random.uniform(0, 2 * pi);
    const double stray = craft.random.uniform(0.5, 1.5);
    mesh.append(shape::grid(
        craft.fine(static_cast<int>(14 * folds)), craft.fine(16), [&](double u, double v) {
          const double fold = std::sin(2 * pi * folds * u + stray * std::sin(3 * v + phase));
          const double across = (u - 0.5) * panel * (0.9 + 0.1 * std::cos(4 * v));
          return Vector3d(side * (x - 0.5 * panel) + across, 0.07 + (0.04 - 0.015 * v) * fold,
                          v * height);
        }));
  }
  return {"curtain", std::move(mesh)};
}

Piece picture(Craft& craft, const std::string& kind, double width, double height) {
  constexpr double kFrame = 0.035;
  const double x = 0.5 * width;
  const int facets = craft.fine(12);
  world::TriangleMesh mesh = shape::box({-x, 0, 0}, {x, 0.012, height});
  const Vector3d a(-x, 0.015, 0);
  const Vector3d b(x, 0.015, 0);
  const Vector3d up(0, 0, height);
  for (const auto& [from, to] :
       {std::pair{a, b}, std::pair<Vector3d, Vector3d>{a + up, b + up},
        std::pair<Vector3d, Vector3d>{a, a + up}, std::pair<Vector3d, Vector3d>{b, b + up}}) {
    mesh.append(shape::bar({from, to}, 0.5 * kFrame, facets));
  }
  return {kind, std::move(mesh)};
}

Piece television(Craft& craft) {
  world::TriangleMesh mesh =
      translated(shape::rounded_box({1.15, 0.05, 0.66}, 0.015, craft.fine(16)), {0, 0.14, 0.06});
  mesh.append(shape::box({-0.03, 0.12, 0.01}, {0.03, 0.15, 0.1}));
  mesh.append(translated(shape::scaled(shape::cylinder(0.14, 0.015, craft.fine(32)), {1.6, 1, 1}),
                         {0, 0.14, 0}));
  return {"television", std::move(mesh)};
}

Piece coat_rack(Craft& craft) {
  world::TriangleMesh mesh = shape::cylinder(0.2, 0.03, craft.fine(36));
  mesh.append(shape::bar({{0, 0, 0.02}, {0, 0, 1.75}}, 0.018, craft.fine(16)));
  mesh.append(translated(shape::ball(0.03, craft.fine(18)), {0, 0, 1.76}));
  const double phase = craft.random.uniform(0, pi);
  for (int i = 0; i < 5; ++i) {
    const double angle = 2 * pi * i / 5 + phase;
    const Vector3d out(std::cos(angle), std::sin(angle), 0);
    mesh.append(shape::bar(
        {Vector3d(0, 0, 1.6), Vector3d(0, 0, 1.58) + 0.1 * out, Vector3d(0, 0, 1.66) + 0.16 * out},
        0.01, craft.fine(10)));
  }
  // A coat that hangs in folds from one hook.
  const Vector3d hook(0.14 * std::cos(phase), 0.14 * std::sin(phase), 0);
  mesh.append(shape::grid(craft.fine(64), craft.fine(30), [&](double u, double v) -> Vector3d {
    const double angle = 2 * pi * u;
    const double r = (0.03 + 0.12 * std::sqrt(v)) * (1 + 0.12 * v * std::sin(7 * angle));
    return hook + Vector3d(r * std::cos(angle), 0.7 * r * std::sin(angle), 1.62 - 0.95 * v);
  }));
  const double back = -mesh.bounds().min().y();
  return {"coat rack", translated(std::move(mesh), {0, back, 0})};
}

}  // namespace lidarena::scenes::furniture
