// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/ct_icp.hpp"

#include <algorithm>
#include <utility>

namespace lidarena::odometry::ct_icp {

namespace {

constexpr int kRigidScans = 2;          // at the start, registered without motion within the scan
constexpr int kInitialIterations = 15;  // at least, for the first initial_scans
constexpr double kDegenerate = 0.01;    // minimum share of a direction; isotropic: 1/3

}  // namespace

CtIcp::CtIcp(const Config& config, const LidarInfo& lidar, Parallel parallel)
    : config_(config),
      parallel_(std::move(parallel)),
      map_({config.map.voxel_size_m, config.map.max_points_per_voxel,
            config.map.min_point_spacing_m, map::VoxelRounding::kTruncate}),
      path_(lidar) {}

std::vector<Eigen::Vector3f> CtIcp::map() const {
  return transformed(path_.body_from_lidar(), map_.points());
}

MemoryUse CtIcp::memory() const {
  return {.map = map_.memory_bytes(),
          .scan_buffer = registered_scan_.capacity() * sizeof(Eigen::Vector3f),
          .other = path_.memory_bytes()};
}

ScanResult CtIcp::ended() const {
  return {.estimate = path_.poses().back(), .status = ScanStatus::kDiverged};
}

ScanResult CtIcp::track(const Scan& scan) {
  if (ended_) return ended();
  const estimation::ScanTimes times = path_.times_of(scan);
  const bool rigid = !times.timed || map_.empty() || scans_ < kRigidScans;
  const auto points = timed_points(scan, times, rigid);
  const SamplingConfig& sampling = config_.sampling;
  const auto frame =
      thin(points, starting() ? sampling.initial_scan_voxel_size_m : sampling.scan_voxel_size_m);
  const auto keypoints = sample_keypoints(frame, sampling, starting());

  const Registration found = align(keypoints);
  const ScanStatus status = status_of(found, points.size());
  ended_ = status == ScanStatus::kDiverged;
  if (ended_) return ended();
  const bool inserted = advance(found, frame, times);

  registered_scan_ = placed(path_.body_from_lidar(), found.motion, points, parallel_);
  return {.estimate = path_.poses().back(),
          .status = status,
          .counters = {.points = points.size()},
          .motion = rigid ? std::vector<StampedPose>{}
                          : body_poses(found.motion, times, path_.body_from_lidar()),
          .details = {{"keypoints", keypoints.size()},
                      {"matches", found.matches},
                      {"iterations", found.iterations},
                      {"map_points", map_.size()},
                      {"inserted", inserted}}};
}

Registration CtIcp::align(std::span<const TimedPoint> keypoints) const {
  const Expectation expected{history_.predict(config_.registration.initial_motion),
                             history_.prior(config_.prior)};
  if (map_.empty()) return {expected.guess};
  RegistrationConfig settings = config_.registration;
  if (starting()) settings.max_iterations = std::max(settings.max_iterations, kInitialIterations);
  return register_keypoints(keypoints, map_, expected, settings, parallel_);
}

ScanStatus CtIcp::status_of(const Registration& found, std::size_t points) const {
  if (points == 0) return ScanStatus::kTooFewPoints;
  if (map_.empty()) return ScanStatus::kInitializing;
  if (found.failed || !is_plausible(found.motion, history_.last_end()))
    return ScanStatus::kDiverged;
  return found.observability < kDegenerate ? ScanStatus::kDegenerate : ScanStatus::kTracked;
}

bool CtIcp::advance(const Registration& found, std::span<const TimedPoint> frame,
                    const estimation::ScanTimes& times) {
  const ElasticMotion& motion = found.motion;
  const bool inserted = !frame.empty() && (config_.map.always_insert || gate_.admits(motion));
  if (inserted) map_.insert(placed(Pose::Identity(), motion, frame, parallel_));
  map_.remove_far(motion.end.translation().cast<float>(), config_.map.radius_m);
  history_.add(motion);
  path_.add(motion.end, times.last, times);
  ++scans_;
  return inserted;
}

}  // namespace lidarena::odometry::ct_icp
