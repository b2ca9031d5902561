// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/ct_icp.hpp"

#include <algorithm>
#include <utility>

namespace lidarena::odometry::ct_icp {

namespace {

constexpr double kDegenerate = 0.01;  // minimum share of a direction; isotropic: 1/3
constexpr std::size_t kGrain = 2048;  // points per task: about 0.1 ms of work

std::vector<Eigen::Vector3f> placed(const estimation::ElasticMotion& motion,
                                    std::span<const TimedPoint> points, const Parallel& parallel) {
  const estimation::ElasticTrack track(motion);
  std::vector<Eigen::Vector3f> positions(points.size());
  parallel.for_each(points.size(), kGrain, [&](std::size_t i) {
    const Eigen::Vector3d point = points[i].position.cast<double>();
    positions[i] = track.place(point, points[i].alpha).cast<float>();
  });
  return positions;
}

estimation::ElasticMotion moved(const Pose& by, estimation::ElasticMotion motion) {
  for (Pose& knot : motion.knots) knot = by * knot;
  return motion;
}

}  // namespace

CtIcp::CtIcp(const Config& config, const LidarInfo& lidar, Parallel parallel)
    : config_(config),
      body_from_lidar_(lidar.body_from_lidar),
      parallel_(std::move(parallel)),
      map_({config.map.voxel_size_m, config.map.max_points_per_voxel,
            config.map.min_point_spacing_m, config.voxel_rounding}),
      gate_(config.insertion),
      scan_duration_(from_seconds(1.0 / lidar.rate_hz)) {}

ScanResult CtIcp::register_scan(const Scan& scan) {
  const estimation::ScanTimes times = estimation::times_of(scan, scan_duration_);
  const bool rigid = !times.timed || map_.empty() || scans_ < config_.sampling.rigid_scans;
  const auto points = timed_points(scan, times, rigid, config_.sampling);
  const double voxel =
      starting() ? config_.sampling.initial_scan_voxel_size_m : config_.sampling.scan_voxel_size_m;
  const auto frame = thin(points, voxel, config_.voxel_rounding);

  const estimation::ElasticMotion guess = history_.predict(times, config_.registration);
  const RobustRegistration found = align(frame, guess);
  const estimation::ElasticMotion& motion = found.registration.motion;
  const ScanStatus status = status_of(found, points.size());

  const bool inserted = status != ScanStatus::kTooFewPoints && gate_.admits(motion, found.verdict);
  if (inserted) map_.insert(placed(motion, frame, parallel_));
  map_.remove_far(motion.end().translation().cast<float>(), config_.map.radius_m);

  advance(found, times, status);
  registered_scan_ = placed(moved(body_from_lidar_, motion), points, parallel_);
  return {poses_.back(),
          status,
          std::nullopt,
          {.points = points.size(),
           .keypoints = found.registration.keypoints,
           .matches = found.registration.matches,
           .iterations = found.registration.iterations,
           .retry_level = found.level,
           .map_points = map_.size(),
           .inserted = inserted},
          rigid ? std::vector<StampedPose>{} : motion_within(motion, times)};
}

RobustRegistration CtIcp::align(std::span<const TimedPoint> frame,
                                const estimation::ElasticMotion& guess) {
  RobustRegistration found{{guess}};
  if (map_.empty() || frame.empty()) return found;
  const estimation::MotionPrior prior = history_.prior(guess, config_.registration, config_.prior);
  found =
      register_robustly(frame, map_, guess, prior, config_, starting(), first_level_, parallel_);
  const bool lost = found.verdict == Verdict::kLost;
  if (lost && !(stops_when_lost(found))) found.registration.motion = guess;
  return found;
}

ScanStatus CtIcp::status_of(const RobustRegistration& found, std::size_t points) const {
  if (points == 0) return ScanStatus::kTooFewPoints;
  if (map_.empty()) return ScanStatus::kInitializing;
  if (found.verdict == Verdict::kLost)
    return stops_when_lost(found) ? ScanStatus::kDiverged : ScanStatus::kTooFewPoints;
  return found.registration.observability < kDegenerate ? ScanStatus::kDegenerate
                                                        : ScanStatus::kTracked;
}

bool CtIcp::stops_when_lost(const RobustRegistration& found) const {
  return config_.robust.stop_when_lost && found.registration.enough;
}

void CtIcp::advance(const RobustRegistration& found, const estimation::ScanTimes& times,
                    ScanStatus status) {
  const estimation::ElasticMotion& motion = found.registration.motion;
  const bool lost = status == ScanStatus::kTooFewPoints;
  history_.add(motion, times, lost, config_.robust.lost_motion_factor);
  first_level_ = found.verdict == Verdict::kTrusted || !config_.robust.enabled ? 0 : 1;
  if (times.timed) scan_duration_ = times.last - times.first;
  poses_.push_back({times.last, body_pose(motion.end())});
  ++scans_;
}

std::vector<StampedPose> CtIcp::motion_within(const estimation::ElasticMotion& motion,
                                              const estimation::ScanTimes& times) const {
  std::vector<StampedPose> poses;
  const auto segments = static_cast<std::int64_t>(motion.segments());
  for (std::int64_t i = 0; i <= segments; ++i) {
    const Time instant = times.first + (times.last - times.first) * i / segments;
    poses.push_back({instant, body_pose(motion.knots[static_cast<std::size_t>(i)])});
  }
  return poses;
}

Pose CtIcp::body_pose(const Pose& map_from_lidar) const {
  return body_from_lidar_ * map_from_lidar * body_from_lidar_.inverse();
}

std::vector<Eigen::Vector3f> CtIcp::map() const {
  return transformed(body_from_lidar_, map_.points());
}

std::map<std::string, std::uint64_t> CtIcp::memory() const {
  return {{"map", map_.memory_bytes()},
          {"scan_buffer", registered_scan_.capacity() * sizeof(Eigen::Vector3f)},
          {"backlog", 0},
          {"other", poses_.capacity() * sizeof(StampedPose)}};
}

}  // namespace lidarena::odometry::ct_icp
