// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <span>
#include <vector>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/log.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/base/time.hpp"

/// Helpers of all parts of the Python module: C++ memory as NumPy arrays without copies, JSON as
/// Python values, poses as 4x4 matrices, times as integer nanoseconds, messages to Python's
/// logging.
namespace lidarena::python {

namespace py = pybind11;

using Array3d = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Array3f = py::array_t<float, py::array::c_style | py::array::forcecast>;

/// A read-only array on `data`; keeps `owner`, which owns the data, alive.
py::array view(const py::dtype& type, std::vector<py::ssize_t> shape,
               std::vector<py::ssize_t> strides, const void* data, const py::object& owner);

/// A view of the elements of a vector as rows of a structured or plain type; keeps `owner` alive.
template <class T>
py::array view_rows(const std::vector<T>& rows, const py::dtype& type, const py::object& owner) {
  return view(type, {static_cast<py::ssize_t>(rows.size())}, {sizeof(T)}, rows.data(), owner);
}

/// A capsule that owns `value`, and a pointer to the value in it.
template <class T>
std::pair<const T*, py::capsule> keep(T value) {
  auto* kept = new T(std::move(value));
  return {kept, py::capsule(kept, [](void* p) { delete static_cast<T*>(p); })};
}

/// (N, 3) view of a vector of 3-vectors that the array owns.
py::array own_points(std::vector<Eigen::Vector3f> points);

/// The rows of an (N, 3) array. Throws InputError naming `name` when it has another shape.
std::span<const Eigen::Vector3d> rows_of(const Array3d& array, const char* name);
std::span<const Eigen::Vector3f> rows_of(const Array3f& array, const char* name);

/// Throws InputError when the matrix is not a rigid transform (to 1e-6).
Pose pose_of(const Eigen::Matrix4d& matrix);
inline Eigen::Matrix4d matrix_of(const Pose& pose) { return pose.matrix(); }

/// A structured type of `size` bytes from (name, format, offset) of its fields.
struct Field {
  const char* name;
  const char* format;
  std::size_t offset;
};
py::dtype structured(const std::vector<Field>& fields, std::size_t size);

py::object to_python(const Json& json);
/// Serializes with Python's json module; also takes NumPy scalars and arrays.
std::string json_text(const py::handle& value);

/// Messages go to logging.getLogger("lidarena"); Ctrl-C ends the work at the next progress report.
class PythonLog : public LogSink {
 public:
  void message(LogLevel level, std::string_view text) override;
  void progress(std::string_view stage, double done, double total) override;
};

/// A configuration struct as a Python class; its fields, units, limits and errors come from the
/// struct's own list. Values of fields are plain (numbers, text, lists, dicts).
template <ConfigStruct C>
py::class_<C> bind_config(py::module_& m, const char* name, const char* doc) {
  py::class_<C> type(m, name, doc);
  type.def(py::init([](const py::kwargs& fields) {
    C config;
    read_config(ConfigNode::parse(json_text(fields), "keyword"), config);
    return config;
  }));
  type.def(
      "set", [](C& c, const std::string& assignment) { set_field(c, assignment); },
      py::arg("assignment"),
      "Sets one field, also a nested one, e.g. sensor.set('imu.rate_hz=100').");
  type.def(
      "to_dict", [](const C& c) { return to_python(to_json(c)); }, "All fields as plain values.");
  type.def_static(
      "fields",
      [] {
        C config;
        py::list rows;
        C::visit(config, [&](std::string_view field, auto&, std::string_view unit,
                             std::string_view text, Limits = {}) {
          rows.append(py::make_tuple(std::string(field), std::string(unit), std::string(text)));
        });
        return rows;
      },
      "Name, unit and meaning of each field.");
  type.def("__getattr__", [](const C& c, const std::string& key) {
    const Json json = to_json(c);
    if (!json.contains(key)) throw py::attribute_error("no field '" + key + "'");
    return to_python(json.at(key));
  });
  type.def("__setattr__", [](C& c, const std::string& key, const py::object& value) {
    read_config(ConfigNode::parse("{" + key + ": " + json_text(value) + "}", "attribute"), c);
  });
  type.def("__dir__", [](const py::object& self) {
    py::list names = py::module_::import("builtins").attr("object").attr("__dir__")(self);
    for (const auto& row : self.attr("fields")()) names.append(row.cast<py::tuple>()[0]);
    return names;
  });
  type.def("__eq__", [](const C& a, const C& b) { return to_json(a) == to_json(b); });
  type.def("__repr__", [name = std::string(name)](const C& c) {
    return "lidarena." + name + "(" + to_json(c).dump() + ")";
  });
  type.def("__deepcopy__", [](const C& c, const py::dict&) { return c; });
  type.def("__copy__", [](const C& c) { return c; });
  return type;
}

void bind_base(py::module_& m);
void bind_world(py::module_& m);
void bind_flight(py::module_& m);
void bind_sensor(py::module_& m);
void bind_dataset(py::module_& m);
void bind_odometry(py::module_& m);
void bind_evaluation(py::module_& m);

}  // namespace lidarena::python
