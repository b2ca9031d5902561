// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/messages/driver_layouts.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/messages/point_cloud2.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/recording_source.hpp"

namespace lidarena::dataset {
namespace {

using ros::FieldType;
using ros::PointField;

bool is_first_generation(const LidarInfo& lidar) {
  return lidar.model != "livox_mid360" && lidar.model != "livox_hap";
}

std::uint8_t as_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 255.0F)));
}

/// Firing time of shot `index` of `count` in one scan, ns since the scan's stamp.
std::int64_t instant_of(std::int64_t index, std::int64_t count, double rate_hz) {
  return std::llround(static_cast<double>(index) / static_cast<double>(count) * 1e9 / rate_hz);
}

/// Index of the shot, among `count` equally spaced ones of a scan, that was fired at `dt_ns`; empty
/// if there is none.
std::optional<std::size_t> shot_at(std::int32_t dt_ns, std::int64_t count, double rate_hz) {
  const auto index =
      std::llround(static_cast<double>(dt_ns) * 1e-9 * rate_hz * static_cast<double>(count));
  if (index < 0 || index >= count) return std::nullopt;
  if (std::abs(instant_of(index, count, rate_hz) - dt_ns) > 1) return std::nullopt;
  return static_cast<std::size_t>(index);
}

void check_times(const Scan& scan, std::string_view place) {
  if (std::ranges::any_of(scan.points, [](const Point& point) { return point.dt_ns < 0; })) {
    throw InputError(place, "a point is earlier than its scan's stamp",
                     "set the stamp to the time of the first firing");
  }
}

/// One shot as a Livox driver publishes it.
struct LivoxShot {
  std::uint32_t offset_ns = 0;
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  std::uint8_t reflectivity = 0;
  std::uint8_t tag = 0;
  std::uint8_t line = 0;
};

LivoxShot livox_shot(const Point& point, std::uint8_t tag) {
  return {static_cast<std::uint32_t>(point.dt_ns), point.position, as_byte(point.intensity), tag,
          static_cast<std::uint8_t>(point.ring)};
}

/// All shots of a scan, those without a return as zeros; empty when the times of the points do not
/// match the shots.
std::vector<LivoxShot> all_shots(const Scan& scan, const LidarInfo& lidar, std::uint8_t tag) {
  const std::int64_t count = std::int64_t{lidar.rows} * lidar.columns;
  if (!scan.timed || count == 0) return {};
  std::vector<LivoxShot> shots(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < shots.size(); ++i) {
    shots[i].offset_ns =
        static_cast<std::uint32_t>(instant_of(static_cast<std::int64_t>(i), count, lidar.rate_hz));
    shots[i].tag = tag;
    shots[i].line = static_cast<std::uint8_t>(i % static_cast<std::size_t>(lidar.rows));
  }
  std::vector<bool> taken(shots.size(), false);
  for (const Point& point : scan.points) {
    const auto shot = shot_at(point.dt_ns, count, lidar.rate_hz);
    if (!shot || taken[*shot]) return {};
    taken[*shot] = true;
    shots[*shot] = livox_shot(point, tag);
  }
  return shots;
}

std::vector<LivoxShot> livox_shots(const Scan& scan, const LidarInfo& lidar,
                                   std::string_view place) {
  check_times(scan, place);
  constexpr std::uint8_t kFirstReturn = 0x10;
  const std::uint8_t tag = is_first_generation(lidar) ? kFirstReturn : std::uint8_t{0};
  std::vector<LivoxShot> shots = all_shots(scan, lidar, tag);
  if (!shots.empty()) return shots;
  for (const Point& point : scan.points) shots.push_back(livox_shot(point, tag));
  return shots;
}

template <class T>
void store(T value, std::byte* at) {
  std::memcpy(at, &value, sizeof value);
}

void store_position(const Eigen::Vector3f& position, std::byte* at) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    store(position[static_cast<int>(axis)], at + axis * sizeof(float));
  }
}

/// One pixel of an Ouster scan, with or without a return.
struct OusterPixel {
  const Point* point = nullptr;
  std::uint32_t t = 0;
  std::uint16_t ring = 0;
  std::uint16_t column = 0;  ///< column of its firing
};

struct OusterImage {
  std::size_t rows = 1;
  std::vector<OusterPixel> pixels;            ///< row by row
  std::vector<Eigen::Vector3d> beam_origins;  ///< m, by column; empty if columns are unknown
};

