// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/preprocess.hpp"

#include <cmath>

#include "lidarena/base/time.hpp"

namespace lidarena::odometry::fast_lio2 {

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
  for (std::size_t i = 0; i < points.size() && !track.empty(); ++i) {
    const Point& measured = selected.points[i];
    if (time_of(selected, measured) <= track.front().begin) points[i] = measured.position;
  }
  return points;
}

}  // namespace lidarena::odometry::fast_lio2
