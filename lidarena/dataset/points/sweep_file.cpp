// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/points/sweep_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/firing_order.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::dataset {
namespace {

/// Float times beyond this are nanoseconds: as seconds they would be after the year 2286.
constexpr double kMaxSeconds = 1e10;

/// Reads times of points: absolute ns, or ns from the sweep's stamp.
class TimeReader {
 public:
  TimeReader(const PointTable& table, const Column& column) : table_(table), column_(column) {}

  bool absolute() const { return size_of(column_.type) == 8; }

  std::int64_t at(std::size_t row) const {
    if (is_integer(column_.type)) return table_.integer(column_, row);
    const double value = table_.number(column_, row);
    const bool in_ns = std::abs(value) > kMaxSeconds;
    if (!(std::abs(value) < (in_ns ? 9e18 : 9e9))) {
      throw InputError(table_.file, fmt::format("point {} has the time {}", row + 1, value),
                       "times are seconds or nanoseconds");
    }
    return in_ns ? std::llround(value) : seconds_to_ns(value);
  }

 private:
  /// Absolute seconds in a double have a resolution of 0.2 us; whole seconds are converted
  /// separately so that the multiplication loses no more.
  static std::int64_t seconds_to_ns(double seconds) {
    const double whole = std::floor(seconds);
    return static_cast<std::int64_t>(whole) * 1'000'000'000 + std::llround((seconds - whole) * 1e9);
  }

