// SPDX-License-Identifier: BSD-3-Clause
#include <numbers>

#include "lidarena/scenes/furniture.hpp"
#include "lidarena/scenes/mesh_builder.hpp"

namespace lidarena::scenes::furniture {
namespace {

using Eigen::Vector3d;
using shape::box;
using shape::translated;

using std::numbers::pi;
constexpr double kBoard = 0.02;  // m

/// A row of books of random sizes on a board, from x0 towards x1; it may end before x1.
world::TriangleMesh books(Craft& craft, double x0, double x1, double z, double depth,
                          double space) {
  world::TriangleMesh mesh;
  const double end = x0 + (x1 - x0) * craft.random.uniform(0.5, 1.0);
  for (double x = x0; x < end - 0.06;) {
    const double width = craft.random.uniform(0.015, 0.055);
    const double height = space * craft.random.uniform(0.55, 0.92);
    const double front = depth * craft.random.uniform(0.7, 0.95);
    mesh.append(box({x, 0.03, z}, {x + width, front, z + height}));
    x += width + craft.random.uniform(0.0, 0.004);
  }
  return mesh;
}

/// A ring about the y axis, for example of a washing machine's door.
world::TriangleMesh ring(Craft& craft, double radius, double thickness) {
  std::vector<Vector3d> path;
  const int n = craft.fine(48);
  for (int i = 0; i <= n; ++i) {
    const double angle = 2 * pi * i / n;
    path.emplace_back(radius * std::cos(angle), 0, radius * std::sin(angle));
  }
  return shape::bar(path, thickness, craft.fine(14));
}

world::TriangleMesh handle(Craft& craft, const Vector3d& from, const Vector3d& to) {
  const Vector3d out(0, 0.035, 0);
  return shape::bar({from, from + out, to + out, to}, 0.007, craft.fine(10));
}

}  // namespace

Piece bookshelf(Craft& craft, double width, double height) {
  const double depth = craft.random.uniform(0.26, 0.34);
  const double half = 0.5 * width;
  world::TriangleMesh mesh = box({-half, 0, 0}, {half, 0.01, height});
  for (const double x : {-half, half - kBoard}) {
    mesh.append(box({x, 0.01, 0}, {x + kBoard, depth, height}));
  }
  const int shelves = std::max(2, static_cast<int>(height / 0.36));
  const double space = (height - kBoard) / shelves;
  for (int i = 0; i <= shelves; ++i) {
    const double z = i * space;
    mesh.append(box({-half + kBoard, 0.01, z}, {half - kBoard, depth, z + kBoard}));
    if (i == shelves) break;
    mesh.append(books(craft, -half + 0.03, half - 0.03, z + kBoard, depth, space - kBoard));
  }
  return {"bookshelf", std::move(mesh), height < 1.3 ? height : 0};
}

Piece cabinet(Craft& craft, const std::string& kind, const Vector3d& size, int columns, int rows) {
  constexpr double kPlinth = 0.05;
  constexpr double kGap = 0.006;
  const double half = 0.5 * size.x();
  const double front = size.y() - kBoard;
  world::TriangleMesh mesh = box({-half, 0, kPlinth}, {half, front, size.z()});
  mesh.append(box({-half + 0.03, 0.03, 0}, {half - 0.03, front - 0.03, kPlinth}));
  const double w = size.x() / columns;
  const double h = (size.z() - kPlinth) / rows;
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      const double x = -half + (i + 0.5) * w;
      const double z = kPlinth + j * h;
      mesh.append(translated(shape::rounded_box({w - kGap, kBoard, h - kGap}, 0.008, craft.fine(8)),
                             {x, front + 0.5 * kBoard, z + 0.5 * kGap}));
      const double side = i % 2 == 0 ? 0.4 : -0.4;
      mesh.append(
          translated(shape::ball(0.014, craft.fine(14)),
                     {x + (rows > 1 && h < 0.5 ? 0 : side * w), size.y() + 0.01, z + 0.6 * h}));
    }
  }
  return {kind, std::move(mesh), size.z() < 1.3 ? size.z() : 0};
}

