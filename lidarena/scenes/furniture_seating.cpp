// SPDX-License-Identifier: BSD-3-Clause
#include <numbers>

#include "lidarena/scenes/furniture.hpp"
#include "lidarena/scenes/mesh_builder.hpp"

namespace lidarena::scenes::furniture {
namespace {

using Eigen::Vector3d;
using shape::translated;

using std::numbers::pi;

/// Four round legs, inset from the corners of a width x depth footprint.
world::TriangleMesh legs(Craft& craft, double width, double depth, double height, double radius) {
  world::TriangleMesh mesh;
  const double inset = 2.5 * radius;
  for (const double x : {-0.5 * width + inset, 0.5 * width - inset}) {
    for (const double y : {inset, depth - inset}) {
      mesh.append(translated(shape::cylinder(radius, height, craft.fine(16), 4), {x, y, 0}));
    }
  }
  return mesh;
}

/// A rounded box centered at x, with its back at y and its base at z.
world::TriangleMesh pad(Craft& craft, const Vector3d& size, double x, double y, double z,
                        double bulge) {
  const double radius = 0.35 * size.minCoeff();
  return translated(shape::rounded_box(size, radius, craft.fine(18), bulge),
                    {x, y + 0.5 * size.y(), z});
}

/// A quilt over a mattress: hangs down at both sides and the foot end, with folds.
world::TriangleMesh quilt(Craft& craft, double width, double length, double height) {
  const double phase = craft.random.uniform(0, 2 * pi);
  const int n = craft.fine(90);
  return shape::grid(n, n, [&](double u, double v) {
    const double across = 2 * u - 1;
    const double over = std::max(0.0, std::abs(across) - 0.8) / 0.2;  // beyond the edge
    const double foot = std::max(0.0, v - 0.85) / 0.15;
    const double fold = 0.012 * std::sin(9 * v + 4 * across + phase) +
                        0.008 * std::sin(23 * u + 5 * v + phase) +
                        0.015 * over * std::sin(40 * v + phase);
    const double drop = std::max(over * over, foot * foot);
    return Vector3d(across * (0.5 * width + 0.02) + 0.5 * fold * over, 0.55 + v * (length - 0.5),
                    height + fold - 0.3 * drop);
  });
}

}  // namespace

Piece sofa(Craft& craft, int seats) {
  const double seat = craft.random.uniform(0.60, 0.68);
  const double width = seats * seat + 0.4;
  const double depth = 0.9;
  world::TriangleMesh mesh = legs(craft, width, depth, 0.1, 0.025);
  mesh.append(pad(craft, {width, depth, 0.24}, 0, 0, 0.1, 0));
  for (int i = 0; i < seats; ++i) {
    const double x = (i - 0.5 * (seats - 1)) * seat;
    const double plump = craft.random.uniform(0.02, 0.05);
    mesh.append(pad(craft, {seat - 0.02, 0.66, 0.13}, x, 0.22, 0.33, plump));
    mesh.append(pad(craft, {seat - 0.03, 0.2, 0.42}, x, 0.04, 0.42, plump));
  }
  for (const double side : {-1.0, 1.0}) {
    mesh.append(pad(craft, {0.2, depth, 0.52}, side * 0.5 * (width - 0.2), 0, 0.1, 0.01));
  }
  return {seats > 1 ? "sofa" : "armchair", std::move(mesh)};
}

Piece chair(Craft& craft) {
  constexpr double kSeat = 0.45;
  world::TriangleMesh mesh = pad(craft, {0.42, 0.42, 0.05}, 0, 0.03, kSeat - 0.04, 0.008);
  const int facets = craft.fine(14);
  for (const double side : {-1.0, 1.0}) {
    const double x = side * 0.18;
    mesh.append(shape::bar({{1.1 * x, 0.43, 0}, {x, 0.4, 0.2}, {x, 0.4, kSeat}}, 0.016, facets));
    mesh.append(shape::bar({{1.1 * x, 0.02, 0}, {x, 0.06, kSeat}, {x, 0.05, 0.7}, {x, 0.0, 0.93}},
                           0.016, facets));
  }
  for (const double z : {0.62, 0.74, 0.86}) {  // bent slats of the back
    mesh.append(translated(shape::grid(craft.fine(20), craft.fine(10),
                                       [&](double u, double v) {
                                         const double bend = 0.03 * std::sin(pi * u);
                                         const double round = 2 * pi * v;
                                         return Vector3d(0.36 * (u - 0.5),
                                                         0.03 - bend + 0.008 * std::cos(round),
                                                         z + 0.03 * std::sin(round));
                                       }),
                           {0, 0.012, 0}));
  }
  return {"chair", std::move(mesh)};
}

Piece stool(Craft& craft) {
  const double height = craft.random.uniform(0.45, 0.65);
  world::TriangleMesh mesh =
      translated(shape::cylinder(0.17, 0.04, craft.fine(36), 3), {0, 0.2, height - 0.04});
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * pi * i / 3 + 0.5;
    const Vector3d out(std::cos(angle), std::sin(angle), 0);
    mesh.append(
        shape::bar({Vector3d(0, 0.2, 0) + 0.19 * out, Vector3d(0, 0.2, height - 0.02) + 0.11 * out},
                   0.014, craft.fine(12)));
  }
  return {"stool", std::move(mesh)};
}