/// Origin (m) of the beams fired `t_ns` after the start of the scan: off the rotation axis, in the
/// direction in which the head then points.
Eigen::Vector3d ouster_beam_origin(std::int64_t t_ns, const LidarInfo& lidar) {
  const double revolutions = static_cast<double>(t_ns) * 1e-9 * lidar.rate_hz;
  const double encoder = 2.0 * M_PI * (1.0 - revolutions);
  return lidar.beam_origin_m * Eigen::Vector3d(std::cos(encoder), std::sin(encoder), 0.0);
}

bool has_geometry(const LidarInfo& lidar) {
  return lidar.rows > 0 && lidar.columns > 0 &&
         lidar.pixel_shifts.size() == static_cast<std::size_t>(lidar.rows);
}

/// The destaggered image of a scan without returns.
OusterImage empty_image(const LidarInfo& lidar) {
  OusterImage image{static_cast<std::size_t>(lidar.rows), {}, {}};
  std::vector<std::uint32_t> instants;
  for (int column = 0; column < lidar.columns; ++column) {
    const std::int64_t t = instant_of(column, lidar.columns, lidar.rate_hz);
    instants.push_back(static_cast<std::uint32_t>(t));
    image.beam_origins.push_back(ouster_beam_origin(t, lidar));
  }
  image.pixels.reserve(image.rows * instants.size());
  for (int row = 0; row < lidar.rows; ++row) {
    for (int pixel = 0; pixel < lidar.columns; ++pixel) {
      const int shifted = pixel - lidar.pixel_shifts[static_cast<std::size_t>(row)];
      const int column = (shifted % lidar.columns + lidar.columns) % lidar.columns;
      image.pixels.push_back({nullptr, instants[static_cast<std::size_t>(column)],
                              static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(column)});
    }
  }
  return image;
}

/// The destaggered image of a scan; empty when the time or ring of a point does not match the
/// sensor.
std::optional<OusterImage> destaggered(const Scan& scan, const LidarInfo& lidar) {
  if (!scan.timed || !has_geometry(lidar)) return std::nullopt;
  OusterImage image = empty_image(lidar);
  const auto columns = static_cast<std::size_t>(lidar.columns);
  std::optional<std::size_t> column;
  std::int32_t column_dt = -1;
  for (const Point& point : scan.points) {
    if (point.dt_ns != column_dt) {  // points of one column are consecutive
      column = shot_at(point.dt_ns, lidar.columns, lidar.rate_hz);
      column_dt = point.dt_ns;
    }
    if (!column || point.ring >= image.rows) return std::nullopt;
    const int shifted = static_cast<int>(*column) + lidar.pixel_shifts[point.ring];
    const int pixel = (shifted % lidar.columns + lidar.columns) % lidar.columns;
    OusterPixel& place = image.pixels[point.ring * columns + static_cast<std::size_t>(pixel)];
    if (place.point == nullptr) place.point = &point;
  }
  return image;
}

OusterImage in_one_row(const Scan& scan) {
  OusterImage image;
  for (const Point& point : scan.points) {
    image.pixels.push_back({&point, static_cast<std::uint32_t>(point.dt_ns), point.ring, 0});
  }
  return image;
}

/// Range as the sensor defines it, mm: distance from the beam's origin to the point, plus the
/// distance of the origin from the axis.
std::uint32_t ouster_range_mm(const OusterPixel& pixel, const OusterImage& image,
                              const LidarInfo& lidar) {
  const Eigen::Vector3d origin = image.beam_origins.empty()
                                     ? ouster_beam_origin(pixel.point->dt_ns, lidar)
                                     : image.beam_origins[pixel.column];
  const double range = (pixel.point->position.cast<double>() - origin).norm();
  return static_cast<std::uint32_t>(1e3 * (range + lidar.beam_origin_m) + 0.5);
}

const std::vector<PointField>& ouster_fields() {
  static const std::vector<PointField> kFields{
      {"x", 0, FieldType::kFloat32},    {"y", 4, FieldType::kFloat32},
      {"z", 8, FieldType::kFloat32},    {"intensity", 16, FieldType::kFloat32},
      {"t", 20, FieldType::kUint32},    {"reflectivity", 24, FieldType::kUint16},
      {"ring", 26, FieldType::kUint16}, {"ambient", 28, FieldType::kUint16},
      {"range", 32, FieldType::kUint32}};
  return kFields;
}

void store_pixel(const OusterPixel& pixel, const OusterImage& image, const LidarInfo& lidar,
                 std::byte* at) {
  store(pixel.t, at + 20);
  store(pixel.ring, at + 26);
  if (pixel.point == nullptr) {
    store_position(Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()), at);
    return;
  }
  const Point& point = *pixel.point;
  store_position(point.position, at);
  store(point.intensity, at + 16);
  store(static_cast<std::uint32_t>(point.dt_ns), at + 20);
  store(std::uint16_t{as_byte(point.intensity)}, at + 24);
  store(ouster_range_mm(pixel, image, lidar), at + 32);
}

}  // namespace

