// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/points/cloud.hpp"

#include <fmt/format.h>

#include <cassert>
#include <string>

#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/points/point_table.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::dataset {
namespace {

void append_float(std::string& bytes, float value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// Whether coordinates are written as double.
bool is_far(const Cloud& cloud) { return !cloud.origin.isZero(0.0); }

void append_position(std::string& bytes, const Cloud& cloud, std::size_t i) {
  if (is_far(cloud)) {
    const Eigen::Vector3d p = cloud.origin + cloud.points[i].cast<double>();
    bytes.append(reinterpret_cast<const char*>(p.data()), 3 * sizeof(double));
  } else {
    for (int axis = 0; axis < 3; ++axis) append_float(bytes, cloud.points[i][axis]);
  }
}

/// Writes a file of `header` and one binary float32 row x y z [intensity] [distance] per point.
void write_rows(const std::filesystem::path& file, const Cloud& cloud, std::string_view header) {
  assert(cloud.intensity.empty() || cloud.intensity.size() == cloud.points.size());
  assert(cloud.distance.empty() || cloud.distance.size() == cloud.points.size());
  PartFile out(file);
  out.write(header);
  constexpr std::size_t kBlock = 1 << 16;  // bytes per write
  std::string rows;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    append_position(rows, cloud, i);
    if (!cloud.intensity.empty()) append_float(rows, cloud.intensity[i]);
    if (!cloud.distance.empty()) append_float(rows, cloud.distance[i]);
    if (rows.size() < kBlock) continue;
    out.write(rows);
    rows.clear();
  }
  out.write(rows);
  out.commit();
}

/// The first finite point, in whole meters, if it is far from the origin; else the origin.
template <class PointAt>
Eigen::Vector3d origin_of(std::size_t size, const PointAt& point) {
  constexpr double kFar = 1e4;  // m; float has a resolution of 1 mm there
  for (std::size_t i = 0; i < size; ++i) {
    const Eigen::Vector3d p = point(i);
    if (!p.allFinite()) continue;
    return p.norm() > kFar ? Eigen::Vector3d(p.array().round()) : Eigen::Vector3d::Zero();
  }
  return Eigen::Vector3d::Zero();
}

}  // namespace

Cloud read_cloud(const std::filesystem::path& file, bool keep_origin) {
  const PointTable table = read_point_table(file);
  const Column& x = table.require("x");
  const Column& y = table.require("y");
  const Column& z = table.require("z");
  const Column* intensity = table.find({"intensity", "scalar_intensity"});
  const Column* distance = table.find({"distance", "scalar_distance"});
  Cloud cloud;
  cloud.points.reserve(table.size);
  if (intensity != nullptr) cloud.intensity.reserve(table.size);
  if (distance != nullptr) cloud.distance.reserve(table.size);
  const auto point = [&](std::size_t i) {
    return Eigen::Vector3d(table.number(x, i), table.number(y, i), table.number(z, i));
  };
  if (keep_origin) cloud.origin = origin_of(table.size, point);
  for (std::size_t i = 0; i < table.size; ++i) {
    cloud.points.push_back((point(i) - cloud.origin).cast<float>());
    if (intensity != nullptr) {
      cloud.intensity.push_back(static_cast<float>(table.number(*intensity, i)));
    }
    if (distance != nullptr) {
      cloud.distance.push_back(static_cast<float>(table.number(*distance, i)));
    }
  }
  return cloud;
}

void write_ply(const std::filesystem::path& file, const Cloud& cloud) {
  const char* type = is_far(cloud) ? "double" : "float";
  std::string fields = fmt::format("property {0} x\nproperty {0} y\nproperty {0} z\n", type);
  if (!cloud.intensity.empty()) fields += "property float intensity\n";
  if (!cloud.distance.empty()) fields += "property float distance\n";
  write_rows(file, cloud,
             fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n{}end_header\n",
                         cloud.points.size(), fields));
}

void write_pcd(const std::filesystem::path& file, const Cloud& cloud) {
  std::string fields = "x y z";
  if (!cloud.intensity.empty()) fields += " intensity";
  if (!cloud.distance.empty()) fields += " distance";
  std::string sizes;
  std::string types;
  std::string counts;
  for (std::size_t i = 0; i < split_words(fields).size(); ++i) {
    sizes += i < 3 && is_far(cloud) ? " 8" : " 4";
    types += " F";
    counts += " 1";
  }
  write_rows(file, cloud,
             fmt::format("VERSION 0.7\nFIELDS {}\nSIZE{}\nTYPE{}\nCOUNT{}\nWIDTH {}\nHEIGHT 1\n"
                         "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA binary\n",
                         fields, sizes, types, counts, cloud.points.size(), cloud.points.size()));
}

}  // namespace lidarena::dataset
