// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/points/cloud.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <fstream>
#include <string>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/points/point_table.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::dataset {
namespace {

template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

using Fields = CloudWriter::Fields;

/// Whether coordinates are written as double.
bool is_far(const Cloud& cloud) { return !cloud.origin.isZero(0.0); }

void append_position(const Cloud& cloud, std::size_t i, std::string& rows) {
  for (int axis = 0; axis < 3; ++axis) {
    if (is_far(cloud)) {
      append(rows, cloud.origin[axis] + double{cloud.points[i][axis]});
    } else {
      append(rows, cloud.points[i][axis]);
    }
  }
}

/// Appends one binary row x y z [intensity] [distance] [scan point time] per point of a cloud.
void append_rows(const Cloud& cloud, const Fields& fields, std::string& rows) {
  assert(!fields.intensity || cloud.intensity.size() == cloud.points.size());
  assert(!fields.distance || cloud.distance.size() == cloud.points.size());
  assert(!fields.origins || cloud.origins.size() == cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    append_position(cloud, i, rows);
    if (fields.intensity) append(rows, cloud.intensity[i]);
    if (fields.distance) append(rows, cloud.distance[i]);
    if (!fields.origins) continue;
    append(rows, cloud.origins[i].scan);
    append(rows, cloud.origins[i].point);
    append(rows, cloud.origins[i].time_s);
  }
}

Fields fields_of(const Cloud& cloud) {
  return {!cloud.intensity.empty(), !cloud.distance.empty(), !cloud.origins.empty(), is_far(cloud)};
}

/// The header's length does not depend on the number of points.
std::string ply_header(const Fields& fields, std::size_t points) {
  const std::string count = std::to_string(points);
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment ";
  header += std::string(20 - count.size(), '.') + "\nelement vertex " + count + "\n";
  for (const char* axis : {"x", "y", "z"})
    header += fmt::format("property {} {}\n", fields.far ? "double" : "float", axis);
  if (fields.intensity) header += "property float intensity\n";
  if (fields.distance) header += "property float distance\n";
  if (fields.origins) header += "property uint scan\nproperty uint point\nproperty double time\n";
  return header + "end_header\n";
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
  const auto read = [&table](const Column* column, auto&& put) {
    if (column == nullptr) return;
    if (column->type == ScalarType::kFloat32) {  // as nearly all are: without a look at each type
      for (std::size_t i = 0; i < table.size; ++i) {
        float value = 0.0F;
        std::memcpy(&value, &table.bytes[column->offset + i * column->stride], sizeof(value));
        put(i, value);
      }
    } else {
      for (std::size_t i = 0; i < table.size; ++i) put(i, table.number(*column, i));
    }
  };
  Cloud cloud;
  cloud.points.resize(table.size);
  const std::array<const Column*, 3> axes{&table.require("x"), &table.require("y"),
                                          &table.require("z")};
  if (keep_origin) {
    const auto point = [&](std::size_t i) {
      return Eigen::Vector3d(table.number(*axes[0], i), table.number(*axes[1], i),
                             table.number(*axes[2], i));
    };
    cloud.origin = origin_of(table.size, point);
  }
  for (int axis = 0; axis < 3; ++axis)
    read(axes[static_cast<std::size_t>(axis)], [&](std::size_t i, auto value) {
      cloud.points[i][axis] = static_cast<float>(value - cloud.origin[axis]);
    });
  const auto read_values = [&](const Column* column, std::vector<float>& values) {
    if (column != nullptr) values.resize(table.size);
    read(column, [&](std::size_t i, auto value) { values[i] = static_cast<float>(value); });
  };
  read_values(table.find({"intensity", "scalar_intensity"}), cloud.intensity);
  read_values(table.find({"distance", "scalar_distance"}), cloud.distance);
  const Column *scan = table.find({"scan"}), *point = table.find({"point"}),
               *time = table.find({"time"});
  if (scan == nullptr || point == nullptr || time == nullptr) return cloud;
  cloud.origins.resize(table.size);
  for (std::size_t i = 0; i < table.size; ++i)
    cloud.origins[i] = {static_cast<std::uint32_t>(table.integer(*scan, i)),
                        static_cast<std::uint32_t>(table.integer(*point, i)),
                        table.number(*time, i)};
  return cloud;
}

CloudWriter::CloudWriter(const std::filesystem::path& file, const Fields& fields)
    : fields_(fields),
      part_name_(file.string() + ".part"),
      file_(std::make_unique<PartFile>(file)) {
  file_->write(ply_header(fields, 0));
  begin_ = file_->size();
}

CloudWriter::~CloudWriter() = default;

std::size_t CloudWriter::row_bytes() const {
  return 3 * (fields_.far ? sizeof(double) : sizeof(float)) +
         (fields_.intensity ? sizeof(float) : 0) + (fields_.distance ? sizeof(float) : 0) +
         (fields_.origins ? 16 : 0);
}

void CloudWriter::write(const Cloud& part) {
  std::string rows;
  rows.reserve(part.points.size() * row_bytes());
  append_rows(part, fields_, rows);
  file_->write(rows);
  size_ += part.points.size();
}

void CloudWriter::commit(const Pose& moved) {
  if (!moved.isApprox(Pose::Identity(), 0.0)) move_points(moved);
  const std::string header = ply_header(fields_, size_);
  file_->overwrite(0, std::as_bytes(std::span(header)));
  file_->commit();
}

void CloudWriter::move_points(const Pose& moved) {
  assert(!fields_.far);
  file_->flush();
  std::ifstream in(part_name_, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(begin_));
  constexpr std::size_t kBlock = 1 << 14;  // points
  const std::size_t row = row_bytes();
  std::string rows;
  for (std::size_t first = 0; first < size_; first += kBlock) {
    rows.resize(row * std::min(kBlock, size_ - first));
    if (!in.read(rows.data(), static_cast<std::streamsize>(rows.size())))
      throw Error(part_name_.string() + ": cannot be read again");
    for (std::size_t at = 0; at < rows.size(); at += row) {
      Eigen::Vector3f point;
      std::memcpy(point.data(), &rows[at], sizeof(point));
      point = (moved * point.cast<double>()).cast<float>();
      std::memcpy(&rows[at], point.data(), sizeof(point));
    }
    file_->overwrite(begin_ + first * row, std::as_bytes(std::span(rows)));
  }
}

void write_ply(const std::filesystem::path& file, const Cloud& cloud) {
  CloudWriter writer(file, fields_of(cloud));
  writer.write(cloud);
  writer.commit();
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
  PartFile out(file);
  out.write(
      fmt::format("VERSION 0.7\nFIELDS {}\nSIZE{}\nTYPE{}\nCOUNT{}\nWIDTH {}\nHEIGHT 1\n"
                  "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA binary\n",
                  fields, sizes, types, counts, cloud.points.size(), cloud.points.size()));
  std::string rows;
  append_rows(cloud, {!cloud.intensity.empty(), !cloud.distance.empty(), false, is_far(cloud)},
              rows);
  out.write(rows);
  out.commit();
}

}  // namespace lidarena::dataset