Piece beanbag(Craft& craft) {
  const double phase = craft.random.uniform(0, 2 * pi);
  const int n = craft.fine(48);
  world::TriangleMesh mesh = shape::grid(2 * n, n, [&](double u, double v) {
    const double round = 2 * pi * u;
    const double tilt = pi * (v - 0.5);
    const double wrinkle = 1 + 0.03 * std::sin(5 * round + phase) * std::cos(tilt) +
                           0.02 * std::sin(11 * round - 3 * tilt);
    const double flat = v < 0.5 ? 0.55 : 1.0;  // flattened where it lies on the floor
    return Vector3d(0.42 * wrinkle * std::cos(tilt) * std::cos(round),
                    0.45 + 0.42 * wrinkle * std::cos(tilt) * std::sin(round),
                    0.23 + 0.42 * flat * std::sin(tilt));
  });
  return {"beanbag", std::move(mesh)};
}

Piece table(Craft& craft, const std::string& kind, double width, double depth, double height) {
  world::TriangleMesh mesh = legs(craft, width, depth, height - 0.03, 0.028);
  mesh.append(pad(craft, {width, depth, 0.04}, 0, 0, height - 0.04, 0));
  const double z = height - 0.11;  // aprons
  mesh.append(shape::box({-0.5 * width + 0.07, 0.06, z}, {0.5 * width - 0.07, 0.08, z + 0.07}));
  mesh.append(shape::box({-0.5 * width + 0.07, depth - 0.08, z},
                         {0.5 * width - 0.07, depth - 0.06, z + 0.07}));
  return {kind, std::move(mesh), height};
}

Piece desk(Craft& craft) {
  const double width = craft.random.uniform(1.1, 1.4);
  Piece piece = table(craft, "desk", width, 0.62, 0.74);
  piece.mesh.append(cabinet(craft, "drawers", {0.36, 0.5, 0.58}, 1, 3).mesh,
                    make_pose(Eigen::Quaterniond::Identity(), {0.5 * width - 0.3, 0.05, 0.04}));
  return piece;
}

Piece bed(Craft& craft, double width) {
  constexpr double kLength = 2.05;
  constexpr double kMattress = 0.5;  // height of its upper side
  world::TriangleMesh mesh = legs(craft, width, kLength, 0.18, 0.035);
  mesh.append(pad(craft, {width, kLength, 0.14}, 0, 0, 0.16, 0));
  mesh.append(pad(craft, {width - 0.06, kLength - 0.08, 0.22}, 0, 0.05, 0.28, 0.01));
  mesh.append(pad(craft, {width + 0.04, 0.07, craft.random.uniform(0.85, 1.1)}, 0, 0, 0, 0));
  mesh.append(quilt(craft, width, kLength, kMattress + 0.05));
  const int pillows = width > 1.2 ? 2 : 1;
  for (int i = 0; i < pillows; ++i) {
    const double x = (i - 0.5 * (pillows - 1)) * 0.5 * width;
    mesh.append(pad(craft, {0.62, 0.4, 0.09}, x + craft.random.uniform(-0.03, 0.03), 0.12,
                    kMattress, 0.03));
  }
  return {"bed", std::move(mesh)};
}

}  // namespace lidarena::scenes::furniture
