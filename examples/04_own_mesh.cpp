// SPDX-License-Identifier: BSD-3-Clause
// Use your own mesh: a wavy surface 20 m wide is generated, written and read back; load_world()
// reads any OBJ, PLY, STL, DAE, glTF or SDF. usage: example_04_own_mesh [FOLDER]
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "lidarena/scenes/load_world.hpp"
#include "lidarena/world/export_world.hpp"
#include "lidarena/world/world.hpp"

namespace {

constexpr std::uint32_t kCells = 80;

double height(double x, double y) { return 0.3 * std::sin(x) * std::cos(y); }

lidarena::world::TriangleMesh waves() {
  lidarena::world::TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= kCells; ++i) {
    for (std::uint32_t j = 0; j <= kCells; ++j) {
      const double x = -10.0 + 20.0 * i / kCells;
      const double y = -10.0 + 20.0 * j / kCells;
      mesh.vertices.emplace_back(x, y, height(x, y));
      if (i == kCells || j == kCells) continue;
      const std::uint32_t a = i * (kCells + 1) + j;
      const std::uint32_t b = a + kCells + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
  return mesh;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace lidarena;
  const std::filesystem::path folder = argc > 1 ? argv[1] : "out/own_mesh";
  std::filesystem::create_directories(folder);
  world::save_world(folder / "waves.ply", waves());
  LogSink silent;
  const world::World world(scenes::load_world(folder / "waves.ply", {}, silent).mesh, "waves");

  const world::Ray down{{1.234, -4.321, 5.0}, -Eigen::Vector3f::UnitZ()};
  world::Hit hit;
  world.cast({&down, 1}, 10.0, {&hit, 1});
  const double measured = 5.0 - static_cast<double>(hit.range);
  const double expected = height(1.234, -4.321);
  std::printf("%zu triangles; height below the ray: %.4f m by the formula, %.4f m by the mesh\n",
              world.mesh().triangles.size(), expected, measured);
  return std::abs(measured - expected) < 0.3 * 0.25 * 0.25 / 4.0 ? 0 : 1;  // chord to curve
}
