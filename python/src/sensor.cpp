// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/error.hpp"
#include "lidarena/flight/make_flight.hpp"
#include "lidarena/flight/replay_flight.hpp"
#include "lidarena/sensor/lidar.hpp"
#include "lidarena/sensor/simulate.hpp"
#include "python/src/bindings.hpp"
#include "python/src/simulated_world.hpp"

namespace lidarena::python {
namespace {

using Stamps = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

py::dtype beam_type() {
  return structured({{"direction", "3f4", offsetof(sensor::Beam, direction)},
                     {"dt_ns", "i4", offsetof(sensor::Beam, dt_ns)},
                     {"ring", "u2", offsetof(sensor::Beam, ring)},
                     {"origin", "3f4", offsetof(sensor::Beam, origin)}},
                    sizeof(sensor::Beam));
}

py::dtype truth_type() {
  return structured({{"position", "3f4", offsetof(PointTruth, position)},
                     {"range", "f4", offsetof(PointTruth, range)},
                     {"normal", "3f4", offsetof(PointTruth, normal)},
                     {"triangle", "u4", offsetof(PointTruth, triangle)}},
                    sizeof(PointTruth));
}

Trajectory sampled(const flight::Flight& flight, const Stamps& stamps) {
  std::vector<StampedPose> poses;
  for (py::ssize_t i = 0; i < stamps.size(); ++i) {
    const Time t{stamps.at(i)};
    poses.push_back({t, flight.pose_at(t)});
  }
  return Trajectory(std::move(poses), "stamps");
}

py::array beams(const sensor::Lidar& lidar, std::uint64_t index) {
  std::vector<sensor::Beam> list;
  lidar.pattern().beams(index, list);
  const auto [kept, owner] = keep(std::move(list));
  return view_rows(*kept, beam_type(), owner);
}

py::object measure(const sensor::Lidar& lidar, const SimulatedWorld& world,
                   const flight::Flight& flight, std::uint64_t index, bool truth, int threads) {
  auto scan = std::make_unique<Scan>();
  std::vector<PointTruth> hits;
  {
    const py::gil_scoped_release released;
    *scan = lidar.measure(world.world, flight, index, Parallel(threads), truth ? &hits : nullptr);
  }
  if (!truth) return py::cast(std::move(scan));
  const auto [kept, owner] = keep(std::move(hits));
  return py::make_tuple(py::cast(std::move(scan)), view_rows(*kept, truth_type(), owner));
}

}  // namespace

void bind_flight(py::module_& m) {
  py::class_<flight::Motion>(m, "Motion", "State of the flying body at one instant.")
      .def_property_readonly(
          "pose", [](const flight::Motion& s) { return matrix_of(s.world_from_body); },
          "4x4 world_from_body")
      .def_property_readonly(
          "velocity", [](const flight::Motion& s) { return s.velocity_world; }, "m/s, world")
      .def_property_readonly(
          "acceleration", [](const flight::Motion& s) { return s.acceleration_world; },
          "m/s^2, world, without gravity")
      .def_property_readonly(
          "angular_rate", [](const flight::Motion& s) { return s.angular_rate_body; },
          "rad/s, body");
  py::class_<flight::Flight>(m, "Flight", "Motion of the body as a function of time.")
      .def_property_readonly(
          "duration", [](const flight::Flight& f) { return f.duration().count(); }, "ns")
      .def(
          "at", [](const flight::Flight& f, std::int64_t t) { return f.at(Time{t}); }, py::arg("t"),
          "Motion at t nanoseconds since the flight's start.")
      .def("sample", &sampled, py::arg("stamps"), "Poses at increasing instants (ns).");
  m.def(
      "make_flight_file",
      [](const std::filesystem::path& file, const SimulatedWorld& world) {
        const py::gil_scoped_release released;
        PythonLog log;
        return flight::make_flight(file, world.model, world.world, log);
      },
      py::arg("file"), py::arg("world"));
  m.def(
      "replay",
      [](const Trajectory& t) -> std::unique_ptr<flight::Flight> {
        return std::make_unique<flight::ReplayFlight>(t);
      },
      py::arg("trajectory"), "A flight through every pose; time 0 is the first pose.");
}

void bind_sensor(py::module_& m) {
  bind_config<sensor::SensorConfig>(m, "Sensor", "A LiDAR, its mounting, its noise and its IMU.");
  m.def("load_sensor_file", &sensor::load_sensor, py::arg("file"), py::arg("shipped"),
        py::arg("set") = std::vector<std::string>());
  m.def("make_rig", &sensor::make_rig, py::arg("sensors"), "The rig of these sensors on one body.");
  py::class_<sensor::Lidar>(m, "Lidar", "A simulated LiDAR that moves through a world.")
      .def(py::init([](const sensor::SensorConfig& sensor, std::uint64_t seed, bool noise) {
             return std::make_unique<sensor::Lidar>(sensor, sensor::make_pattern(sensor),
                                                    sensor.name, seed, noise);
           }),
           py::arg("sensor"), py::arg("seed") = 1, py::arg("noise") = true)
      .def_property_readonly(
          "period", [](const sensor::Lidar& l) { return l.pattern().period().count(); },
          "ns from one scan's stamp to the next")
      .def("beams", &beams, py::arg("index"),
           "Shots of a scan in firing order: structured direction, dt_ns, ring, origin.")
      .def("measure", &measure, py::arg("world"), py::arg("flight"), py::arg("index"),
           py::arg("truth") = false, py::arg("threads") = 0,
           "Scan `index`; with truth: (Scan, structured array of what each point hit).");
  m.def(
      "simulate",
      [](const SimulatedWorld& world, const flight::Flight& flight,
         const std::vector<sensor::SensorConfig>& sensors, std::uint64_t seed, double seconds,
         bool noise, int threads) {
        sensor::SimulationOptions options;
        options.seed = seed;
        options.duration = from_seconds(seconds);
        options.noise = noise;
        return sensor::simulate(world.world, flight, sensors, options, Parallel(threads));
      },
      py::arg("world"), py::arg("flight"), py::arg("sensors"), py::arg("seed") = 1,
      py::arg("seconds") = 0.0, py::arg("noise") = true, py::arg("threads") = 0,
      py::keep_alive<0, 1>(), py::keep_alive<0, 2>(),
      "Simulates a flight; yields (sensor id, Scan or ImuSample), each when it is requested.");
}

}  // namespace lidarena::python
