// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/scene_blocks.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <span>

#include "lidarena/base/random.hpp"

namespace lidarena::report {
namespace {

constexpr std::size_t kChunkPoints = 65'536;
constexpr std::size_t kBlockPoints = 1'000'000;
constexpr double kMaxStoredCoordinate = 65'535.0;  // largest stored value of a coordinate
constexpr double kMaxStoredValue = 65'534.0;       // likewise of a field; 65535 means "none"
constexpr std::uint16_t kNoDistance = 65'535;

static_assert(std::endian::native == std::endian::little);

template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

Json to_list(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

struct Field {
  const char* name;
  const char* unit;
  const std::vector<float>* values;
  float min = 0.0F;
  float max = 0.0F;

  std::uint16_t stored(std::size_t i) const {
    const float v = (*values)[i];
    if (!std::isfinite(v)) return kNoDistance;
    if (!(max > min)) return 0;
    const double share = (static_cast<double>(v) - min) / (static_cast<double>(max) - min);
    return static_cast<std::uint16_t>(std::lround(share * kMaxStoredValue));
  }
};

std::vector<Field> fields_of(const SceneCloud& cloud) {
  std::vector<Field> fields;
  for (Field field : {Field{"distance", "m", &cloud.distance},
                      Field{"intensity", "", &cloud.intensity}, Field{"time", "s", &cloud.time}}) {
    if (field.values->empty()) continue;
    field.min = INFINITY;
    field.max = -INFINITY;
    for (const float v : *field.values) {
      if (!std::isfinite(v)) continue;
      field.min = std::min(field.min, v);
      field.max = std::max(field.max, v);
    }
    if (field.max < field.min) field.min = field.max = 0.0F;
    fields.push_back(field);
  }
  return fields;
}

/// A point and its index in the cloud, stored together so that sorting accesses memory in order.
struct IndexedPoint {
  Eigen::Vector3f position;
  std::uint32_t number;
};
using Points = std::span<IndexedPoint>;

std::vector<IndexedPoint> finite_points(const SceneCloud& cloud) {
  std::vector<IndexedPoint> points;
  points.reserve(cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!cloud.points[i].allFinite()) continue;
    points.push_back({cloud.points[i], static_cast<std::uint32_t>(i)});
  }
  return points;
}

Eigen::AlignedBox3f box_of(Points points) {
  Eigen::AlignedBox3f box;
  for (const IndexedPoint& point : points) box.extend(point.position);
  return box;
}

/// Splits the points into two halves along the longest side of their box.
void halve(Points points) {
  Eigen::Index axis = 0;
  box_of(points).sizes().maxCoeff(&axis);
  const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
  std::nth_element(points.begin(), middle, points.end(),
                   [axis](const IndexedPoint& a, const IndexedPoint& b) {
                     return a.position[axis] < b.position[axis];
                   });
}

/// Halves the points repeatedly until every part fits into a chunk.
std::vector<Points> cut_into_chunks(Points all, const Parallel& parallel) {
  if (all.empty()) return {};
  std::vector<Points> chunks{all};
  while (chunks.back().size() > kChunkPoints) {  // the last half is never the smaller one
    parallel.for_each(chunks.size(), 1, [&](std::size_t c) { halve(chunks[c]); });
    std::vector<Points> halves;
    for (const Points chunk : chunks) {
      halves.push_back(chunk.first(chunk.size() / 2));
      halves.push_back(chunk.subspan(chunk.size() / 2));
    }
    chunks = std::move(halves);
  }
  return chunks;
}

/// Fisher-Yates shuffle with random numbers that depend only on the index and on `stream`.
void shuffle(Points points, std::uint32_t stream) {
  const CounterRandom random(0, stream);
  for (std::size_t i = points.size(); i > 1; --i) {
    const auto j = static_cast<std::size_t>(random.uniform(i) * static_cast<double>(i));
    std::swap(points[i - 1], points[j]);
  }
}

/// Positions of `points` in `box`, then field after field.
void append_points(std::string& bytes, const std::vector<Field>& fields,
                   const Eigen::AlignedBox3f& box, Points points) {
  const Eigen::Vector3d low = box.min().cast<double>();
  const Eigen::Vector3d size = box.sizes().cast<double>().cwiseMax(1e-6);
  for (const IndexedPoint& point : points) {
    const Eigen::Vector3d share = (point.position.cast<double>() - low).cwiseQuotient(size);
    for (int axis = 0; axis < 3; ++axis) {
      append(bytes, static_cast<std::uint16_t>(std::lround(share[axis] * kMaxStoredCoordinate)));
    }
  }
  for (const Field& field : fields) {
    for (const IndexedPoint& point : points) append(bytes, field.stored(point.number));
  }
}

/// The same as sharePoints() in viewer/src/view/cloud.ts.
std::size_t share(std::size_t count, std::size_t part, std::size_t parts) {
  return count * part / parts;
}

class Packer {
 public:
  Packer(const Scene& scene, const Parallel& parallel) : scene_(scene), parallel_(parallel) {}

