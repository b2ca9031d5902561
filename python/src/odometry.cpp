// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/odometry.hpp"

#include "lidarena/base/error.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/odometry/run.hpp"
#include "python/src/events.hpp"

namespace lidarena::python {
namespace {

constexpr std::array kStatuses{odometry::ScanStatus::kTracked, odometry::ScanStatus::kInitializing,
                               odometry::ScanStatus::kDegenerate,
                               odometry::ScanStatus::kTooFewPoints,
                               odometry::ScanStatus::kDiverged};

odometry::ScanStatus status_of(const std::string& name) {
  std::string known;
  for (const odometry::ScanStatus status : kStatuses) {
    if (name == odometry::to_string(status)) return status;
    known += std::string(known.empty() ? "" : ", ") + odometry::to_string(status);
  }
  throw InputError("status", "unknown status '" + name + "'", "use one of: " + known);
}

/// An odometry written in Python. Only register_scan is required; the other methods have defaults.
class PythonOdometry : public odometry::Odometry {
 public:
  odometry::OdometryTraits traits() const override {
    odometry::OdometryTraits defaults;
    defaults.publishes_scans = false;
    const py::gil_scoped_acquire gil;
    const py::function own =
        py::get_override(static_cast<const odometry::Odometry*>(this), "traits");
    return own ? own().cast<odometry::OdometryTraits>() : defaults;
  }
  void register_imu(const ImuSample& sample) override {
    PYBIND11_OVERRIDE(void, odometry::Odometry, register_imu, sample);
  }
  odometry::ScanResult register_scan(const Scan& scan) override {
    const odometry::ScanResult result = register_in_python(scan);
    estimates_.push_back(result.estimate);
    return result;
  }
  void finish() override { PYBIND11_OVERRIDE(void, odometry::Odometry, finish, ); }
  Trajectory trajectory() const override {
    const py::gil_scoped_acquire gil;
    const py::function own =
        py::get_override(static_cast<const odometry::Odometry*>(this), "trajectory");
    return own ? own().cast<Trajectory>() : Trajectory(estimates_, "estimates");
  }
  std::vector<Eigen::Vector3f> map() const override {
    const py::gil_scoped_acquire gil;
    const py::function own = py::get_override(static_cast<const odometry::Odometry*>(this), "map");
    if (!own) return {};
    const auto points = own().cast<Array3f>();
    const auto rows = rows_of(points, "map()");
    return {rows.begin(), rows.end()};
  }
  std::map<std::string, std::uint64_t> memory() const override {
    const py::gil_scoped_acquire gil;
    const py::function own =
        py::get_override(static_cast<const odometry::Odometry*>(this), "memory");
    if (!own) return {};
    return own().cast<std::map<std::string, std::uint64_t>>();
  }

