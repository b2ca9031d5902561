// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/ct_icp/ct_icp.hpp"

#include <algorithm>
#include <utility>

#include "lidarena/odometry/tracking.hpp"

namespace lidarena::odometry::ct_icp {

namespace {

constexpr int kRigidScans = 2;          // at the start, registered without motion within the scan
constexpr int kInitialIterations = 15;  // at least, for the first initial_scans
constexpr double kDegenerate = 0.01;    // share of a direction in the information; isotropic: 1/3

}  // namespace

CtIcp::CtIcp(const Config& config, const LidarInfo& lidar, Parallel parallel)
    : config_(config),
      parallel_(std::move(parallel)),
      map_({config.map.voxel_size_m, config.map.max_points_per_voxel,
            config.map.min_point_spacing_m, map::VoxelRounding::kTruncate}),
      path_(lidar),
      robust_(config.robust) {}

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
  const Attempts aligned = align(frame);
  const Registration& found = aligned.found;
  const ScanStatus status = status_of(found, points.size());
  ended_ = status == ScanStatus::kDiverged;
  if (ended_) return ended();
  const bool inserted = advance(aligned, frame, times);

  registered_scan_ = placed(path_.body_from_lidar(), found.motion, points, parallel_);
  return {.estimate = path_.poses().back(),
          .status = status,
          .counters = {.points = points.size()},
          .motion = rigid ? std::vector<StampedPose>{}
                          : body_poses(found.motion, times, path_.body_from_lidar()),
          .details = {{"keypoints", aligned.keypoints},
                      {"matches", found.matches},
                      {"iterations", found.iterations},
                      {"map_points", map_.size()},
                      {"inserted", inserted},
                      {"attempts", aligned.count}}};
}

CtIcp::Attempts CtIcp::align(std::span<const TimedPoint> frame) const {
  const RobustConfig& robust = config_.robust;
  Settings settings{config_.sampling, config_.registration};
  // the program raises the iterations of the first scans in each attempt anew
  const auto start = [&] {
    int& iterations = settings.registration.max_iterations;
    if (starting()) iterations = std::max(iterations, kInitialIterations);
  };
  const int first_level = robust.enabled ? robust_.first_level() : 0;
  for (int level = 0; level < first_level; ++level)
    settings = more_careful(settings, config_.sampling);
  Attempts aligned;
  while (true) {
    start();
    const auto keypoints = sample_keypoints(frame, settings.sampling, starting());
    aligned.found = align(keypoints, settings.registration);
    aligned.keypoints = keypoints.size();
    ++aligned.count;
    const bool trusted =
        !robust.enabled || map_.empty() ||
        (!aligned.found.failed &&
         robust_.trusts(aligned.found.motion, history_.last_end(), config_.registration));
    if (trusted || aligned.count >= robust.attempts) return aligned;
    settings = more_careful(settings, config_.sampling);
  }
}

Registration CtIcp::align(std::span<const TimedPoint> keypoints,
                          const RegistrationConfig& settings) const {
  const Expectation expected{history_.predict(config_.registration.initial_motion),
                             history_.prior(config_.prior)};
  if (map_.empty()) return {expected.guess};
  return register_keypoints(keypoints, map_, expected, settings, parallel_);
}

ScanStatus CtIcp::status_of(const Registration& found, std::size_t points) const {
  if (points == 0) return ScanStatus::kTooFewPoints;
  if (map_.empty()) return ScanStatus::kInitializing;
  // the robust registration accepts the motion of its last attempt, however large
  const bool accepted =
      config_.robust.enabled
          ? found.motion.begin.matrix().allFinite() && found.motion.end.matrix().allFinite()
          : is_plausible(found.motion, history_.last_end(), config_.registration);
  if (found.failed || !accepted) return ScanStatus::kDiverged;
  return found.observability < kDegenerate ? ScanStatus::kDegenerate : ScanStatus::kTracked;
}

bool CtIcp::advance(const Attempts& aligned, std::span<const TimedPoint> frame,
                    const estimation::ScanTimes& times) {
  const ElasticMotion& motion = aligned.found.motion;
  const auto admits = [&] {
    return config_.robust.enabled ? robust_.admits(motion, history_.last_end(), aligned.count)
                                  : gate_.admits(motion);
  };
  const bool inserted = !frame.empty() && (admits() || config_.map.always_insert);
  if (inserted) map_.insert(placed(Pose::Identity(), motion, frame, parallel_));
  map_.remove_far(motion.end.translation().cast<float>(), config_.map.radius_m);
  history_.add(motion);
  path_.add(motion.end, times.last, times);
  ++scans_;
  return inserted;
}

}  // namespace lidarena::odometry::ct_icp
