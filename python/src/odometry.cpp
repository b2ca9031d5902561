// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/odometry.hpp"

#include "lidarena/base/error.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/stages/recorder.hpp"
#include "python/src/events.hpp"

namespace lidarena::python {
namespace {

constexpr std::array kStatuses{
    odometry::ScanStatus::kTracked,    odometry::ScanStatus::kInitializing,
    odometry::ScanStatus::kDegenerate, odometry::ScanStatus::kTooFewPoints,
    odometry::ScanStatus::kDiverged,   odometry::ScanStatus::kRefused};

odometry::ScanStatus status_of(const std::string& name) {
  std::string known;
  for (const odometry::ScanStatus status : kStatuses) {
    if (name == odometry::to_string(status)) return status;
    known += std::string(known.empty() ? "" : ", ") + odometry::to_string(status);
  }
  throw InputError("status", "unknown status '" + name + "'", "use one of: " + known);
}

/// An odometry written in Python. Only track is required; the other methods have defaults.
class PythonOdometry : public odometry::Odometry {
 public:
  odometry::OdometryTraits traits() const override {
    const py::gil_scoped_acquire gil;
    const py::function own =
        py::get_override(static_cast<const odometry::Odometry*>(this), "traits");
    return own ? own().cast<odometry::OdometryTraits>() : odometry::OdometryTraits{};
  }
  void register_imu(const ImuSample& sample) override {
    PYBIND11_OVERRIDE(void, odometry::Odometry, register_imu, sample);
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
  std::span<const Eigen::Vector3f> registered_scan() const override {
    const py::gil_scoped_acquire gil;
    const py::function own =
        py::get_override(static_cast<const odometry::Odometry*>(this), "registered_scan");
    if (!own) return {};
    const auto points = own().cast<Array3f>();
    const auto rows = rows_of(points, "registered_scan()");
    published_.assign(rows.begin(), rows.end());
    return published_;
  }
  odometry::MemoryUse memory() const override {
    const py::gil_scoped_acquire gil;
    const py::function own =
        py::get_override(static_cast<const odometry::Odometry*>(this), "memory");
    return own ? own().cast<odometry::MemoryUse>() : odometry::MemoryUse{};
  }

 protected:
  odometry::ScanResult track(const Scan& scan) override {
    const odometry::ScanResult result = track_in_python(scan);
    estimates_.push_back(result.estimate);
    return result;
  }

 private:
  odometry::ScanResult track_in_python(const Scan& scan) {
    PYBIND11_OVERRIDE_PURE(odometry::ScanResult, odometry::Odometry, track, scan);
  }
  std::vector<StampedPose> estimates_;
  mutable std::vector<Eigen::Vector3f> published_;
};

/// What a method counted, from the names and values given in Python: what a run records, and what
/// else there is.
void set_counters(const std::map<std::string, double>& by_name, odometry::ScanResult& result) {
  for (const auto& [name, value] : by_name) {
    bool is_recorded = false;
    odometry::ScanCounters::visit(result.counters, [&](const char* field_name, auto& field) {
      if (name != field_name) return;
      field = static_cast<std::uint64_t>(value);
      is_recorded = true;
    });
    if (!is_recorded) result.details.emplace_back(name, value);
  }
}

py::dict counters_of(const odometry::ScanResult& result) {
  py::dict by_name;
  odometry::ScanCounters::visit(result.counters, [&](const char* name, const auto& field) {
    if (field) by_name[name] = *field;
  });
  for (const auto& [name, value] : result.details) by_name[name.c_str()] = value;
  return by_name;
}

/// From pairs of (stamp, 4x4 world_from_body).
std::vector<StampedPose> poses_of(
    const std::vector<std::pair<std::int64_t, Eigen::Matrix4d>>& given) {
  std::vector<StampedPose> poses;
  for (const auto& [stamp, pose] : given) poses.push_back({Time{stamp}, pose_of(pose)});
  return poses;
}

std::vector<std::pair<std::int64_t, Eigen::Matrix4d>> pairs_of(
    const std::vector<StampedPose>& poses) {
  std::vector<std::pair<std::int64_t, Eigen::Matrix4d>> pairs;
  for (const StampedPose& pose : poses)
    pairs.emplace_back(pose.stamp.count(), matrix_of(pose.world_from_body));
  return pairs;
}

void bind_results(py::module_& m) {
  py::class_<odometry::ScanResult>(m, "ScanResult", "Result of one scan.")
      .def(py::init([](std::int64_t stamp, const Eigen::Matrix4d& pose, const std::string& status,
                       std::optional<Eigen::Matrix<double, 6, 6>> covariance,
                       const std::map<std::string, double>& counters,
                       const std::vector<std::pair<std::int64_t, Eigen::Matrix4d>>& motion,
                       const std::vector<std::pair<std::int64_t, Eigen::Matrix4d>>& revised) {
             odometry::ScanResult result{.estimate = {Time{stamp}, pose_of(pose)},
                                         .status = status_of(status),
                                         .covariance = covariance,
                                         .motion = poses_of(motion),
                                         .revised = poses_of(revised)};
             set_counters(counters, result);
             return result;
           }),
           py::arg("stamp"), py::arg("pose"), py::arg("status") = "tracked",
           py::arg("covariance") = py::none(),
           py::arg("counters") = std::map<std::string, double>{},
           py::arg("motion") = py::list(), py::arg("revised") = py::list())
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
          "counters", [](const odometry::ScanResult& r) { return counters_of(r); },
          "What the method counted, by name")
      .def_property_readonly(
          "motion", [](const odometry::ScanResult& r) { return pairs_of(r.motion); },
          "Poses within the scan: pairs of (stamp in ns, 4x4 world_from_body)")
      .def_property_readonly(
          "revised", [](const odometry::ScanResult& r) { return pairs_of(r.revised); },
          "The same of the scan before, revised by this one")
      .def_property_readonly(
          "up",
          [](const odometry::ScanResult& r) {
            return r.up ? std::optional(std::pair(r.up->direction, r.up->sigma_rad)) : std::nullopt;
          },
          "(unit vector in the world frame, standard deviation in rad), or None");
  py::class_<odometry::MemoryUse>(m, "MemoryUse", "Bytes that a method holds, by part.")
      .def(py::init([](std::uint64_t map, std::uint64_t scan_buffer, std::uint64_t backlog,
                       std::uint64_t other) {
             return odometry::MemoryUse{map, scan_buffer, backlog, other};
           }),
           py::arg("map") = 0, py::arg("scan_buffer") = 0, py::arg("backlog") = 0,
           py::arg("other") = 0)
      .def_readonly("map", &odometry::MemoryUse::map)
      .def_readonly("scan_buffer", &odometry::MemoryUse::scan_buffer)
      .def_readonly("backlog", &odometry::MemoryUse::backlog)
      .def_readonly("other", &odometry::MemoryUse::other);
  py::class_<odometry::OdometryTraits>(m, "OdometryTraits", "Properties of an odometry.")
      .def(py::init(
               [](bool needs_imu, bool revises_past, bool gravity_aligned, bool publishes_scans) {
                 return odometry::OdometryTraits{needs_imu, revises_past, gravity_aligned,
                                                 publishes_scans, "body"};
               }),
           py::arg("needs_imu") = false, py::arg("revises_past") = false,
           py::arg("gravity_aligned") = false, py::arg("publishes_scans") = false)
      .def_readonly("needs_imu", &odometry::OdometryTraits::needs_imu)
      .def_readonly("revises_past", &odometry::OdometryTraits::revises_past)
      .def_readonly("gravity_aligned", &odometry::OdometryTraits::gravity_aligned)
      .def_readonly("publishes_scans", &odometry::OdometryTraits::publishes_scans);
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

stages::RunResult run_events(odometry::Odometry& odometry, const py::object& given,
                             const std::string& lidar_id, const std::string& imu_id) {
  Events events(given);
  odometry::RunOptions options;
  options.lidar_id = lidar_id;
  options.imu_id = imu_id;
  const py::gil_scoped_release released;
  PythonLog log;
  return stages::record_run(odometry, events.source(), options, log);
}

}  // namespace

void bind_odometry(py::module_& m) {
  bind_results(m);
  py::class_<odometry::Odometry, PythonOdometry>(
      m, "Odometry", py::dynamic_attr(),
      "A LiDAR(-inertial) odometry. Derive from it and define track(scan) -> ScanResult, and "
      "where needed register_imu, finish, trajectory, map, registered_scan, memory, traits. "
      "Callers use register_scan, which refuses scans that are out of time order.")
      .def(py::init<>())
      .def("traits", &odometry::Odometry::traits)
      .def("register_imu", &odometry::Odometry::register_imu, py::arg("sample"),
           py::call_guard<py::gil_scoped_release>())
      .def("register_scan", &odometry::Odometry::register_scan, py::arg("scan"),
           py::call_guard<py::gil_scoped_release>())
      .def("finish", &odometry::Odometry::finish, py::call_guard<py::gil_scoped_release>())
      .def("trajectory", &odometry::Odometry::trajectory, "Best estimate of all poses so far.")
      .def_property_readonly("scans_refused", &odometry::Odometry::scans_refused,
                             "Scans that were not later than the one before")
      .def_property_readonly(
          "leveled_from_world",
          [](const odometry::Odometry& o) { return matrix_of(o.leveled_from_world()); },
          "4x4 rotation that levels the world by all that is known of up, after finish()")
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
  py::class_<stages::RunResult>(m, "RunResult", "Results of a run.")
      .def_property_readonly(
          "trajectory", [](const stages::RunResult& r) { return r.files.trajectory; },
          "Final trajectory, after finish()")
      .def_property_readonly(
          "live", [](const stages::RunResult& r) { return r.files.live; },
          "Poses as estimated right after each scan")
      .def_property_readonly(
          "map", [](const stages::RunResult& r) { return own_points(r.files.map.points); },
          "Map published by the method, (N, 3) float32")
      .def_property_readonly("summary",
                             [](const stages::RunResult& r) { return summary_of(r.summary); });
  m.def("run", &run_events, py::arg("odometry"), py::arg("events"), py::arg("lidar_id") = "",
        py::arg("imu_id") = "",
        "Runs an odometry on events: a Dataset, an EventSource, or an iterable of "
        "(sensor id, measurement).");
}

}  // namespace lidarena::python
