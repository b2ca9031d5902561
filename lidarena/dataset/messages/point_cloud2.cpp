// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/messages/point_cloud2.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <tuple>
#include <utility>

#include "lidarena/base/error.hpp"

namespace lidarena::dataset::ros {
namespace {

/// Memory layout of Point. Its last byte is padding, written as 0.
const std::vector<PointField>& own_fields(bool timed) {
  static_assert(offsetof(Point, intensity) == 12 && offsetof(Point, dt_ns) == 16 &&
                offsetof(Point, ring) == 20 && offsetof(Point, echo) == 22);
  static const std::vector<PointField> kTimed{
      {"x", 0, FieldType::kFloat32},  {"y", 4, FieldType::kFloat32},
      {"z", 8, FieldType::kFloat32},  {"intensity", 12, FieldType::kFloat32},
      {"t", 16, FieldType::kUint32},  {"ring", 20, FieldType::kUint16},
      {"echo", 22, FieldType::kUint8}};
  static const std::vector<PointField> kUntimed{
      {"x", 0, FieldType::kFloat32},    {"y", 4, FieldType::kFloat32},
      {"z", 8, FieldType::kFloat32},    {"intensity", 12, FieldType::kFloat32},
      {"ring", 20, FieldType::kUint16}, {"echo", 22, FieldType::kUint8}};
  return timed ? kTimed : kUntimed;
}
constexpr std::size_t kPaddingOffset = 23;

std::size_t size_of(FieldType type) {
  constexpr std::array<std::size_t, 9> kSizes{0, 1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

bool is_float(FieldType type) { return type == FieldType::kFloat32 || type == FieldType::kFloat64; }

/// Points that are decoded together, so that each is read from memory once.
constexpr std::size_t kBlock = 512;
template <class Value>
using Column = std::array<Value, kBlock>;

template <class Stored, class Value>
void load(const std::byte* at, std::size_t step, std::span<Value> values) {
  for (Value& value : values) {
    Stored stored;
    std::memcpy(&stored, at, sizeof stored);
    value = static_cast<Value>(stored);
    at += step;
  }
}

/// Values of a field of the points from `first` on. Zeros if there is no such field.
template <class Value>
void load_column(const PointCloud2& cloud, const PointField* field, std::size_t first,
                 std::span<Value> values) {
  if (field == nullptr) {
    std::ranges::fill(values, Value{0});
    return;
  }
  const std::byte* at = cloud.data.data() + first * cloud.point_step + field->offset;
  switch (field->type) {
    case FieldType::kInt8:
      return load<std::int8_t>(at, cloud.point_step, values);
    case FieldType::kUint8:
      return load<std::uint8_t>(at, cloud.point_step, values);
    case FieldType::kInt16:
      return load<std::int16_t>(at, cloud.point_step, values);
    case FieldType::kUint16:
      return load<std::uint16_t>(at, cloud.point_step, values);
    case FieldType::kInt32:
      return load<std::int32_t>(at, cloud.point_step, values);
    case FieldType::kUint32:
      return load<std::uint32_t>(at, cloud.point_step, values);
    case FieldType::kFloat32:
      return load<float>(at, cloud.point_step, values);
    case FieldType::kFloat64:
      return load<double>(at, cloud.point_step, values);
  }
}

/// The field with the first of `names` that exists; nullptr if none does.
const PointField* find(const PointCloud2& cloud, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    for (const PointField& field : cloud.fields) {
      if (field.name == name) return &field;
    }
  }
  return nullptr;
}

/// The field of times; another name that holds "time" is used only where the usual ones lack.
const PointField* find_times(const PointCloud2& cloud) {
  if (const auto* usual = find(cloud, {"t", "offset_time", "time", "timestamp", "time_stamp"}))
    return usual;
  const auto named = std::ranges::find_if(
      cloud.fields, [](const PointField& field) { return is_time_name(field.name); });
  return named == cloud.fields.end() ? nullptr : &*named;
}

std::string list_of_fields(const PointCloud2& cloud) {
  std::string names;
  for (const PointField& field : cloud.fields) names += (names.empty() ? "" : " ") + field.name;
  return names.empty() ? "none" : names;
}

/// Reads the layout that put_cloud() writes.
Scan own_scan(Time stamp, const PointCloud2& cloud, bool timed) {
  Scan scan{stamp, std::vector<Point>(std::size_t{cloud.width} * cloud.height), timed};
  if (!scan.points.empty()) {
    std::memcpy(static_cast<void*>(scan.points.data()), cloud.data.data(), cloud.data.size());
  }
  return scan;
}

/// The range of the values of a sweep's time field. Values of a counter of 32 bits that wraps
/// within the sweep are replaced: those before the wrap are negative.
SweepTimes range_of(const PointField& field, Time stamp, std::vector<double>& values) {
  const auto [low, high] = std::ranges::minmax(values);
  SweepTimes range{field.name, is_float(field.type), stamp, low, high};
  constexpr double kHalf = 2147483648.0;
  if (field.type != FieldType::kUint32 || high - low <= kHalf) return range;
  for (double& value : values) value -= value >= kHalf ? 2.0 * kHalf : 0.0;
  std::tie(range.low, range.high) = std::pair(std::ranges::min(values), std::ranges::max(values));
  return range;
}

std::uint16_t as_ring(float value) {
  constexpr float kLast = std::numeric_limits<std::uint16_t>::max();
  return value >= 0.0 && value <= kLast ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
}

/// The fields of a cloud from which points are made; nullptr where there is none.
struct PointFields {
  std::array<const PointField*, 3> position;
  const PointField* intensity;
  const PointField* ring;
  const PointField* time;
};

PointFields fields_of(const PointCloud2& cloud, std::string_view place) {
  const std::array position{find(cloud, {"x"}), find(cloud, {"y"}), find(cloud, {"z"})};
  for (const PointField* axis : position) {
    if (axis != nullptr && is_float(axis->type)) continue;
    throw InputError(
        place,
        "a cloud needs fields x, y, z of float32 or float64; it has: " + list_of_fields(cloud),
        "name another topic");
  }
  return {position, find(cloud, {"intensity", "reflectivity", "signal"}),
          find(cloud, {"ring", "line", "channel"}), find_times(cloud)};
}

/// A driver writes zeros or NaN where nothing came back. A difference of a float to itself is 0 if
/// it is finite, else NaN.
bool is_return(float x, float y, float z) {
  const bool is_finite = (x - x) + (y - y) + (z - z) == 0.0F;
  const bool is_zero = std::abs(x) + std::abs(y) + std::abs(z) == 0.0F;
  return is_finite & !is_zero;
}

/// Reads the returns into `points`, without times, and the values of their time field.
void read_returns(const PointCloud2& cloud, const PointFields& fields, std::vector<Point>& points,
                  std::vector<double>& times) {
  const std::size_t count = std::size_t{cloud.width} * cloud.height;
  points.clear();
  points.reserve(count);
  times.clear();
  times.reserve(count);
  Column<float> x, y, z, intensity, ring;
  Column<double> time;
  Column<Point> returns;
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t size = std::min(kBlock, count - first);
    const auto load = [&](const PointField* field, auto& column) {
      load_column(cloud, field, first, std::span(column).first(size));
    };
    load(fields.position[0], x);
    load(fields.position[1], y);
    load(fields.position[2], z);
    load(fields.intensity, intensity);
    load(fields.ring, ring);
    load(fields.time, time);
    std::size_t kept = 0;  // without a branch: which pixels have a return cannot be predicted
    for (std::size_t i = 0; i < size; ++i) {
      returns[kept] = {{x[i], y[i], z[i]}, intensity[i], 0, as_ring(ring[i]), 0};
      time[kept] = time[i];
      kept += is_return(x[i], y[i], z[i]) ? 1 : 0;
    }
    points.insert(points.end(), returns.begin(), returns.begin() + kept);
    times.insert(times.end(), time.begin(), time.begin() + kept);
  }
}

/// Leaves out the points whose time is not finite; returns their number.
std::size_t drop_undated(std::vector<Point>& points, std::vector<double>& times) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i])) continue;
    points[kept] = points[i];
    times[kept++] = times[i];
  }
  const std::size_t dropped = times.size() - kept;
  points.resize(kept);
  times.resize(kept);
  return dropped;
}

