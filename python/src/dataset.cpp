// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/dataset.hpp"

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/points/cloud.hpp"
#include "lidarena/stages/simulate_dataset.hpp"
#include "python/src/events.hpp"

namespace lidarena::python {
namespace {

namespace fs = std::filesystem;

std::variant<ImuSample, Scan> measurement_of(const py::handle& data) {
  if (py::isinstance<ImuSample>(data)) return data.cast<ImuSample>();
  if (py::isinstance<Scan>(data)) return data.cast<Scan>();
  throw InputError("event", "is neither a Scan nor an ImuSample");
}

/// Any Python iterable of (sensor id, measurement).
class IterableSource : public EventSource {
 public:
  explicit IterableSource(const py::object& iterable) : rows_(py::iter(iterable)) {}
  std::optional<Event> next() override {
    const py::gil_scoped_acquire gil;
    if (rows_ == py::iterator::sentinel()) return std::nullopt;
    const auto row = rows_->cast<std::pair<std::string, py::object>>();
    Event event{row.first, measurement_of(row.second)};
    ++rows_;
    return event;
  }

 private:
  py::iterator rows_;
};

dataset::WriteOptions write_options(const std::string& format, const std::string& dialect) {
  dataset::WriteOptions options;
  read_value(ConfigNode::parse(format, "format"), options.format, {});
  read_value(ConfigNode::parse(dialect, "dialect"), options.dialect, {});
  return options;
}

void bind_writer(py::module_& m) {
  py::class_<dataset::DatasetWriter>(
      m, "DatasetWriter",
      "Writes a dataset folder, or a single .mcap or .bag; valid only after "
      "finish(). A context manager that calls finish() if nothing was raised.")
      .def(py::init([](const fs::path& path, const Rig& rig, const std::string& format,
                       const std::string& dialect) {
             return std::make_unique<dataset::DatasetWriter>(path, rig,
                                                             write_options(format, dialect));
           }),
           py::arg("path"), py::arg("rig"), py::arg("format") = "mcap", py::arg("dialect") = "si")
      .def(
          "write",
          [](dataset::DatasetWriter& w, const std::string& id, const py::object& data) {
            w.write(Event{id, measurement_of(data)});
          },
          py::arg("sensor_id"), py::arg("data"),
          "Writes a measurement, in order of time; a scan after its IMU samples.")
      .def(
          "write_truth",
          [](dataset::DatasetWriter& w, std::int64_t stamp, const Eigen::Matrix4d& pose) {
            w.write_truth({Time{stamp}, pose_of(pose)});
          },
          py::arg("stamp"), py::arg("pose"), "Writes a true pose of the body, in order of time.")
      .def("finish", &dataset::DatasetWriter::close)
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__", [](dataset::DatasetWriter& w, const py::object& type, const py::object&,
                          const py::object&) {
        if (type.is_none()) w.close();
      });
}

py::dict simulate_to(const fs::path& world, const fs::path& flight,
                     const std::vector<fs::path>& sensors, const fs::path& out, std::uint64_t seed,
                     double seconds, bool noise, const std::string& mode, bool truth, bool data,
                     const std::string& format, const std::string& dialect, int threads,
                     const fs::path& shipped_sensors) {
  stages::SimulateRequest request;
  request.shipped_sensors = shipped_sensors;
  request.world = world;
  request.flight = flight;
  request.sensors = sensors;
  request.seed = seed;
  request.seconds = seconds;
  request.noise = noise;
  request.data = data;
  request.truth = truth;
  request.write = write_options(format, dialect);
  if (!mode.empty()) {
    sensor::ScanMode read{};
    read_value(ConfigNode::parse(mode, "mode"), read, {});
    request.mode = read;
  }
  stages::SimulateSummary done;
  {
    const py::gil_scoped_release released;
    PythonLog log;
    done = stages::simulate_dataset(request, out, Parallel(threads), log);
  }
  using namespace py::literals;
  return py::dict("triangles"_a = done.triangles, "scans"_a = done.scans, "points"_a = done.points,
                  "imu_samples"_a = done.imu_samples, "seconds"_a = done.seconds,
                  "path_m"_a = done.path_m);
}

}  // namespace