 private:
  odometry::ScanResult register_in_python(const Scan& scan) {
    PYBIND11_OVERRIDE_PURE(odometry::ScanResult, odometry::Odometry, register_scan, scan);
  }
  std::vector<StampedPose> estimates_;
};

/// A field of ScanCounters from a number.
template <class T>
void set_counter(std::optional<T>& field, double value) {
  field = static_cast<T>(value);
}

odometry::ScanCounters counters_of(const std::map<std::string, double>& by_name) {
  odometry::ScanCounters counters;
  std::string known;
  for (const auto& [name, value] : by_name) {
    bool found = false;
    known.clear();
    odometry::ScanCounters::visit(counters, [&](const char* field_name, auto& field) {
      known += std::string(known.empty() ? "" : ", ") + field_name;
      if (name != field_name) return;
      set_counter(field, value);
      found = true;
    });
    if (!found)
      throw InputError("counters", "unknown counter '" + name + "'", "use some of: " + known);
  }
  return counters;
}

py::dict to_dict(const odometry::ScanCounters& counters) {
  py::dict by_name;
  odometry::ScanCounters::visit(counters, [&](const char* name, const auto& field) {
    if (field) by_name[name] = *field;
  });
  return by_name;
}

void bind_results(py::module_& m) {
  py::class_<odometry::ScanResult>(m, "ScanResult", "Result of one scan.")
      .def(py::init([](std::int64_t stamp, const Eigen::Matrix4d& pose, const std::string& status,
                       std::optional<Eigen::Matrix<double, 6, 6>> covariance,
                       std::map<std::string, double> counters) {
             return odometry::ScanResult{{Time{stamp}, pose_of(pose)},
                                         status_of(status),
                                         covariance,
                                         counters_of(counters),
                                         {}};
           }),
           py::arg("stamp"), py::arg("pose"), py::arg("status") = "tracked",
           py::arg("covariance") = py::none(),
           py::arg("counters") = std::map<std::string, double>{})
      .def_property_readonly(
          "stamp", [](const odometry::ScanResult& r) { return r.estimate.stamp.count(); },
          "Instant that the pose refers to, ns")
      .def_property_readonly(
          "pose",
          [](const odometry::ScanResult& r) { return matrix_of(r.estimate.world_from_body); },
          "4x4 world_from_body")
      .def_property_readonly(
          "status", [](const odometry::ScanResult& r) { return odometry::to_string(r.status); })
      .def_property_readonly(
          "covariance", [](const odometry::ScanResult& r) { return r.covariance; },
          "6x6 of (translation, rotation), or None")
      .def_property_readonly(
          "counters", [](const odometry::ScanResult& r) { return to_dict(r.counters); },
          "What the method counted, by name");
  py::class_<odometry::OdometryTraits>(m, "OdometryTraits", "Properties of an odometry.")
      .def(py::init([](bool needs_imu, bool revises_past, bool gravity_aligned) {
             return odometry::OdometryTraits{needs_imu, revises_past, gravity_aligned, false,
                                             "body"};
           }),
           py::arg("needs_imu") = false, py::arg("revises_past") = false,
           py::arg("gravity_aligned") = false)
      .def_readonly("needs_imu", &odometry::OdometryTraits::needs_imu)
      .def_readonly("revises_past", &odometry::OdometryTraits::revises_past)
      .def_readonly("gravity_aligned", &odometry::OdometryTraits::gravity_aligned);
}

py::object make(const py::object& rig, const std::string& algorithm, const std::string& lidar_id,
                const std::string& preset, const std::string& config_file,
                const std::vector<std::string>& overrides, int threads) {
  odometry::MadeOdometry made =
      odometry::make_odometry({algorithm, preset, config_file, overrides}, rig.cast<const Rig&>(),
                              lidar_id, Parallel(threads));
  py::object odometry = py::cast(std::move(made.odometry));
  odometry.attr("config") = to_python(made.config);
  return odometry;
}

py::list algorithms() {
  py::list rows;
  for (const odometry::AlgorithmInfo& info : odometry::list_algorithms()) {
    using namespace py::literals;
    rows.append(py::dict("name"_a = info.name, "summary"_a = info.summary,
                         "presets"_a = info.presets, "needs_imu"_a = info.needs_imu));
  }
  return rows;
}

py::dict summary_of(const odometry::RunSummary& s) {
  py::dict statuses;
  for (const auto& [status, count] : s.statuses) statuses[odometry::to_string(status)] = count;
  using namespace py::literals;
  return py::dict("scans"_a = s.scans, "statuses"_a = statuses,
                  "sensor_seconds"_a = s.sensor_seconds, "compute_seconds"_a = s.compute_seconds,
                  "diverged"_a = s.diverged, "reason"_a = s.reason);
}

odometry::RunResult run_events(odometry::Odometry& odometry, const py::object& given,
                               const std::string& lidar_id, const std::string& imu_id) {
  Events events(given);
  odometry::RunOptions options;
  options.lidar_id = lidar_id;
  options.imu_id = imu_id;
  const py::gil_scoped_release released;
  PythonLog log;
  return odometry::run(odometry, events.source(), options, log);
}

}  // namespace

void bind_odometry(py::module_& m) {
  bind_results(m);
  py::class_<odometry::Odometry, PythonOdometry>(
      m, "Odometry", py::dynamic_attr(),
      "A LiDAR(-inertial) odometry. Derive from it and define register_scan(scan) -> ScanResult, "
      "and where needed register_imu, finish, trajectory, map, memory, traits.")
      .def(py::init<>())
      .def("traits", &odometry::Odometry::traits)
      .def("register_imu", &odometry::Odometry::register_imu, py::arg("sample"),
           py::call_guard<py::gil_scoped_release>())
      .def("register_scan", &odometry::Odometry::register_scan, py::arg("scan"),
           py::call_guard<py::gil_scoped_release>())
      .def("finish", &odometry::Odometry::finish, py::call_guard<py::gil_scoped_release>())
      .def("trajectory", &odometry::Odometry::trajectory, "Best estimate of all poses so far.")
      .def(
          "map", [](const odometry::Odometry& o) { return own_points(o.map()); },
          "The method's own map, (N, 3) float32, world frame, m.")
      .def("memory", &odometry::Odometry::memory, "Memory in bytes, by part.");
  m.def("list_algorithms", &algorithms, "Name, summary, presets and needs_imu of each algorithm.");
  m.def("make_odometry", &make, py::arg("rig"), py::arg("algorithm"), py::arg("lidar_id") = "",
        py::arg("preset") = "", py::arg("config_file") = "",
        py::arg("overrides") = std::vector<std::string>{}, py::arg("threads") = 0,
        "Makes an algorithm by its name; `overrides` are 'key=value'. Its complete "
        "configuration is the attribute `config`.");
  py::class_<odometry::RunResult>(m, "RunResult", "Results of a run.")
      .def_property_readonly(
          "trajectory", [](const odometry::RunResult& r) { return r.files.trajectory; },
          "Final trajectory, after finish()")
      .def_property_readonly(
          "live", [](const odometry::RunResult& r) { return r.files.live; },
          "Poses as estimated right after each scan")
      .def_property_readonly(
          "map", [](const odometry::RunResult& r) { return own_points(r.files.map.points); },
          "Map published by the method, (N, 3) float32")
      .def_property_readonly("summary",
                             [](const odometry::RunResult& r) { return summary_of(r.summary); });
  m.def("run", &run_events, py::arg("odometry"), py::arg("events"), py::arg("lidar_id") = "",
        py::arg("imu_id") = "",
        "Runs an odometry on events: a Dataset, an EventSource, or an iterable of "
        "(sensor id, measurement).");
}

}  // namespace lidarena::python