  const PointTable& table_;
  const Column& column_;
};

bool is_return(const Eigen::Vector3f& p) { return p.allFinite() && !p.isZero(0.0F); }

template <class T>
T small_integer(const PointTable& table, const Column& column, std::size_t row) {
  const double value = table.number(column, row);
  if (!(value >= 0.0 && value <= static_cast<double>(std::numeric_limits<T>::max()))) {
    throw InputError(table.file, fmt::format("point {} has the {} {}", row + 1, column.name, value),
                     fmt::format("it must be within 0 to {}", std::numeric_limits<T>::max()));
  }
  return static_cast<T>(value);
}

/// Sets the stamp of the scan and the offsets of its points, and sorts the points in firing order.
void set_times(Scan& scan, const std::vector<std::int64_t>& times, bool absolute,
               const std::string& file) {
  if (times.empty()) return;
  const auto [first, last] = std::minmax_element(times.begin(), times.end());
  const std::int64_t base = absolute ? 0 : scan.stamp.count();
  // relative times may begin after the given stamp (no returns yet) or, if the driver stamps the
  // end of the scan, before it
  const std::int64_t begin = absolute ? *first : std::min<std::int64_t>(*first, 0);
  std::int64_t stamp = 0;
  std::int64_t span = 0;
  if (__builtin_add_overflow(base, begin, &stamp) || __builtin_sub_overflow(*last, begin, &span) ||
      span > std::numeric_limits<std::int32_t>::max()) {
    throw InputError(file, "the times of its points span more than two seconds",
                     "64-bit times are absolute, others count from the sweep's stamp; integers are "
                     "ns, floats s");
  }
  scan.stamp = Time{stamp};
  for (std::size_t i = 0; i < times.size(); ++i) {
    scan.points[i].dt_ns = static_cast<std::int32_t>(times[i] - begin);
  }
  sort_in_firing_order(scan.points);
}

/// Raw little-endian float32 rows without a header.
PointTable read_raw_table(const std::filesystem::path& file, const std::string& layout) {
  const std::size_t stride = raw_point_size(layout);
  PointTable table{file.string(), read_bytes(file), 0, {}};
  if (table.bytes.size() % stride != 0) {
    throw InputError(table.file,
                     fmt::format("its {} bytes are not a whole number of {} points of {} bytes",
                                 table.bytes.size(), layout, stride),
                     fmt::format("choose one of the layouts {}", fmt::join(raw_layouts(), ", ")));
  }
  table.size = table.bytes.size() / stride;
  for (std::size_t i = 0; i < layout.size(); ++i) {
    const std::string name = layout[i] == 'i'   ? "intensity"
                             : layout[i] == 't' ? "time"
                             : layout[i] == 'r' ? "ring"
                                                : std::string(1, layout[i]);
    table.columns.push_back({name, ScalarType::kFloat32, i * sizeof(float), stride});
  }
  return table;
}

template <class T>
void append_value(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

std::string packed_rows(const Scan& scan) {
  std::string rows;
  for (const Point& point : scan.points) {
    for (int axis = 0; axis < 3; ++axis) append_value(rows, point.position[axis]);
    append_value(rows, point.intensity);
    if (scan.timed) append_value(rows, static_cast<std::uint32_t>(std::max(point.dt_ns, 0)));
    append_value(rows, point.ring);
    append_value(rows, point.echo);
  }
  return rows;
}

}  // namespace

std::vector<std::string> raw_layouts() { return {"xyz", "xyzi", "xyzt", "xyztr"}; }

std::size_t raw_point_size(const std::string& layout) {
  const auto known = raw_layouts();
  if (std::find(known.begin(), known.end(), layout) == known.end()) {
    throw InputError("layout", fmt::format("'{}' is not a layout of raw sweeps", layout),
                     fmt::format("choose one of {}", fmt::join(known, ", ")));
  }
  return layout.size() * sizeof(float);
}

Scan scan_from(const PointTable& table, Time stamp) {
  const Column& x = table.require("x");
  const Column& y = table.require("y");
  const Column& z = table.require("z");
  const Column* intensity = table.find({"intensity", "scalar_intensity", "i"});
  const Column* ring = table.find({"ring", "line", "channel"});
  const Column* echo = table.find({"echo"});
  const Column* time = table.find({"t", "time", "offset_time", "timestamp", "time_stamp"});
  Scan scan{stamp, {}, time != nullptr};
  std::vector<std::int64_t> times;
  for (std::size_t i = 0; i < table.size; ++i) {
    Point point;
    point.position =
        Eigen::Vector3d(table.number(x, i), table.number(y, i), table.number(z, i)).cast<float>();
    if (!is_return(point.position)) continue;
    if (intensity != nullptr) point.intensity = static_cast<float>(table.number(*intensity, i));
    if (ring != nullptr) point.ring = small_integer<std::uint16_t>(table, *ring, i);
    if (echo != nullptr) point.echo = small_integer<std::uint8_t>(table, *echo, i);
    if (time != nullptr) times.push_back(TimeReader(table, *time).at(i));
    scan.points.push_back(point);
  }
  if (time != nullptr) set_times(scan, times, TimeReader(table, *time).absolute(), table.file);
  return scan;
}

Scan starting_at(Scan scan, Time begin, const std::string& file) {
  std::int64_t shift = 0;
  const bool overflow = __builtin_sub_overflow(scan.stamp.count(), begin.count(), &shift);
  const std::int64_t last = (end_of(scan) - scan.stamp).count();
  if (overflow || shift < 0 || shift > std::numeric_limits<std::int32_t>::max() - last) {
    throw InputError(file,
                     fmt::format("its points begin at {} s, the scan at {} s",
                                 format_seconds(scan.stamp), format_seconds(begin)),
                     "points must lie within two seconds after the beginning of their scan");
  }
  scan.stamp = begin;
  for (Point& point : scan.points) point.dt_ns += static_cast<std::int32_t>(shift);
  return scan;
}

Scan read_sweep(const std::filesystem::path& file, Time stamp, const std::string& layout) {
  if (file.extension() == ".bin") return scan_from(read_raw_table(file, layout), stamp);
  return scan_from(read_point_table(file), stamp);
}

void write_sweep_ply(const std::filesystem::path& file, const Scan& scan) {
  write_text_file(file, fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
                                    "property float x\nproperty float y\nproperty float z\n"
                                    "property float intensity\n{}property ushort ring\n"
                                    "property uchar echo\nend_header\n",
                                    scan.points.size(), scan.timed ? "property uint t\n" : "") +
                            packed_rows(scan));
}

void write_sweep_pcd(const std::filesystem::path& file, const Scan& scan) {
  const bool timed = scan.timed;
  const std::size_t n = scan.points.size();
  write_text_file(
      file, fmt::format("VERSION 0.7\nFIELDS x y z intensity{} ring echo\nSIZE 4 4 4 4{} 2 1\n"
                        "TYPE F F F F{} U U\nCOUNT 1 1 1 1{} 1 1\nWIDTH {}\nHEIGHT 1\n"
                        "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA binary\n",
                        timed ? " t" : "", timed ? " 4" : "", timed ? " U" : "", timed ? " 1" : "",
                        n, n) +
                packed_rows(scan));
}

void write_sweep_bin(const std::filesystem::path& file, const Scan& scan) {
  std::string rows;
  for (const Point& point : scan.points) {
    for (int axis = 0; axis < 3; ++axis) append_value(rows, point.position[axis]);
    append_value(rows, point.intensity);
  }
  write_text_file(file, rows);
}

std::string sweep_file_name(Time stamp, std::string_view ending) {
  return fmt::format("{:019}{}", stamp.count(), ending);
}

}  // namespace lidarena::dataset