py::tuple next_event(EventSource& source) {
  std::optional<Event> event;
  {
    const py::gil_scoped_release released;
    event = source.next();
  }
  if (!event) throw py::stop_iteration();
  py::object data = std::visit(
      [](auto& value) {
        using T = std::decay_t<decltype(value)>;
        return py::cast(std::make_unique<T>(std::move(value)));
      },
      event->data);
  return py::make_tuple(event->sensor_id, data);
}

Events::Events(const py::object& given) : source_(nullptr) {
  if (py::isinstance<EventSource>(given)) {
    source_ = &given.cast<EventSource&>();
  } else if (py::isinstance<dataset::Dataset>(given)) {
    source_ = given.cast<dataset::Dataset&>().events.get();
  } else {
    adapter_ = std::make_unique<IterableSource>(given);
    source_ = adapter_.get();
  }
}

void bind_dataset(py::module_& m) {
  py::class_<EventSource>(m, "EventSource", "Measurements in order; can be iterated over once.")
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", &next_event);
  py::class_<dataset::Dataset>(
      m, "Dataset", "The data that an estimator gets; its events can be iterated over once.")
      .def_property_readonly("path", [](const dataset::Dataset& d) { return d.path; })
      .def_property_readonly("rig", [](const dataset::Dataset& d) { return d.rig; })
      .def_property_readonly("scan_count", [](const dataset::Dataset& d) { return d.scan_count; })
      .def_property_readonly("manifest",
                             [](const dataset::Dataset& d) { return to_python(d.manifest); })
      .def_property_readonly("notes", [](const dataset::Dataset& d) { return d.notes; })
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", [](dataset::Dataset& d) { return next_event(*d.events); });
  m.def(
      "open_dataset",
      [](const fs::path& path, const std::string& sensor, const std::string& layout, double rate_hz,
         int threads) {
        dataset::ReadOptions options;
        options.sensor = sensor;
        options.layout = layout;
        options.rate_hz = rate_hz;
        const py::gil_scoped_release released;
        return stages::open_any_dataset(path, options, Parallel(threads));
      },
      py::arg("path"), py::arg("sensor") = "", py::arg("layout") = "", py::arg("rate_hz") = 10.0,
      py::arg("threads") = 0, "Opens a dataset folder, .mcap, .bag, or a folder of sweeps.");
  m.def("load_truth", &dataset::load_truth, py::arg("dataset"),
        "True motion of the body, or None; for evaluation.");
  m.def("simulate_dataset_files", &simulate_to, py::arg("world"), py::arg("flight"),
        py::arg("sensors"), py::arg("out"), py::arg("seed") = 1, py::arg("seconds") = 0.0,
        py::arg("noise") = true, py::arg("mode") = "", py::arg("truth") = false,
        py::arg("data") = true, py::arg("format") = "mcap", py::arg("dialect") = "si",
        py::arg("threads") = 0, py::arg("shipped_sensors") = "");
  bind_writer(m);
  m.def(
      "read_cloud",
      [](const fs::path& file) { return own_points(dataset::read_cloud(file).points); },
      py::arg("file"), "Positions (N, 3) float32 of a .ply or .pcd.");
  m.def(
      "write_cloud",
      [](const fs::path& file, const Array3f& points) {
        const auto rows = rows_of(points, "points");
        dataset::Cloud cloud;
        cloud.points.assign(rows.begin(), rows.end());
        if (file.extension() == ".pcd") {
          dataset::write_pcd(file, cloud);
        } else if (file.extension() == ".ply") {
          dataset::write_ply(file, cloud);
        } else {
          throw InputError(file.string(), "has an unknown file extension", "use .ply or .pcd");
        }
      },
      py::arg("file"), py::arg("points"), "Writes positions as .ply or .pcd.");
}

}  // namespace lidarena::python