  PackedScene packed() {
    Json& header = packed_.header;
    const Eigen::AlignedBox3d bounds = bounds_to_show(scene_);
    const auto time = time_span(scene_);
    header = {{"title", scene_.title},
              {"version", LIDARENA_VERSION},
              {"frame", scene_.frame},
              {"origin", to_list(scene_.origin)},
              {"bounds", {to_list(bounds.min()), to_list(bounds.max())}},
              {"time", time ? Json{time->first, time->second} : Json(nullptr)},
              {"time_origin_s", to_seconds(scene_.time_origin)},
              {"window_s", scene_.window_s > 0 ? Json(scene_.window_s) : Json(nullptr)},
              {"outlier_m", kOutlier_m},
              {"paths", Json::array()},
              {"meshes", Json::array()},
              {"clouds", Json::array()},
              {"block_bytes", Json::array()}};
    for (const ScenePath& path : scene_.paths) header["paths"].push_back(add_path(path));
    for (const SceneMesh& mesh : scene_.meshes) header["meshes"].push_back(add_mesh(mesh));
    for (const SceneCloud& cloud : scene_.clouds) header["clouds"].push_back(add_cloud(cloud));
    for (const std::string& block : packed_.blocks) header["block_bytes"].push_back(block.size());
    return std::move(packed_);
  }

 private:
  std::size_t add_block(std::string bytes) {
    packed_.blocks.push_back(std::move(bytes));
    return packed_.blocks.size() - 1;
  }

  Json add_path(const ScenePath& path) {
    std::string bytes;
    for (const StampedPose& p : path.trajectory.poses()) {
      const Eigen::Vector3d position = p.world_from_body.translation() - scene_.origin;
      for (const double x : position) append(bytes, static_cast<float>(x));
    }
    for (const StampedPose& p : path.trajectory.poses()) {
      append(bytes, static_cast<float>(to_seconds(p.stamp - scene_.time_origin)));
    }
    for (const StampedPose& p : path.trajectory.poses()) {
      const Eigen::Quaterniond q(p.world_from_body.linear());
      for (const double x : q.coeffs()) append(bytes, static_cast<float>(x));
    }
    for (const double error : path.error_m) append(bytes, static_cast<float>(error));
    return {{"name", path.name},
            {"role", path.role == PathRole::kTruth ? "truth" : "estimate"},
            {"poses", path.trajectory.size()},
            {"has_error", !path.error_m.empty()},
            {"block", add_block(std::move(bytes))}};
  }

  Json add_mesh(const SceneMesh& mesh) {
    std::string bytes;
    for (const Eigen::Vector3d& vertex : mesh.mesh.vertices) {
      const Eigen::Vector3d position = vertex - scene_.origin;
      for (const double x : position) append(bytes, static_cast<float>(x));
    }
    for (const world::Triangle& triangle : mesh.mesh.triangles) {
      for (const std::uint32_t corner : triangle) append(bytes, corner);
    }
    return {{"name", mesh.name},
            {"vertices", mesh.mesh.vertices.size()},
            {"triangles", mesh.mesh.triangles.size()},
            {"block", add_block(std::move(bytes))}};
  }

  Json add_cloud(const SceneCloud& cloud) {
    std::vector<IndexedPoint> points = finite_points(cloud);
    const std::vector<Points> chunks = cut_into_chunks(points, parallel_);
    std::vector<Eigen::AlignedBox3f> boxes(chunks.size());
    parallel_.for_each(chunks.size(), 1, [&](std::size_t c) {
      boxes[c] = box_of(chunks[c]);
      shuffle(chunks[c], static_cast<std::uint32_t>(c));
    });

    const std::vector<Field> fields = fields_of(cloud);
    const std::size_t parts = std::max<std::size_t>(1, points.size() / kBlockPoints);
    std::vector<std::string> blocks(parts);
    parallel_.for_each(parts, 1, [&](std::size_t part) {
      blocks[part].reserve((points.size() / parts + chunks.size()) * (6 + 2 * fields.size()));
      for (std::size_t c = 0; c < chunks.size(); ++c) {
        const std::size_t begin = share(chunks[c].size(), part, parts);
        const std::size_t end = share(chunks[c].size(), part + 1, parts);
        append_points(blocks[part], fields, boxes[c], chunks[c].subspan(begin, end - begin));
      }
    });
    return cloud_header(cloud, fields, chunks, boxes, points.size(), std::move(blocks));
  }

  Json cloud_header(const SceneCloud& cloud, const std::vector<Field>& fields,
                    const std::vector<Points>& chunks,
                    const std::vector<Eigen::AlignedBox3f>& boxes, std::size_t points,
                    std::vector<std::string> blocks) {
    Json header{{"name", cloud.name},       {"points", points},        {"left_out", cloud.left_out},
                {"visible", cloud.visible}, {"fields", Json::array()}, {"chunks", Json::array()},
                {"blocks", Json::array()}};
    for (const Field& f : fields) {
      header["fields"].push_back(
          {{"name", f.name}, {"unit", f.unit}, {"min", f.min}, {"max", f.max}});
    }
    for (std::size_t c = 0; c < chunks.size(); ++c) {
      header["chunks"].push_back({{"count", chunks[c].size()},
                                  {"min", to_list(boxes[c].min().cast<double>())},
                                  {"size", to_list(boxes[c].sizes().cast<double>())}});
    }
    for (std::string& block : blocks) header["blocks"].push_back(add_block(std::move(block)));
    return header;
  }

  const Scene& scene_;
  const Parallel& parallel_;
  PackedScene packed_;
};

}  // namespace

PackedScene pack(const Scene& scene, const Parallel& parallel) {
  return Packer(scene, parallel).packed();
}

}  // namespace lidarena::report