/// Kept from sweep to sweep, because new memory costs more.
std::vector<double>& time_buffer() {
  static thread_local std::vector<double> times;
  return times;
}

const std::vector<PointField>& truth_fields() {
  static_assert(offsetof(PointTruth, range) == 12 && offsetof(PointTruth, normal) == 16 &&
                offsetof(PointTruth, triangle) == 28);
  static const std::vector<PointField> kFields{
      {"x", 0, FieldType::kFloat32},   {"y", 4, FieldType::kFloat32},
      {"z", 8, FieldType::kFloat32},   {"range", 12, FieldType::kFloat32},
      {"nx", 16, FieldType::kFloat32}, {"ny", 20, FieldType::kFloat32},
      {"nz", 24, FieldType::kFloat32}, {"triangle", 28, FieldType::kUint32}};
  return kFields;
}

}  // namespace

std::span<std::byte> put_layout(std::size_t height, std::size_t width, std::size_t step,
                                const std::vector<PointField>& fields, MessageWriter& out) {
  out.put(static_cast<std::uint32_t>(height));
  out.put(static_cast<std::uint32_t>(width));
  out.put(static_cast<std::uint32_t>(fields.size()));
  for (const PointField& field : fields) {
    out.put(std::string_view(field.name));
    out.put(field.offset);
    out.put(static_cast<std::uint8_t>(field.type));
    out.put(std::uint32_t{1});  // count
  }
  out.put(std::uint8_t{0});  // is_bigendian
  out.put(static_cast<std::uint32_t>(step));
  out.put(static_cast<std::uint32_t>(step * width));
  return out.put_octets(step * width * height);
}

