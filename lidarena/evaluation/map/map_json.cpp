// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/map_json.hpp"

#include "lidarena/evaluation/metrics_json.hpp"

namespace lidarena::evaluation {

Json to_json(const VoxelError& error) {
  if (error.voxels == 0) return nullptr;
  return {{"definition", "map_error_voxels[5cm,rms-by-voxel,20cm]"},
          {"voxel_m", VoxelError::kVoxel_m},
          {"voxels", error.voxels},
          {"distance", to_json(error.rms_m, "m")},
          {"outliers_percent", error.outliers_percent}};
}

Json to_json(const SignedDistance& distance) {
  if (distance.points == 0) return nullptr;
  return {{"definition", "map_error_signed[free-side-of-rays,within60deg]"},
          {"points", distance.points},
          {"points_without_sign", distance.without},
          {"mean_m", distance.mean_m},
          {"median_m", distance.median_m},
          {"p5_m", distance.p5_m},
          {"p95_m", distance.p95_m},
          {"behind_percent", distance.behind_percent},
          {"histogram",
           {{"from_m", -SignedDistance::kRange_m},
            {"bin_m", SignedDistance::kBin_m},
            {"counts", distance.histogram},
            {"below", distance.below},
            {"above", distance.above}}}};
}

Json to_json(const Ghosting& ghosting) {
  if (ghosting.patches == 0) return nullptr;
  return {{"definition", "ghosting[20cm-patches,otsu,ashman4,valley]"},
          {"patch_m", Ghosting::kPatch_m},
          {"patches", ghosting.patches},
          {"thickness", to_json(ghosting.thickness_m, "m")},
          {"double_patches", ghosting.double_patches},
          {"double_percent", ghosting.double_percent},
          {"median_separation_m",
           ghosting.double_patches > 0 ? Json(ghosting.median_separation_m) : Json(nullptr)}};
}

Json to_json(const IdentityError& error) {
  if (error.distance_m.count == 0) return nullptr;
  return {{"definition", "identity_error[own-true-hit]"},
          {"distance", to_json(error.distance_m, "m")},
          {"normal", to_json(error.normal_m, "m")},
          {"tangential", to_json(error.tangential_m, "m")}};
}

Json to_json(const Completeness& completeness) {
  if (completeness.samples == 0) return nullptr;
  Json rows = Json::array();
  for (std::size_t i = 0; i < completeness.rows.size(); ++i) {
    const Completeness::Row& row = completeness.rows[i];
    rows.push_back({{"within_m", Completeness::kWithin_m[i]},
                    {"precision_percent", row.precision_percent},
                    {"recall_percent", row.recall_percent},
                    {"f_score_percent", row.f_score_percent}});
  }
  return {{"definition", "completeness[seen2cm,stratified-by-area]"},
          {"samples", completeness.samples},
          {"samples_per_m2", SurfaceSamples::kPerSquareMeter},
          {"seen_m2", completeness.seen_m2},
          {"rows", rows}};
}

Json to_json(const VertexDistance& distance) {
  const MapError& error = distance.error;
  if (distance.refusal.empty() && error.points == 0) return nullptr;
  Json json{{"definition", "map_error_vertices[point-vertex,regular-subdivision,20cm]"},
            {"edge_m", distance.edge_m},
            {"vertices", distance.vertices}};
  if (!distance.refusal.empty()) {
    json["refused"] = distance.refusal;
    return json;
  }
  json["points"] = error.points;
  json["rmse_m"] = error.distance_m.rmse;
  json["rmse_inliers_m"] = error.inliers > 0 ? Json(error.rmse_inliers_m) : Json(nullptr);
  json["median_m"] = error.distance_m.median;
  json["outliers_percent"] = error.outliers_percent;
  return json;
}

Json to_json(const MeshAlignment& alignment) {
  Json eigenvalues = Json::array();
  for (const double value : alignment.eigenvalues) eigenvalues.push_back(value);
  return {{"definition", "gauge_robust[trimmed-icp,point-plane,10cm-voxels]"},
          {"points", alignment.points},
          {"iterations", alignment.iterations},
          {"inliers_percent", 100.0 * alignment.inlier_share},
          {"starts", MeshAlignment::kStarts},
          {"starts_agreeing", alignment.agreeing_starts},
          {"eigenvalues", eigenvalues},
          {"frozen", alignment.frozen},
          {"moved_m", alignment.moved_m},
          {"turned_rad", alignment.turned_rad}};
}

}  // namespace lidarena::evaluation
