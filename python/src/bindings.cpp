// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/bindings.hpp"

#include "lidarena/base/error.hpp"

namespace lidarena::python {

py::array view(const py::dtype& type, std::vector<py::ssize_t> shape,
               std::vector<py::ssize_t> strides, const void* data, const py::object& owner) {
  py::array array(type, std::move(shape), std::move(strides), data, owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

py::array own_points(std::vector<Eigen::Vector3f> points) {
  const auto [kept, owner] = keep(std::move(points));
  return view(py::dtype::of<float>(), {static_cast<py::ssize_t>(kept->size()), 3},
              {sizeof(Eigen::Vector3f), sizeof(float)}, kept->data(), owner);
}

namespace {

template <class Vector, class Array>
std::span<const Vector> rows(const Array& array, const char* name) {
  if (array.ndim() != 2 || array.shape(1) != 3) {
    throw InputError(name, "is not of shape (N, 3)");
  }
  return {reinterpret_cast<const Vector*>(array.data()), static_cast<std::size_t>(array.shape(0))};
}

}  // namespace

std::span<const Eigen::Vector3d> rows_of(const Array3d& array, const char* name) {
  return rows<Eigen::Vector3d>(array, name);
}

std::span<const Eigen::Vector3f> rows_of(const Array3f& array, const char* name) {
  return rows<Eigen::Vector3f>(array, name);
}

Pose pose_of(const Eigen::Matrix4d& matrix) {
  constexpr double kTolerance = 1e-6;
  const Eigen::Matrix3d r = matrix.topLeftCorner<3, 3>();
  const bool rigid = matrix.allFinite() &&
                     (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < kTolerance &&
                     (r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < kTolerance &&
                     r.determinant() > 0.0;
  if (!rigid) {
    throw InputError("pose", "is not a rigid transform",
                     "give a 4x4 matrix [R t; 0 0 0 1] with R orthonormal to 1e-6");
  }
  return make_pose(r, matrix.topRightCorner<3, 1>());
}

py::dtype structured(const std::vector<Field>& fields, std::size_t size) {
  py::list names, formats, offsets;
  for (const Field& field : fields) {
    names.append(field.name);
    formats.append(field.format);
    offsets.append(field.offset);
  }
  py::dict type;
  type["names"] = names;
  type["formats"] = formats;
  type["offsets"] = offsets;
  type["itemsize"] = size;
  return py::dtype::from_args(type);
}

py::object to_python(const Json& json) {
  switch (json.type()) {
    case Json::value_t::object: {
      py::dict dict;
      for (const auto& [key, value] : json.items()) dict[py::str(key)] = to_python(value);
      return dict;
    }
    case Json::value_t::array: {
      py::list list;
      for (const Json& value : json) list.append(to_python(value));
      return list;
    }
    case Json::value_t::string:
      return py::str(json.get<std::string>());
    case Json::value_t::boolean:
      return py::bool_(json.get<bool>());
    case Json::value_t::number_integer:
      return py::int_(json.get<std::int64_t>());
    case Json::value_t::number_unsigned:
      return py::int_(json.get<std::uint64_t>());
    case Json::value_t::number_float:
      return py::float_(json.get<double>());
    default:
      return py::none();
  }
}

std::string json_text(const py::handle& value) {
  const auto plain = py::cpp_function([](const py::object& o) { return o.attr("tolist")(); });
  const py::object dumps = py::module_::import("json").attr("dumps");
  return dumps(value, py::arg("default") = plain).cast<std::string>();
}

void PythonLog::message(LogLevel level, std::string_view text) {
  const py::gil_scoped_acquire gil;
  const py::object log = py::module_::import("logging").attr("getLogger")("lidarena");
  log.attr(level == LogLevel::kWarning ? "warning" : "info")("%s", std::string(text));
}

void PythonLog::progress(std::string_view, double, double) {
  const py::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace lidarena::python
