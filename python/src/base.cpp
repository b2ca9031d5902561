// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/error.hpp"
#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/trajectories/trajectory_io.hpp"
#include "lidarena/dataset/trajectories/tum.hpp"
#include "python/src/bindings.hpp"

namespace lidarena::python {
namespace {

using Stamps = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;
using Matrices = py::array_t<double, py::array::c_style | py::array::forcecast>;

py::dtype point_type() {
  static_assert(offsetof(Point, dt_ns) == 16);
  return structured({{"position", "3f4", offsetof(Point, position)},
                     {"intensity", "f4", offsetof(Point, intensity)},
                     {"dt_ns", "i4", offsetof(Point, dt_ns)},
                     {"ring", "u2", offsetof(Point, ring)},
                     {"echo", "u1", offsetof(Point, echo)}},
                    sizeof(Point));
}

/// Points from a structured array with the fields of point_type(), or from (N, 3) positions.
std::vector<Point> points_of(const py::array& array) {
  if (!array.dtype().attr("names").is_none()) {
    const py::array rows = array.attr("astype")(point_type());
    const py::array packed = py::module_::import("numpy").attr("ascontiguousarray")(rows);
    const auto* begin = static_cast<const Point*>(packed.data());
    return {begin, begin + packed.size()};
  }
  const auto positions = Array3f::ensure(array);
  if (!positions) throw InputError("points", "are not numbers");
  std::vector<Point> points;
  for (const Eigen::Vector3f& p : rows_of(positions, "points")) points.emplace_back().position = p;
  return points;
}

Trajectory make_trajectory(const Stamps& stamps, const Matrices& poses) {
  if (poses.ndim() != 3 || poses.shape(1) != 4 || poses.shape(2) != 4 || stamps.ndim() != 1 ||
      stamps.shape(0) != poses.shape(0)) {
    throw InputError("Trajectory", "needs stamps of shape (N,) and poses of shape (N, 4, 4)");
  }
  using Row = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  std::vector<StampedPose> list;
  for (py::ssize_t i = 0; i < stamps.shape(0); ++i) {
    list.push_back({Time{stamps.at(i)}, pose_of(Eigen::Map<const Row>(poses.data(i, 0, 0)))});
  }
  return Trajectory(std::move(list));
}

/// A strided view of one member of every pose.
template <class Offset>
py::array strided_view(const py::object& self, std::vector<py::ssize_t> shape,
                       std::vector<py::ssize_t> strides, const py::dtype& type, Offset offset) {
  const auto poses = self.cast<const Trajectory&>().poses();
  shape.insert(shape.begin(), static_cast<py::ssize_t>(poses.size()));
  strides.insert(strides.begin(), sizeof(StampedPose));
  static const StampedPose kNothing;
  return view(type, shape, strides, offset(poses.empty() ? kNothing : poses.front()), self);
}

void bind_trajectory(py::module_& m) {
  constexpr py::ssize_t kDouble = sizeof(double);
  py::class_<Trajectory>(m, "Trajectory",
                         "Poses at strictly increasing instants (ns), 4x4 world_from_body each.")
      .def(py::init(&make_trajectory), py::arg("stamps"), py::arg("poses"))
      .def("__len__", &Trajectory::size)
      .def_property_readonly(
          "stamps",
          [](const py::object& self) {
            return strided_view(self, {}, {}, py::dtype::of<std::int64_t>(),
                                [](const StampedPose& p) -> const void* { return &p.stamp; });
          },
          "(N,) int64, ns; a view")
      .def_property_readonly(
          "poses",
          [=](const py::object& self) {
            return strided_view(self, {4, 4}, {kDouble, 4 * kDouble}, py::dtype::of<double>(),
                                [](const StampedPose& p) -> const void* {
                                  return p.world_from_body.matrix().data();
                                });
          },
          "(N, 4, 4) float64, world_from_body; a view")
      .def_property_readonly(
          "positions",
          [=](const py::object& self) {
            return strided_view(self, {3}, {kDouble}, py::dtype::of<double>(),
                                [](const StampedPose& p) -> const void* {
                                  return p.world_from_body.matrix().data() + 12;
                                });
          },
          "(N, 3) float64, m; a view")
      .def(
          "at",
          [](const Trajectory& t, std::int64_t stamp) -> std::optional<Eigen::Matrix4d> {
            const auto pose = t.at(Time{stamp});
            if (!pose) return std::nullopt;
            return matrix_of(*pose);
          },
          py::arg("stamp"), "Interpolated pose (4x4), or None outside the span.")
      .def_property_readonly("path_length", &Trajectory::path_length, "m")
      .def(
          "write",
          [](const Trajectory& t, const std::filesystem::path& file, const std::string& frames) {
            dataset::write_tum(file, t, frames + "\ntime[s] x y z[m] qx qy qz qw");
          },
          py::arg("file"), py::arg("frames") = "world_from_body", "Writes a TUM file.");
  m.def("read_trajectory", &dataset::read_trajectory, py::arg("file"), py::arg("rate_hz") = 10.0,
        "Reads TUM, KITTI poses or EuRoC csv; the format is detected from the content.");
}

void bind_measurements(py::module_& m) {
  m.attr("POINT") = point_type();
  py::class_<Scan>(m, "Scan", "One sweep: points in firing order, each with its own time.")
      .def(py::init([](std::int64_t stamp, const py::array& points, bool timed) {
             return Scan{Time{stamp}, points_of(points), timed};
           }),
           py::arg("stamp"), py::arg("points"), py::arg("timed") = true)
      .def_property_readonly(
          "stamp", [](const Scan& s) { return s.stamp.count(); },
          "Instant of the first firing, ns; dt_ns counts from here.")
      .def_property_readonly("timed", [](const Scan& s) { return s.timed; })
      .def("__len__", [](const Scan& s) { return s.points.size(); })
      .def_property_readonly(
          "points",
          [](const py::object& self) {
            return view_rows(self.cast<const Scan&>().points, point_type(), self);
          },
          "(N,) structured: position, intensity, dt_ns, ring, echo; a view")
      .def_property_readonly(
          "positions",
          [](const py::object& self) {
            const auto& points = self.cast<const Scan&>().points;
            return view(py::dtype::of<float>(), {static_cast<py::ssize_t>(points.size()), 3},
                        {sizeof(Point), sizeof(float)}, points.data(), self);
          },
          "(N, 3) float32, m, LiDAR frame at each point's own instant; a view");
  py::class_<ImuSample>(m, "ImuSample", "One sample of a 6-axis IMU, in its own frame.")
      .def(py::init(
               [](std::int64_t stamp, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel) {
                 return ImuSample{Time{stamp}, gyro, accel};
               }),
           py::arg("stamp"), py::arg("gyro"), py::arg("accel"))
      .def_property_readonly(
          "stamp", [](const ImuSample& s) { return s.stamp.count(); }, "ns")
      .def_property_readonly(
          "gyro", [](const ImuSample& s) { return s.gyro; }, "rad/s")
      .def_property_readonly(
          "accel", [](const ImuSample& s) { return s.accel; }, "m/s^2, +9.8 up at rest");
}

}  // namespace

void bind_base(py::module_& m) {
  static py::exception<Error> error(m, "Error", PyExc_RuntimeError);
  static py::exception<InputError> input_error(m, "InputError", PyExc_ValueError);
  error.attr("__doc__") = "A failure that is not bad input.";
  input_error.attr("__doc__") = "Bad input: place, what is wrong, remedy.";
  py::register_exception_translator([](std::exception_ptr p) {
    try {
      if (p) std::rethrow_exception(p);
    } catch (const InputError& e) {
      PyErr_SetString(input_error.ptr(), e.what());
    } catch (const Error& e) {
      PyErr_SetString(error.ptr(), e.what());
    }
  });
  bind_trajectory(m);
  bind_measurements(m);
  bind_config<LidarInfo>(m, "LidarInfo", "Data of a LiDAR that an estimator gets.");
  bind_config<ImuInfo>(m, "ImuInfo", "Data of an IMU that an estimator gets.");
  bind_config<Rig>(m, "Rig", "All sensors on one body: lists of lidars and imus, as dicts.");
}

}  // namespace lidarena::python
