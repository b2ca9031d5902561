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

/// Writes a file of `header` and one binary float32 row x y z [intensity] [distance] per point.
void write_rows(const std::filesystem::path& file, const Cloud& cloud, std::string_view header) {
  assert(cloud.intensity.empty() || cloud.intensity.size() == cloud.points.size());
  assert(cloud.distance.empty() || cloud.distance.size() == cloud.points.size());
  PartFile out(file);
  out.write(header);
  constexpr std::size_t kBlock = 1 << 16;  // bytes per write
  std::string rows;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) append_float(rows, cloud.points[i][axis]);
    if (!cloud.intensity.empty()) append_float(rows, cloud.intensity[i]);
    if (!cloud.distance.empty()) append_float(rows, cloud.distance[i]);
    if (rows.size() < kBlock) continue;
    out.write(rows);
    rows.clear();
  }
  out.write(rows);
  out.commit();
}

}  // namespace

Cloud read_cloud(const std::filesystem::path& file) {
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
  for (std::size_t i = 0; i < table.size; ++i) {
    cloud.points.emplace_back(static_cast<float>(table.number(x, i)),
                              static_cast<float>(table.number(y, i)),
                              static_cast<float>(table.number(z, i)));
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
  std::string fields = "property float x\nproperty float y\nproperty float z\n";
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
    sizes += " 4";
    types += " F";
    counts += " 1";
  }
  write_rows(file, cloud,
             fmt::format("VERSION 0.7\nFIELDS {}\nSIZE{}\nTYPE{}\nCOUNT{}\nWIDTH {}\nHEIGHT 1\n"
                         "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA binary\n",
                         fields, sizes, types, counts, cloud.points.size(), cloud.points.size()));
}

}  // namespace lidarena::dataset
