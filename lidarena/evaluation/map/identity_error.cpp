// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/identity_error.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace lidarena::evaluation {

using Eigen::Vector3d;

IdentifiedMap identify(const dataset::Cloud& map, ScanTruthSource& truth, std::size_t triangles) {
  const std::vector<dataset::ReturnOrigin>& origins = map.origins;
  IdentifiedMap identified;
  identified.classes.resize(map.points.size(), PointClass::kUnknown);
  std::size_t next = 0;
  for (std::uint32_t scan = 0; next < origins.size(); ++scan) {
    const std::optional<ScanTruth> hits = truth.next();
    if (!hits) break;
    for (; next < origins.size() && origins[next].scan == scan; ++next) {
      if (origins[next].point >= hits->points.size()) continue;
      const PointTruth& hit = hits->points[origins[next].point];
      identified.points.push_back(map.points[next]);
      identified.hits.push_back(hit);
      identified.classes[next] = class_of(hit.triangle, triangles);
    }
  }
  return identified;
}

IdentityError identity_error(const IdentifiedMap& map, const Pose& mesh_from_map) {
  std::vector<double> distance, normal, tangential;
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    const PointTruth& hit = map.hits[i];
    const Vector3d error =
        mesh_from_map * map.points[i].cast<double>() - hit.position.cast<double>();
    const double across = std::abs(hit.normal.cast<double>().dot(error));
    distance.push_back(error.norm());
    normal.push_back(across);
    tangential.push_back(std::sqrt(std::max(0.0, error.squaredNorm() - across * across)));
  }
  IdentityError error;
  error.distance_m = results::summarize(distance);
  error.normal_m = results::summarize(normal);
  error.tangential_m = results::summarize(tangential);
  return error;
}

}  // namespace lidarena::evaluation
