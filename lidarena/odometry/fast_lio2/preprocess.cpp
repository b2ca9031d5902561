// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/preprocess.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

#include "lidarena/base/angle.hpp"
#include "lidarena/base/time.hpp"

namespace lidarena::odometry::fast_lio2 {
namespace {

/// Moves the earliest of the points once more for each step of the track before its own. The
/// program walks back along track and points at once, and after its last point it goes on along the
/// track.
void move_earliest_again(const Scan& selected, const estimation::ImuTrack& track,
                         const estimation::InertialState& state,
                         std::vector<Eigen::Vector3f>& points) {
  const auto earliest =
      std::min_element(selected.points.begin(), selected.points.end(),
                       [](const Point& a, const Point& b) { return a.dt_ns < b.dt_ns; });
  if (earliest == selected.points.end()) return;
  const Time t = time_of(selected, *earliest);
  Eigen::Vector3f& point = points[static_cast<std::size_t>(earliest - selected.points.begin())];
  auto step = std::find_if(track.begin(), track.end(),
                           [t](const estimation::ImuStep& s) { return s.begin >= t; });
  if (step != track.begin()) --step;  // its own
  while (step != track.begin()) {
    --step;
    if (step == track.begin() && t <= selected.stamp) return;
    const Pose then = estimation::pose_at({*step}, t) * state.imu_from_lidar;
    const Pose end_from_then = state.world_from_lidar().inverse() * then;
    point = (end_from_then * point.cast<double>()).cast<float>();
  }
}

}  // namespace

Scan with_azimuth_times(const Scan& scan, double rate_hz) {
  struct Ring {
    double first_deg = 0.0;
    double last_ms = 0.0;
  };
  std::map<std::uint16_t, Ring> rings;
  const double deg_per_ms = 0.361 * rate_hz;
  Scan timed = scan;
  timed.timed = true;
  for (Point& point : timed.points) {
    const Eigen::Vector3d p = point.position.cast<double>();
    const double azimuth_deg = std::atan2(p.y(), p.x()) / kDegree;
    const auto [found, is_first] = rings.try_emplace(point.ring, Ring{azimuth_deg});
    if (is_first) {
      point.position.setConstant(std::numeric_limits<float>::quiet_NaN());
      continue;
    }
    Ring& ring = found->second;
    const double turned = ring.first_deg - azimuth_deg;
    double ms = (turned >= 0.0 ? turned : turned + 360.0) / deg_per_ms;
    if (ms < ring.last_ms) ms += 360.0 / deg_per_ms;
    ring.last_ms = ms;
    point.dt_ns = static_cast<std::int32_t>(1e6 * ms);
  }
  return timed;
}

Scan selected_points(const Scan& scan, const Config& config, bool is_livox) {
  Scan selected{.stamp = scan.stamp, .points = {}, .timed = scan.timed};
  const auto stride = static_cast<std::size_t>(config.point_stride);
  const auto blind = static_cast<float>(config.min_range_m * config.min_range_m);
  selected.points.reserve(scan.points.size() / stride + 1);
  for (std::size_t i = is_livox ? stride : 0; i < scan.points.size(); i += stride) {
    const float squared = scan.points[i].position.squaredNorm();
    if (std::isfinite(squared) && squared > blind) selected.points.push_back(scan.points[i]);
  }
  return selected;
}

Time ScanClock::end_of(const Scan& selected) {
  if (!selected.timed) return selected.stamp;
  const bool has_duration = selected.points.size() > 1;
  const double seconds = has_duration ? to_seconds(Time{selected.points.back().dt_ns}) : 0.0;
  if (!has_duration || seconds < 0.5 * mean_s_) return selected.stamp + from_seconds(mean_s_);
  mean_s_ += (seconds - mean_s_) / ++scans_;
  return time_of(selected, selected.points.back());
}

std::vector<Eigen::Vector3f> propagate_backward(const Scan& selected,
                                                const estimation::ImuTrack& track,
                                                const estimation::InertialState& state,
                                                const Parallel& parallel) {
  std::vector<Eigen::Vector3f> points =
      estimation::deskew(selected, track, state.imu_from_lidar, state.world_from_imu(), parallel);
  if (!selected.timed || track.empty()) return points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point& measured = selected.points[i];
    if (time_of(selected, measured) <= track.front().begin) points[i] = measured.position;
  }
  move_earliest_again(selected, track, state, points);
  return points;
}

}  // namespace lidarena::odometry::fast_lio2
