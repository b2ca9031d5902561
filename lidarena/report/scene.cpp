// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/scene.hpp"

#include <algorithm>
#include <cmath>

namespace lidarena::report {
namespace {

constexpr std::size_t kMaxSampled = 200'000;  // points of a cloud from which its box is computed
constexpr double kIgnoredShare = 0.001;       // share of the points ignored at either end

Eigen::AlignedBox3d box_of(const std::vector<Eigen::Vector3f>& points) {
  const std::size_t stride = points.size() / kMaxSampled + 1;
  Eigen::Vector3d low;
  Eigen::Vector3d high;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> values;
    for (std::size_t i = 0; i < points.size(); i += stride) {
      if (points[i].allFinite()) values.push_back(points[i][axis]);
    }
    if (values.empty()) return {};
    const auto cut =
        static_cast<std::ptrdiff_t>(kIgnoredShare * static_cast<double>(values.size()));
    std::nth_element(values.begin(), values.begin() + cut, values.end());
    low[axis] = values[static_cast<std::size_t>(cut)];
    std::nth_element(values.begin(), values.end() - 1 - cut, values.end());
    high[axis] = *(values.end() - 1 - cut);
  }
  return {low, high};
}

}  // namespace

Eigen::AlignedBox3d bounds_to_show(const Scene& scene) {
  Eigen::AlignedBox3d box;
  for (const SceneCloud& cloud : scene.clouds) box.extend(box_of(cloud.points));
  for (const ScenePath& path : scene.paths) {
    for (const StampedPose& pose : path.trajectory.poses()) {
      box.extend(Eigen::Vector3d(pose.world_from_body.translation() - scene.origin));
    }
  }
  for (const SceneMesh& mesh : scene.meshes) {
    const Eigen::AlignedBox3d bounds = mesh.mesh.bounds();
    if (bounds.isEmpty()) continue;
    box.extend(Eigen::Vector3d(bounds.min() - scene.origin));
    box.extend(Eigen::Vector3d(bounds.max() - scene.origin));
  }
  if (box.isEmpty()) box = {Eigen::Vector3d::Constant(-0.5), Eigen::Vector3d::Constant(0.5)};
  return box;
}

std::optional<std::pair<double, double>> time_span(const Scene& scene) {
  double first = INFINITY;
  double last = -INFINITY;
  const auto take = [&](double t) {
    if (!std::isfinite(t)) return;
    first = std::min(first, t);
    last = std::max(last, t);
  };
  for (const ScenePath& path : scene.paths) {
    if (path.trajectory.empty()) continue;
    take(to_seconds(path.trajectory.begin_time() - scene.time_origin));
    take(to_seconds(path.trajectory.end_time() - scene.time_origin));
  }
  for (const SceneCloud& cloud : scene.clouds) {
    for (const float t : cloud.time) take(static_cast<double>(t));
  }
  if (!(last > first)) return std::nullopt;
  return std::pair{first, last};
}

}  // namespace lidarena::report
