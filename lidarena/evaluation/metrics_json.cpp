// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/metrics_json.hpp"

#include <fmt/format.h>

#include <cmath>

#include "lidarena/base/so3.hpp"

namespace lidarena::evaluation {
namespace {

double rounded(double value) { return std::round(value * 1e6) / 1e6; }

Time stamp_of(const SegmentError& error) { return error.end; }
Time stamp_of(const PoseError& error) { return error.stamp; }

template <class Error>
Json columns(std::span<const Error> errors, Time start, std::size_t limit) {
  Json t = Json::array();
  Json translation = Json::array();
  Json rotation = Json::array();
  const std::size_t run = limit == 0 ? errors.size() + 1 : (errors.size() + limit - 1) / limit;
  for (std::size_t begin = 0; begin < errors.size(); begin += run) {
    const Error* worst = &errors[begin];
    double rotation_rad = 0.0;
    for (const Error& error : errors.subspan(begin, std::min(run, errors.size() - begin))) {
      if (error.translation_m > worst->translation_m) worst = &error;
      rotation_rad = std::max(rotation_rad, error.rotation_rad);
    }
    t.push_back(rounded(to_seconds(stamp_of(*worst) - start)));
    translation.push_back(rounded(worst->translation_m));
    rotation.push_back(rounded(rotation_rad));
  }
  return {
      {"t_s", t}, {"translation_m", translation}, {"rotation_rad", rotation}, {"largest_of", run}};
}

}  // namespace

std::string definition_id(const RelativePoseError& rpe) {
  const bool by_path = rpe.segment_m > 0.0;
  const double segment = by_path ? rpe.segment_m : rpe.segment_s;
  const char* unit = by_path ? "m" : "s";
  const std::string spacing =
      rpe.step == segment ? "disjoint" : fmt::format("every{}{}", rpe.step, unit);
  if (rpe.at_poses)
    return fmt::format("rpe_{0}m_at_poses[ref-arc,{0}m,{1},nearest-poses,gap1.5]", segment,
                       spacing);
  return fmt::format("rpe_{0}{1}[{2},{0}{1},{3},interp,gap1.5]", segment, unit,
                     by_path ? "ref-arc" : "time", spacing);
}

std::string definition_id(const AbsoluteTrajectoryError& ate) {
  return fmt::format("ate_{}[est-stamps,ref-interp,gap1.5]", to_string(ate.alignment.gauge));
}

std::string definition_id(const KittiError& error) {
  if (error.lengths.empty()) return "kitti[est-poses,ref-arc,every10,first-beyond]";
  return fmt::format("kitti[est-poses,ref-arc,every10,first-beyond,{:g}-{:g}m]",
                     error.lengths.front().length_m, error.lengths.back().length_m);
}

std::string definition_id(const MapError&) { return "map_error[point-triangle,all-points,20cm]"; }

Json to_json(const Summary& summary, const std::string& unit) {
  if (summary.count == 0) return nullptr;
  return {{"count", summary.count},       {"rmse_" + unit, summary.rmse},
          {"mean_" + unit, summary.mean}, {"median_" + unit, summary.median},
          {"p95_" + unit, summary.p95},   {"p99_" + unit, summary.p99},
          {"max_" + unit, summary.max}};
}

Json to_json(const Association& association, const std::optional<TimeOffset>& offset) {
  return {{"estimates", association.estimates},
          {"matched", association.matched},
          {"coverage", association.coverage},
          {"overlap_s", association.overlap_s},
          {"longest_gap_s", association.longest_gap_s},
          {"estimate_rate_hz", association.estimate_rate_hz},
          {"truth_rate_hz", association.truth_rate_hz},
          {"time_offset_s", offset ? Json(offset->late_s) : Json(nullptr)},
          {"time_offset_sigma_s", offset ? Json(offset->sigma_s) : Json(nullptr)}};
}

Json to_json(const std::optional<LeverArm>& arm) {
  constexpr double kKnown = 0.1;  // m and rad: less certain components are null
  if (!arm) return nullptr;
  const auto known = [&](const Eigen::Vector3d& value, Eigen::Index first) {
    Json components = Json::array();
    for (Eigen::Index i = 0; i < 3; ++i) {
      components.push_back(arm->sigma[first + i] < kKnown ? Json(value[i]) : Json(nullptr));
    }
    return components;
  };
  return {{"position_m", known(arm->body_from_estimate.translation(), 0)},
          {"position_sigma_m", {arm->sigma[0], arm->sigma[1], arm->sigma[2]}},
          {"rotation_vector_rad", known(so3::log(arm->body_from_estimate.linear()), 3)},
          {"rotation_sigma_rad", {arm->sigma[3], arm->sigma[4], arm->sigma[5]}},
          {"misfit_without_m", arm->misfit_without_m},
          {"misfit_m", arm->misfit_m}};
}

Json to_json(const RelativePoseError& rpe) {
  Json json{{"definition", definition_id(rpe)}};
  json[rpe.segment_m > 0.0 ? "segment_m" : "segment_s"] = std::max(rpe.segment_m, rpe.segment_s);
  json["used"] = rpe.used;
  json["total"] = rpe.total;
  json["translation"] = to_json(rpe.translation_m, "m");
  json["rotation"] = to_json(rpe.rotation_rad, "rad");
  return json;
}

Json to_json(const AbsoluteTrajectoryError& ate) {
  const Alignment& alignment = ate.alignment;
  Json json{{"definition", definition_id(ate)}};
  if (!alignment.determined()) {
    json["refused"] = alignment.refusal;
  } else {
    json["truth_from_estimate_m_quaternion"] = value_to_json(alignment.truth_from_estimate);
    json["scale_hint"] = alignment.scale_hint;
  }
  if (!alignment.warning.empty()) json["warning"] = alignment.warning;
  json["translation"] = to_json(ate.translation_m, "m");
  json["rotation"] = to_json(ate.rotation_rad, "rad");
  return json;
}

Json to_json(const KittiError& error) {
  Json json{{"definition", definition_id(error)}};
  if (!error.refusal.empty()) {
    json["refused"] = error.refusal;
    return json;
  }
  json["pieces"] = error.pieces;
  json["translation_percent"] = error.translation_percent;
  json["rotation_rad_per_m"] = error.rotation_rad_per_m;
  json["lengths"] = Json::array();
  for (const KittiLength& length : error.lengths) {
    const bool some = length.pieces > 0;
    json["lengths"].push_back(
        {{"length_m", length.length_m},
         {"pieces", length.pieces},
         {"translation_percent", some ? Json(length.translation_percent) : Json(nullptr)},
         {"rotation_rad_per_m", some ? Json(length.rotation_rad_per_m) : Json(nullptr)}});
  }
  return json;
}

Json to_json(const MapError& error) {
  Json json{{"definition", definition_id(error)},
            {"points", error.points},
            {"invalid_points", error.invalid}};
  if (error.points == 0) return json;
  json["distance"] = to_json(error.distance_m, "m");
  json["inliers"] = error.inliers;
  json["rmse_inliers_m"] = error.inliers > 0 ? Json(error.rmse_inliers_m) : Json(nullptr);
  json["outliers_percent"] = error.outliers_percent;
  json["outlier_beyond_m"] = MapError::kOutlier_m;
  Json cdf = Json::array();
  std::uint64_t within = 0;
  for (const std::uint64_t count : error.histogram) {
    within += count;
    cdf.push_back(100.0 * static_cast<double>(within) / static_cast<double>(error.points));
  }
  json["cdf_percent"] = cdf;  // at the upper edges of the histogram's bins
  json["histogram"] = {{"bin_m", MapError::kBin_m},
                       {"counts", error.histogram},
                       {"beyond", error.points - error.inliers}};
  return json;
}

Json to_json(const HoverJitter& jitter) {
  if (jitter.poses == 0) return nullptr;
  return {{"definition", "hover_jitter[below5cm/s,1s,about-mean]"},
          {"hovered_s", jitter.seconds},
          {"poses", jitter.poses},
          {"rms_m", jitter.rms_m}};
}

Json errors_over_time(std::span<const SegmentError> segments, Time start, std::size_t limit) {
  return columns(segments, start, limit);
}

Json errors_over_time(std::span<const PoseError> poses, Time start, std::size_t limit) {
  return columns(poses, start, limit);
}

}  // namespace lidarena::evaluation