void put_cloud(const Scan& scan, std::string_view place, MessageWriter& out) {
  if (std::ranges::any_of(scan.points, [](const Point& point) { return point.dt_ns < 0; })) {
    throw InputError(place, "a point is earlier than its scan's stamp",
                     "set the stamp to the time of the first firing");
  }
  const std::span<std::byte> data =
      put_layout(1, scan.points.size(), sizeof(Point), own_fields(scan.timed), out);
  if (!data.empty()) std::memcpy(data.data(), scan.points.data(), data.size());
  for (std::size_t at = kPaddingOffset; at < data.size(); at += sizeof(Point))
    data[at] = std::byte{0};
  out.put(std::uint8_t{1});  // is_dense: no point is invalid
}

void put_truth_cloud(const std::vector<PointTruth>& points, MessageWriter& out) {
  const std::span<std::byte> data =
      put_layout(1, points.size(), sizeof(PointTruth), truth_fields(), out);
  if (!data.empty()) std::memcpy(data.data(), points.data(), data.size());
  out.put(std::uint8_t{1});  // is_dense
}

std::vector<PointTruth> truth_from_cloud(const PointCloud2& cloud, std::string_view place) {
  if (cloud.point_step != sizeof(PointTruth) || cloud.fields != truth_fields()) {
    throw InputError(place,
                     "is not a cloud of ground-truth points; it has: " + list_of_fields(cloud),
                     "the fields must be x y z range nx ny nz triangle");
  }
  std::vector<PointTruth> points(std::size_t{cloud.width} * cloud.height);
  if (!points.empty()) {
    std::memcpy(static_cast<void*>(points.data()), cloud.data.data(), cloud.data.size());
  }
  return points;
}

namespace {

/// Where rows are longer than their points, copies the points one row after the other.
void without_row_padding(PointCloud2& cloud) {
  const std::uint64_t used = std::uint64_t{cloud.width} * cloud.point_step;
  const bool is_padded = cloud.height > 0 && used > 0 && cloud.row_step > used &&
                         cloud.data.size() / cloud.height == cloud.row_step &&
                         cloud.data.size() % cloud.height == 0;
  if (!is_padded) return;
  cloud.unpadded.reserve(used * cloud.height);
  for (std::size_t row = 0; row < cloud.height; ++row) {
    const Bytes points = cloud.data.subspan(row * cloud.row_step, used);
    cloud.unpadded.insert(cloud.unpadded.end(), points.begin(), points.end());
  }
  cloud.data = cloud.unpadded;
}

}  // namespace