Driver driver_of(const LidarInfo& lidar) {
  if (lidar.model.starts_with("livox_")) return Driver::kLivox;
  if (lidar.model.starts_with("ouster_")) return Driver::kOuster;
  return Driver::kUnknown;
}

std::string_view livox_type(const LidarInfo& lidar, Encoding encoding) {
  const bool is_old = encoding == Encoding::kRos1 && is_first_generation(lidar);
  return is_old ? "livox_ros_driver/msg/CustomMsg" : "livox_ros_driver2/msg/CustomMsg";
}

void encode_livox_custom(const Scan& scan, const LidarInfo& lidar, std::string_view frame_id,
                         MessageWriter& out) {
  const std::vector<LivoxShot> shots = livox_shots(scan, lidar, frame_id);
  out.clear();
  ros::put_header(scan.stamp, frame_id, out);
  out.put(static_cast<std::uint64_t>(scan.stamp.count()));  // timebase
  out.put(static_cast<std::uint32_t>(shots.size()));
  for (int i = 0; i < 4; ++i) out.put(std::uint8_t{0});  // lidar_id, rsvd[3]
  out.put(static_cast<std::uint32_t>(shots.size()));
  for (const LivoxShot& shot : shots) {
    out.put(shot.offset_ns);
    for (const float value : {shot.position.x(), shot.position.y(), shot.position.z()}) {
      out.put(value);
    }
    for (const std::uint8_t value : {shot.reflectivity, shot.tag, shot.line}) out.put(value);
  }
}

void encode_livox_cloud(const Scan& scan, const LidarInfo& lidar, std::string_view frame_id,
                        MessageWriter& out) {
  const std::vector<LivoxShot> shots = livox_shots(scan, lidar, frame_id);
  std::vector<PointField> fields{
      {"x", 0, FieldType::kFloat32},  {"y", 4, FieldType::kFloat32},
      {"z", 8, FieldType::kFloat32},  {"intensity", 12, FieldType::kFloat32},
      {"tag", 16, FieldType::kUint8}, {"line", 17, FieldType::kUint8}};
  const bool timed = !is_first_generation(lidar);
  if (timed) fields.push_back({"timestamp", 18, FieldType::kFloat64});
  const std::size_t step = timed ? 26 : 18;
  out.clear();
  ros::put_header(scan.stamp, frame_id, out);
  std::byte* at = ros::put_layout(1, shots.size(), step, fields, out).data();
  for (const LivoxShot& shot : shots) {
    store_position(shot.position, at);
    store(static_cast<float>(shot.reflectivity), at + 12);
    store(shot.tag, at + 16);
    store(shot.line, at + 17);
    if (timed) store(static_cast<double>(scan.stamp.count() + shot.offset_ns), at + 18);
    at += step;
  }
  out.put(std::uint8_t{1});  // is_dense
}

void encode_ouster_cloud(const Scan& scan, const LidarInfo& lidar, std::string_view frame_id,
                         MessageWriter& out) {
  check_times(scan, frame_id);
  const OusterImage image = destaggered(scan, lidar).value_or(in_one_row(scan));
  constexpr std::size_t kStep = 48;
  out.clear();
  ros::put_header(scan.stamp, frame_id, out);
  std::byte* at =
      ros::put_layout(image.rows, image.pixels.size() / image.rows, kStep, ouster_fields(), out)
          .data();
  bool is_dense = true;
  for (const OusterPixel& pixel : image.pixels) {
    store_pixel(pixel, image, lidar, at);
    is_dense = is_dense && pixel.point != nullptr;
    at += kStep;
  }
  out.put(static_cast<std::uint8_t>(is_dense));
}

void encode_driver_imu(const ImuSample& sample, Driver driver, std::string_view frame_id,
                       MessageWriter& out) {
  if (driver == Driver::kLivox) {
    const ImuSample in_g{sample.stamp, sample.gyro, sample.accel / kStandardGravity};
    ros::encode_imu(in_g, frame_id, out, {.orientation = 0.0});
  } else if (driver == Driver::kOuster) {
    ros::encode_imu(sample, frame_id, out, {.angular_velocity = 6e-4, .acceleration = 0.01});
  } else {
    ros::encode_imu(sample, frame_id, out);
  }
}

}  // namespace lidarena::dataset
