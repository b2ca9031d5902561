// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/config_json.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/evaluation/evaluate_run.hpp"
#include "lidarena/evaluation/map/map_error.hpp"
#include "lidarena/stages/config_folder.hpp"
#include "lidarena/stages/run_algorithm.hpp"
#include "lidarena/stages/score_run.hpp"
#include "python/src/bindings.hpp"
#include "python/src/simulated_world.hpp"

namespace lidarena::python {
namespace {

namespace fs = std::filesystem;

py::object evaluate(const Trajectory& estimate, const Trajectory& truth,
                    const std::optional<Array3f>& map, const SimulatedWorld* world, int threads) {
  if (map.has_value() != (world != nullptr))
    throw InputError("map, world", "only one is given; give both or neither");
  dataset::RunFiles run;
  run.trajectory = run.live = estimate;
  if (map) {
    const auto rows = rows_of(*map, "map");
    run.map.points.assign(rows.begin(), rows.end());
  }
  results::RunMetrics metrics;
  {
    const py::gil_scoped_release released;
    PythonLog log;
    metrics = evaluation::evaluate_run(run, truth, world == nullptr ? nullptr : &world->world,
                                       Parallel(threads), log);
  }
  return to_python(to_json(metrics));
}

py::tuple map_error_of(const Array3f& map, const SimulatedWorld& world,
                       const std::optional<Eigen::Matrix4d>& mesh_from_map, int threads) {
  const auto rows = rows_of(map, "map");
  const Pose pose = mesh_from_map ? pose_of(*mesh_from_map) : Pose::Identity();
  std::vector<float> distances;
  evaluation::MapError error;
  {
    const py::gil_scoped_release released;
    error = evaluation::map_error(rows, pose, world.world, Parallel(threads), &distances);
  }
  const auto [kept, owner] = keep(std::move(distances));
  return py::make_tuple(to_python(to_json(error)), view_rows(*kept, py::dtype::of<float>(), owner));
}

py::object run_algorithm_on(const std::string& algorithm, const fs::path& dataset,
                            const fs::path& out, const std::string& preset,
                            const std::string& sensor, const std::string& config_file,
                            const std::vector<std::string>& overrides, int threads) {
  stages::RunRequest request;
  request.odometry = {algorithm, preset, config_file, overrides};
  request.dataset = dataset;
  request.read.sensor = sensor;
  Json summary;
  {
    const py::gil_scoped_release released;
    PythonLog log;
    stages::run_algorithm(request, out, Parallel(threads), log);
    summary = to_json(dataset::read_run_manifest(out).summary);
  }
  return to_python(summary);
}

}  // namespace

void bind_evaluation(py::module_& m) {
  py::class_<stages::ConfigFolder>(m, "ConfigFolder", "Named worlds, flights, sensors, studies.")
      .def(py::init<fs::path>(), py::arg("root"))
      .def_property_readonly("root", [](const stages::ConfigFolder& c) { return c.root(); })
      .def("names", &stages::ConfigFolder::names, py::arg("kind"))
      .def("resolve", &stages::ConfigFolder::resolve, py::arg("kind"), py::arg("name_or_path"));
  m.def("evaluate", &evaluate, py::arg("estimate"), py::arg("truth"), py::arg("map") = py::none(),
        py::arg("world") = nullptr, py::arg("threads") = 0,
        "All metrics of a trajectory, and of its map against a world, as in metrics.json.");
  m.def("map_error", &map_error_of, py::arg("map"), py::arg("world"),
        py::arg("mesh_from_map") = py::none(), py::arg("threads") = 0,
        "(figures, distance of each point to the mesh: float32, m, NaN if there is none).");
  m.def("run_algorithm", &run_algorithm_on, py::arg("algorithm"), py::arg("dataset"),
        py::arg("out"), py::arg("preset") = "", py::arg("sensor") = "", py::arg("config_file") = "",
        py::arg("overrides") = std::vector<std::string>{}, py::arg("threads") = 0,
        "Runs one algorithm over a dataset and writes a RUN folder.");
  m.def(
      "score_run",
      [](const fs::path& run, int threads) {
        results::RunMetrics metrics;
        {
          const py::gil_scoped_release released;
          PythonLog log;
          metrics = stages::score_run(run, {}, Parallel(threads), log);
        }
        return to_python(to_json(metrics));
      },
      py::arg("run"), py::arg("threads") = 0, "Scores a RUN folder against its dataset's truth.");
}

}  // namespace lidarena::python
