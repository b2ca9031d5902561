// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/bindings.hpp"

PYBIND11_MODULE(_core, m) {
  m.attr("__version__") = LIDARENA_VERSION;
  lidarena::python::bind_base(m);
  lidarena::python::bind_world(m);
  lidarena::python::bind_flight(m);
  lidarena::python::bind_dataset(m);
  lidarena::python::bind_sensor(m);
  lidarena::python::bind_odometry(m);
  lidarena::python::bind_evaluation(m);
}