PointCloud2 get_cloud(MessageReader& in, std::string_view place) {
  PointCloud2 cloud;
  cloud.height = in.get<std::uint32_t>();
  cloud.width = in.get<std::uint32_t>();
  constexpr std::size_t kMinFieldBytes = 13;
  cloud.fields.resize(in.get_length(kMinFieldBytes));
  for (PointField& field : cloud.fields) {
    field.name = in.get_string();
    field.offset = in.get<std::uint32_t>();
    field.type = static_cast<FieldType>(in.get<std::uint8_t>());
    in.get<std::uint32_t>();  // count: only the first element is used
  }
  const bool is_big_endian = in.get<std::uint8_t>() != 0;
  cloud.point_step = in.get<std::uint32_t>();
  cloud.row_step = in.get<std::uint32_t>();
  cloud.data = in.get_octets();
  if (is_big_endian)
    throw InputError(place, "its points are big endian", "record them as little endian");
  for (const PointField& field : cloud.fields) {
    const bool known = field.type >= FieldType::kInt8 && field.type <= FieldType::kFloat64;
    if (!known || std::uint64_t{field.offset} + size_of(field.type) > cloud.point_step) {
      throw InputError(place,
                       fmt::format("field '{}' of a cloud does not fit into its points of {} "
                                   "bytes",
                                   field.name, cloud.point_step));
    }
  }
  const std::uint64_t rows = std::uint64_t{cloud.height} * cloud.width;
  without_row_padding(cloud);
  // Divided, not multiplied: the product of three damaged numbers may overflow.
  const bool fits = rows == 0 ? cloud.data.empty()
                              : cloud.point_step > 0 && cloud.data.size() % rows == 0 &&
                                    cloud.data.size() / rows == cloud.point_step;
  if (!fits) {
    throw InputError(place,
                     fmt::format("a cloud of {} x {} points of {} bytes has {} bytes of data",
                                 cloud.height, cloud.width, cloud.point_step, cloud.data.size()));
  }
  return cloud;
}

Scan scan_from_cloud(Time header_stamp, const PointCloud2& cloud, std::string_view place) {
  if (cloud.point_step == sizeof(Point)) {
    if (cloud.fields == own_fields(true)) return own_scan(header_stamp, cloud, true);
    if (cloud.fields == own_fields(false)) return own_scan(header_stamp, cloud, false);
  }
  const PointFields fields = fields_of(cloud, place);
  Scan scan{header_stamp, {}, false};
  std::vector<double>& times = time_buffer();
  read_returns(cloud, fields, scan.points, times);
  if (fields.time == nullptr || times.empty()) return scan;
  if (!std::ranges::all_of(times, [](double value) { return std::isfinite(value); })) {
    throw InputError(place, fmt::format("field '{}' of a return is not finite", fields.time->name));
  }
  const SweepTimes sweep = range_of(*fields.time, header_stamp, times);
  scan.timed = sweep.low != 0.0 || sweep.high != 0.0;
  if (scan.timed) set_point_times(scan, times, sweep, guess_point_times(sweep, place), place);
  return scan;
}

Scan scan_from_cloud(Time header_stamp, const PointCloud2& cloud, std::string_view place,
                     const PointTimes& rule, TimeFaults& faults) {
  PointFields fields = fields_of(cloud, place);
  if (rule.field.empty() || fields.time == nullptr || fields.time->name != rule.field)
    fields.time = nullptr;
  Scan scan{header_stamp, {}, false};
  std::vector<double>& times = time_buffer();
  read_returns(cloud, fields, scan.points, times);
  if (fields.time == nullptr) return scan;
  faults.undated_points = drop_undated(scan.points, times);
  if (times.empty()) return scan;
  const SweepTimes sweep = range_of(*fields.time, header_stamp, times);
  scan.timed = are_plausible(sweep, rule, times.size());
  faults.implausible = !scan.timed;
  if (scan.timed) set_point_times(scan, times, sweep, rule, place);
  return scan;
}

SweepTimes times_in(Time header_stamp, const PointCloud2& cloud, std::string_view place) {
  const PointFields fields = fields_of(cloud, place);
  if (fields.time == nullptr) return {{}, false, header_stamp};
  std::vector<Point> points;
  std::vector<double>& times = time_buffer();
  read_returns(cloud, fields, points, times);
  drop_undated(points, times);
  if (times.empty()) return {fields.time->name, is_float(fields.time->type), header_stamp};
  return range_of(*fields.time, header_stamp, times);
}

bool has_rings(const PointCloud2& cloud) {
  return find(cloud, {"ring", "line", "channel"}) != nullptr;
}

}  // namespace lidarena::dataset::ros