Piece kitchen_row(Craft& craft, double width) {
  constexpr double kDepth = 0.6;
  constexpr double kTop = 0.9;
  const int columns = std::max(1, static_cast<int>(width / 0.6));
  Piece piece = cabinet(craft, "kitchen row", {width, kDepth, kTop - 0.04}, columns, 1);
  piece.mesh.append(box({-0.5 * width, 0, kTop - 0.04}, {0.5 * width, kDepth + 0.02, kTop}));
  piece.top = kTop;
  return piece;
}

Piece sink(Craft& craft) {
  const std::vector<Eigen::Vector2d> profile{{0, 0.004},    {0.17, 0.006},  {0.2, 0.012},
                                             {0.205, 0.03}, {0.225, 0.035}, {0.23, 0.0}};
  world::TriangleMesh mesh =
      translated(shape::scaled(shape::lathe(profile, craft.fine(48)), {1.25, 1, 1}), {0, 0.31, 0});
  std::vector<Vector3d> tap{{0, 0.05, 0}, {0, 0.05, 0.2}};
  for (int i = 1; i <= 12; ++i) {
    const double angle = pi * i / 12;
    tap.emplace_back(0, 0.13 - 0.08 * std::cos(angle), 0.2 + 0.08 * std::sin(angle));
  }
  mesh.append(shape::bar(tap, 0.012, craft.fine(14)));
  return {"sink", std::move(mesh)};
}

Piece stove(Craft& craft) {
  Piece piece = cabinet(craft, "stove", {0.6, 0.6, 0.9}, 1, 1);
  for (const double x : {-0.14, 0.14}) {
    for (const double y : {0.16, 0.42}) {
      piece.mesh.append(translated(
          shape::cylinder(craft.random.uniform(0.07, 0.1), 0.012, craft.fine(36)), {x, y, 0.9}));
    }
  }
  for (int i = 0; i < 4; ++i) {
    piece.mesh.append(translated(
        shape::rotated(shape::cylinder(0.02, 0.025, craft.fine(16)), -pi / 2, Vector3d::UnitX()),
        {-0.21 + 0.14 * i, 0.6, 0.82}));
  }
  piece.mesh.append(handle(craft, {-0.22, 0.6, 0.7}, {0.22, 0.6, 0.7}));
  piece.top = 0.912;
  return piece;
}

Piece fridge(Craft& craft) {
  const double height = craft.random.uniform(1.6, 1.9);
  world::TriangleMesh mesh =
      translated(shape::rounded_box({0.6, 0.6, height}, 0.02, craft.fine(10)), {0, 0.3, 0});
  const double split = 0.4 * height;
  for (const auto& [z0, z1] : {std::pair{0.06, split}, std::pair{split + 0.01, height}}) {
    mesh.append(
        translated(shape::rounded_box({0.6, 0.05, z1 - z0}, 0.02, craft.fine(12)), {0, 0.63, z0}));
    mesh.append(handle(craft, {0.24, 0.65, z0 + 0.15}, {0.24, 0.65, z1 - 0.15}));
  }
  return {"fridge", std::move(mesh)};
}

Piece washing_machine(Craft& craft) {
  world::TriangleMesh mesh =
      translated(shape::rounded_box({0.6, 0.58, 0.85}, 0.02, craft.fine(10)), {0, 0.29, 0});
  mesh.append(translated(ring(craft, 0.17, 0.025), {0, 0.58, 0.42}));
  mesh.append(
      translated(shape::scaled(shape::ball(0.16, craft.fine(40)), {1, 0.25, 1}), {0, 0.58, 0.42}));
  mesh.append(translated(shape::ball(0.03, craft.fine(16)), {0.2, 0.58, 0.76}));
  return {"washing machine", std::move(mesh), 0.85};
}

Piece front_door(Craft& craft) {
  world::TriangleMesh mesh = box({-0.5, 0, 0}, {0.5, 0.04, 2.1});
  for (const double x : {-0.23, 0.23}) {
    for (const auto& [z, h] : {std::pair{0.15, 0.75}, std::pair{1.05, 0.9}}) {
      mesh.append(
          translated(shape::rounded_box({0.34, 0.03, h}, 0.015, craft.fine(12)), {x, 0.04, z}));
    }
  }
  mesh.append(handle(craft, {0.43, 0.04, 1.02}, {0.32, 0.04, 1.02}));
  return {"front door", std::move(mesh)};
}

}  // namespace lidarena::scenes::furniture
