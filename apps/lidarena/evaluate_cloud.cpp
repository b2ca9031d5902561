// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/evaluate_cloud.hpp"

#include <fmt/format.h>

#include "lidarena/evaluation/map/cloud_comparison.hpp"

namespace lidarena {
namespace {

/// The map in the frame of the reference, relative to the reference's origin.
std::vector<Eigen::Vector3f> moved(const dataset::Cloud& map, const Pose& reference_from_map,
                                   const Eigen::Vector3d& origin) {
  std::vector<Eigen::Vector3f> points;
  points.reserve(map.points.size());
  for (const Eigen::Vector3f& point : map.points) {
    const Eigen::Vector3d in_map = map.origin + point.cast<double>();
    points.push_back((reference_from_map * in_map - origin).cast<float>());
  }
  return points;
}

}  // namespace

Json cloud_scores(const dataset::Cloud& map, const std::string& reference,
                  const Pose& reference_from_map, const Parallel& parallel) {
  const evaluation::MapAgreement own = evaluation::map_agreement(map.points, parallel);
  Json scores{{"points", map.points.size()}, {"neighborhoods", own.neighborhoods}};
  if (own.neighborhoods > 0) {
    scores["mean_map_entropy"] = own.mean_map_entropy;
    scores["plane_thickness_m"] = own.plane_thickness_m;
  }
  if (reference.empty()) return scores;
  const dataset::Cloud cloud = dataset::read_cloud(reference, true);
  const evaluation::CloudComparison found = evaluation::compare_clouds(
      moved(map, reference_from_map, cloud.origin), cloud.points, reference, parallel);
  scores["reference"] = {{"accuracy_m", found.accuracy_m},
                         {"completeness_m", found.completeness_m},
                         {"chamfer_m", found.chamfer_m},
                         {"f_score_5cm", found.f_score_5cm},
                         {"f_score_10cm", found.f_score_10cm},
                         {"map_points", found.map_points},
                         {"reference_points", found.reference_points}};
  return scores;
}

std::string cloud_text(const Json& scores) {
  std::string text;
  const auto add = [&](const char* name, double value, const char* unit) {
    text += fmt::format("  {:<38} {:8.3f} {}\n", name, value, unit);
  };
  if (scores.contains("reference")) {
    const Json& r = scores["reference"];
    add("map to reference (accuracy)", 100.0 * r["accuracy_m"].get<double>(), "cm");
    add("reference to map (completeness)", 100.0 * r["completeness_m"].get<double>(), "cm");
    add("Chamfer distance", 100.0 * r["chamfer_m"].get<double>(), "cm");
    add("F-score at 5 cm", 100.0 * r["f_score_5cm"].get<double>(), "%");
    add("F-score at 10 cm", 100.0 * r["f_score_10cm"].get<double>(), "%");
  }
  if (scores.contains("mean_map_entropy")) {
    add("mean map entropy", scores["mean_map_entropy"].get<double>(), "");
    add("thickness of planes", 100.0 * scores["plane_thickness_m"].get<double>(), "cm");
  }
  return text + fmt::format("  of {} points, {} neighborhoods\n", scores["points"].dump(),
                            scores["neighborhoods"].dump());
}

}  // namespace lidarena
