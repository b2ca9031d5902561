// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/fast_lio2.hpp"

#include <functional>
#include <utility>

#include "lidarena/map/voxel_filter.hpp"
#include "lidarena/odometry/fast_lio2/initialization.hpp"

namespace lidarena::odometry::fast_lio2 {
namespace {

constexpr double kConvergence = 1e-3;     // m, rad, m/s, ...: largest step of a converged update
constexpr double kPointVariance = 1e-3;   // m^2, of a point's distance from its plane
constexpr std::size_t kMinPoints = 5;     // averaged points that a scan needs
constexpr double kReportedImuGap = 0.05;  // s; longer pauses between samples are reported
constexpr std::size_t kArchivedPointBytes = 48;  // of a point in the program's buffer

}  // namespace

FastLio2::FastLio2(const Config& config, const LidarInfo& lidar, const ImuInfo& imu,
                   Parallel parallel)
    : config_(config),
      is_livox_(lidar.kind == "rosette"),
      rate_hz_(lidar.rate_hz),
      world_from_start_(imu.body_from_imu),
      imu_from_body_(imu.body_from_imu.inverse()),
      imu_from_lidar_(imu_from_body_ * lidar.body_from_lidar),
      parallel_(std::move(parallel)),
      imu_(kReportedImuGap),
      box_(config.map_box_size_m, config.detection_range_m) {}

ScanResult FastLio2::track(const Scan& scan) {
  registered_scan_.clear();
  track_.clear();
  const Scan selected =
      config_.azimuth_times && !scan.timed
          ? selected_points(with_azimuth_times(scan, rate_hz_), config_, is_livox_)
          : selected_points(scan, config_, is_livox_);
  const Time end = clock_.end_of(selected);
  if (!started_) {
    start(end);
    const bool empty = scan.points.empty();
    return finish_scan(scan, end, empty ? ScanStatus::kTooFewPoints : ScanStatus::kInitializing);
  }
  predict({estimated_, scan.stamp, end});
  const auto points = propagate_backward(selected, track_, estimate_.state, parallel_);
  const auto reduced = map::voxel_means(points, config_.scan_voxel_size_m);
  counters_.points = points.size();
  details_.emplace_back("keypoints", reduced.size());
  box_.follow(estimate_.state.world_from_lidar().translation().cast<float>(), map_);
  if (reduced.size() < kMinPoints) return finish_scan(scan, end, ScanStatus::kTooFewPoints);
  if (map_.empty()) {
    if (reduced.size() > kMinPoints)
      map_.build(transformed(estimate_.state.world_from_lidar(), reduced));
    return finish_scan(scan, end, ScanStatus::kInitializing);
  }

  PlaneResiduals residuals(reduced, map_, config_.estimate_extrinsics, parallel_);
  const estimation::IteratedUpdate update = estimation::iterated_update(
      estimate_, std::ref(residuals), {config_.max_iterations, kConvergence, kPointVariance});
  estimate_ = update.estimate;
  details_.emplace_back("matches", update.points.count);
  details_.emplace_back("iterations", update.evaluations);
  const Pose world_from_lidar = estimate_.state.world_from_lidar();
  if (estimation::is_plausible(estimate_.state))
    insert_scan(transformed(world_from_lidar, reduced), residuals.neighbors(),
                static_cast<float>(config_.map_voxel_size_m), map_);
  publish(transformed(world_from_start_ * world_from_lidar, points));
  const bool matched = update.points.count > 0;
  return finish_scan(scan, end, matched ? ScanStatus::kTracked : ScanStatus::kTooFewPoints);
}

void FastLio2::start(Time end) {
  const std::vector<ImuSample> samples = imu_.samples(estimated_ + Time{1}, end);
  imu_.remove_before(end);
  estimated_ = end;
  if (!first_scan_) start_samples_.insert(start_samples_.end(), samples.begin(), samples.end());
  first_scan_ = false;
  const std::optional<Start> begin = start_from(start_samples_, imu_from_lidar_);
  if (!begin) return;
  estimate_ = begin->estimate;
  accel_scale_ = begin->accel_scale;
  estimated_ = start_samples_.back().stamp;
  started_ = true;
  start_samples_ = {};
}

void FastLio2::predict(const ScanSpan& scan) {
  std::vector<ImuSample> samples = imu_.samples(Time::min(), scan.end);
  for (ImuSample& sample : samples) sample.accel *= accel_scale_;
  const double pause = estimation::longest_pause_s(samples, scan.end);
  details_.emplace_back("imu_gap_s", pause > kReportedImuGap ? pause : 0.0);
  track_ = propagate_forward(samples, scan, config_, estimate_);
  estimated_ = scan.end;
  imu_.remove_before(scan.end);
}

void FastLio2::publish(std::vector<Eigen::Vector3f> in_world) {
  registered_scan_ = std::move(in_world);
  if (config_.keep_all_scans) archived_bytes_ += registered_scan_.size() * kArchivedPointBytes;
}

ScanResult FastLio2::finish_scan(const Scan& scan, Time end, ScanStatus status) {
  const Pose world_from_imu = world_from_start_ * estimate_.state.world_from_imu();
  ScanResult result;
  result.estimate = {end, world_from_imu * imu_from_body_};
  result.status = estimation::is_plausible(estimate_.state) ? status : ScanStatus::kDiverged;
  if (started_)
    result.covariance =
        estimation::body_covariance(estimate_, world_from_start_.linear(), imu_from_body_);
  result.motion =
      estimation::motion_along(track_, scan.stamp, end, end, world_from_imu, imu_from_body_);
  details_.emplace_back("map_points", map_.size());
  details_.emplace_back("imu_refused", imu_.refused());
  details_.emplace_back("accel_scale", accel_scale_);
  result.counters = std::exchange(counters_, {});
  result.details = std::exchange(details_, {});
  if (poses_.empty() || end > poses_.back().stamp) poses_.push_back(result.estimate);
  return result;
}

std::vector<Eigen::Vector3f> FastLio2::map() const {
  return transformed(world_from_start_, map_.points());
}

MemoryUse FastLio2::memory() const {
  const std::size_t published = registered_scan_.capacity() * sizeof(Eigen::Vector3f);
  return {.map = map_.memory_bytes(),
          .scan_buffer = archived_bytes_ + published,
          .backlog = imu_.memory_bytes(),
          .other = poses_.capacity() * sizeof(StampedPose)};
}

}  // namespace lidarena::odometry::fast_lio2
