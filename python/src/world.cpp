// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/world.hpp"

#include "lidarena/base/error.hpp"
#include "lidarena/scenes/load_world.hpp"
#include "lidarena/world/export_world.hpp"
#include "python/src/bindings.hpp"
#include "python/src/simulated_world.hpp"

namespace lidarena::python {
namespace {

using Indices = py::array_t<std::uint32_t, py::array::c_style | py::array::forcecast>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

py::dtype hit_type() {
  return structured({{"range", "f4", offsetof(world::Hit, range)},
                     {"triangle", "u4", offsetof(world::Hit, triangle)},
                     {"normal", "3f4", offsetof(world::Hit, normal)}},
                    sizeof(world::Hit));
}

py::dtype closest_type() {
  return structured({{"point", "3f8", offsetof(world::ClosestPoint, point)},
                     {"distance", "f8", offsetof(world::ClosestPoint, distance)},
                     {"triangle", "u4", offsetof(world::ClosestPoint, triangle)}},
                    sizeof(world::ClosestPoint));
}

SimulatedWorld make_world(const Array3d& vertices, const Indices& triangles,
                          const std::string& name) {
  world::WorldModel model;
  model.name = name;
  const auto corners = rows_of(vertices, "vertices");
  model.mesh.vertices.assign(corners.begin(), corners.end());
  if (triangles.ndim() != 2 || triangles.shape(1) != 3) {
    throw InputError("triangles", "are not of shape (M, 3)");
  }
  const auto* begin = reinterpret_cast<const world::Triangle*>(triangles.data());
  model.mesh.triangles.assign(begin, begin + triangles.shape(0));
  return SimulatedWorld(std::move(model));
}

py::array cast(const SimulatedWorld& self, const Array3d& origins, const Array3f& directions,
               double max_range, int threads) {
  const auto from = rows_of(origins, "origins");
  const auto to = rows_of(directions, "directions");
  if (from.size() != to.size() && from.size() != 1) {
    throw InputError("origins", "must be one, or as many as the directions");
  }
  std::vector<world::Hit> hits(to.size());
  {
    const py::gil_scoped_release released;
    constexpr std::size_t kRaysPerBlock = 4096;
    Parallel(threads).for_blocks(to.size(), kRaysPerBlock, [&](std::size_t a, std::size_t b) {
      std::vector<world::Ray> rays;
      for (std::size_t i = a; i < b; ++i) {
        rays.push_back({from[from.size() == 1 ? 0 : i], to[i].normalized()});
      }
      self.world.cast(rays, max_range, std::span(hits).subspan(a, b - a));
    });
  }
  const auto [kept, owner] = keep(std::move(hits));
  return view_rows(*kept, hit_type(), owner);
}

py::array closest_points(const SimulatedWorld& self, const Array3d& points, double max_distance,
                         int threads) {
  const auto from = rows_of(points, "points");
  std::vector<world::ClosestPoint> found(from.size());
  {
    const py::gil_scoped_release released;
    self.world.closest_points(from, max_distance, found, Parallel(threads));
  }
  const auto [kept, owner] = keep(std::move(found));
  return view_rows(*kept, closest_type(), owner);
}

}  // namespace

void bind_world(py::module_& m) {
  py::class_<SimulatedWorld>(m, "World",
                             "A triangle mesh with ray casting and nearest-point queries.")
      .def(py::init(&make_world), py::arg("vertices"), py::arg("triangles"),
           py::arg("name") = "mesh")
      .def_property_readonly("name", [](const SimulatedWorld& w) { return w.model.name; })
      .def_property_readonly(
          "vertices",
          [](const py::object& self) {
            const auto& rows = self.cast<const SimulatedWorld&>().world.mesh().vertices;
            return view(py::dtype::of<double>(), {static_cast<py::ssize_t>(rows.size()), 3},
                        {3 * sizeof(double), sizeof(double)}, rows.data(), self);
          },
          "(N, 3) float64, m; a view")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            const auto& rows = self.cast<const SimulatedWorld&>().world.mesh().triangles;
            return view(py::dtype::of<std::uint32_t>(), {static_cast<py::ssize_t>(rows.size()), 3},
                        {sizeof(world::Triangle), sizeof(std::uint32_t)}, rows.data(), self);
          },
          "(M, 3) uint32, indices of vertices; a view")
      .def("cast", &cast, py::arg("origins"), py::arg("directions"),
           py::arg("max_range") = kInfinity, py::arg("threads") = 0,
           "First hit of each ray: structured range (m, inf if none), triangle, normal.")
      .def("closest_points", &closest_points, py::arg("points"),
           py::arg("max_distance") = kInfinity, py::arg("threads") = 0,
           "Nearest surface point of each point: structured point, distance, triangle.")
      .def(
          "save",
          [](const SimulatedWorld& w, const std::filesystem::path& file) {
            world::save_world(file, w.world.mesh());
          },
          py::arg("file"), "Writes .ply, .obj or .sdf, by the file extension.");
  m.def(
      "load_world_file",
      [](const std::filesystem::path& file, std::optional<std::uint64_t> seed, bool allow_missing) {
        const py::gil_scoped_release released;
        PythonLog log;
        scenes::WorldOptions options;
        options.seed = seed;
        options.allow_missing = allow_missing;
        return std::make_unique<SimulatedWorld>(scenes::load_world(file, options, log));
      },
      py::arg("file"), py::arg("seed") = py::none(), py::arg("allow_missing") = false);
}

}  // namespace lidarena::python
