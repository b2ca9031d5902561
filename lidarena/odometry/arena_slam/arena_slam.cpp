// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_slam/arena_slam.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "lidarena/base/so3.hpp"
#include "lidarena/odometry/arena_slam/initialization.hpp"

namespace lidarena::odometry::arena_slam {
namespace {

constexpr std::size_t kStartSamples = 10;    // minimum number of IMU samples for initialization
constexpr Time kStartMemory{1'000'000'000};  // maximum age of these samples
constexpr double kMaxImuGap = 0.05;          // s; longer gaps between samples are coasted
constexpr std::size_t kMinSurfaces = 100;    // a scan with fewer is not registered
constexpr double kMaxSpeed = 30.0;           // m/s; beyond this the smoother has failed
constexpr double kMaxBias = 1.0;             // m/s^2, rad/s; likewise
constexpr double kRestartVariance = 9.0;     // m^2/s^2, of the velocity after a restart
constexpr double kMinRotationSigma = 1e-3;   // rad, of a registered rotation in the smoother
constexpr double kMinPositionSigma = 5e-3;   // m, likewise of a position
constexpr int kLivoxIterations = 25;         // maximum for patterns that do not repeat

RegistrationLimits limits_for(const FeatureRule& rule, const Config& config) {
  RegistrationLimits limits;
  limits.max_plane_thickness_m = config.max_plane_thickness_m;
  if (!rule.layout.by_azimuth) limits.max_iterations = kLivoxIterations;
  return limits;
}

}  // namespace

ArenaSlam::ArenaSlam(const Config& config, const LidarInfo& lidar, const ImuInfo& imu,
                     Parallel parallel)
    : config_(config),
      body_from_imu_(imu.body_from_imu),
      body_from_lidar_(lidar.body_from_lidar),
      imu_from_lidar_(imu.body_from_imu.inverse() * lidar.body_from_lidar),
      noise_(estimation::noise_of(imu, config.imu_noise_factor)),
      rule_(feature_rule(lidar, config)),
      limits_(limits_for(rule_, config)),
      parallel_(std::move(parallel)),
      imu_(kMaxImuGap),
      scan_duration_(from_seconds(1.0 / lidar.rate_hz)),
      pending_(estimation::ImuBias{}, noise_),
      submap_(feature_voxels(config)),
      closer_(config.loop, parallel_) {}

ScanResult ArenaSlam::register_scan(const Scan& scan) {
  const Time end = scan_end(scan);
  const ScanStatus unused =
      scan.points.empty() ? ScanStatus::kTooFewPoints : ScanStatus::kInitializing;
  if (!started_ && !start(scan.stamp, end))
    return finish_scan(scan.stamp, body_from_lidar_, unused, {});
  const Prediction prediction = predict(scan.stamp, end);
  if (scan.stamp < last_stamp_)
    return result_of(scan.stamp, prediction.world_from_lidar, ScanStatus::kTracked, {});

  const estimation::RangeImage image =
      estimation::project(scan,
                          estimation::deskew(scan, prediction.track, imu_from_lidar_,
                                             prediction.track_from_imu, parallel_),
                          rule_.layout);
  const map::Features raw = extract_features(image, rule_, parallel_);
  map::Features features = map::thinned(raw, feature_voxels(config_));

  Registration found = match(features, prediction.world_from_lidar, scan.stamp);
  const ScanStatus status = status_of(found, features);
  const ScanCounters counters = counters_of(image, raw, features, found);
  const bool matched = status == ScanStatus::kTracked || status == ScanStatus::kDegenerate;
  const bool first = keyframes_.empty() && status == ScanStatus::kInitializing;
  if (matched) fuse(found);
  last_stamp_ = scan.stamp;
  Pose world_from_lidar = found.map_from_lidar;
  if (matched || first) keep(scan.stamp, world_from_lidar, std::move(features));
  ScanResult result = finish_scan(scan.stamp, world_from_lidar, status, counters);
  if (status != ScanStatus::kDiverged)
    result.motion = estimation::motion_along(prediction.track, scan.stamp, end, scan.stamp,
                                             world_from_lidar * imu_from_lidar_.inverse(),
                                             body_from_imu_.inverse());
  return result;
}

ScanCounters ArenaSlam::counters_of(const estimation::RangeImage& image, const map::Features& raw,
                                    const map::Features& features,
                                    const Registration& found) const {
  return {.points = image.pixels.size(),
          .keypoints = features.edges.size() + features.surfaces.size(),
          .matches = found.points.count,
          .edges = raw.edges.size(),
          .surfaces = raw.surfaces.size(),
          .iterations = found.iterations,
          .degenerate_directions = found.degenerate_directions,
          .map_points = submap_.size()};
}

Time ArenaSlam::scan_end(const Scan& scan) {
  if (scan.timed && !scan.points.empty()) scan_duration_ = end_of(scan) - scan.stamp;
  return scan.timed ? scan.stamp + scan_duration_ : scan.stamp;
}

bool ArenaSlam::start(Time stamp, Time end) {
  imu_.remove_before(end - kStartMemory);
  const std::vector<ImuSample> samples = imu_.samples(end - kStartMemory, end);
  if (samples.size() < kStartSamples) return false;
  const Start begin = start_from(samples, body_from_imu_, config_.gravity);
  smoother_.start(begin.inertial);
  accel_scale_ = begin.accel_scale;
  pending_ = empty_preintegration();
  integrated_until_ = stamp;
  odom_from_lidar_ = begin.inertial.state.world_from_imu * imu_from_lidar_;
  world_from_lidar_ = odom_from_lidar_;
  started_ = true;
  return true;
}

ArenaSlam::Prediction ArenaSlam::predict(Time stamp, Time end) {
  const estimation::NavState& last = smoother_.latest();
  const std::vector<estimation::ImuInterval> before = imu_.between(integrated_until_, stamp);
  estimation::integrate(before, last, imu_model(), pending_);
  integrated_until_ = std::max(integrated_until_, stamp);
  imu_.remove_before(stamp);
  const estimation::NavState now = pending_.predict(last, smoother_.gravity());
  const Pose last_from_now = last.world_from_imu.inverse() * now.world_from_imu;

  Prediction prediction;
  prediction.world_from_lidar =
      world_from_lidar_ * imu_from_lidar_.inverse() * last_from_now * imu_from_lidar_;
  prediction.track_from_imu = now.world_from_imu;
  estimation::Preintegration sum(now.bias, noise_);
  const std::vector<estimation::ImuInterval> within = imu_.between(stamp, end);
  prediction.track = estimation::integrate(within, now, imu_model(), sum);
  longest_gap_s_ = std::max(estimation::longest_gap_s(before), estimation::longest_gap_s(within));
  return prediction;
}

Registration ArenaSlam::match(const map::Features& features, const Pose& guess, Time stamp) {
  Registration none;
  none.map_from_lidar = guess;
  if (keyframes_.empty() || features.surfaces.size() < kMinSurfaces) return none;
  submap_.follow(
      keyframes_, stamp,
      {config_.submap_radius_m, config_.submap_keyframe_spacing_m, config_.submap_recent_s});
  return register_features(features, submap_, guess, limits_, parallel_);
}

ScanStatus ArenaSlam::status_of(const Registration& found, const map::Features& features) const {
  if (!found.map_from_lidar.matrix().allFinite() ||
      !(smoother_.latest().velocity.norm() < estimation::kMaxPlausibleSpeed))
    return ScanStatus::kDiverged;
  if (features.surfaces.empty()) return ScanStatus::kTooFewPoints;
  if (keyframes_.empty()) return ScanStatus::kInitializing;
  if (found.points.count == 0) return ScanStatus::kTooFewPoints;
  return found.degenerate_directions > 0 ? ScanStatus::kDegenerate : ScanStatus::kTracked;
}

void ArenaSlam::fuse(Registration& found) {
  const Pose odom_from_world = odom_from_lidar_ * world_from_lidar_.inverse();
  odom_from_lidar_ = orthonormalized(odom_from_world * found.map_from_lidar);
  const Pose odom_from_imu = odom_from_lidar_ * imu_from_lidar_.inverse();
  smoother_.add(pending_, {odom_from_imu, information_of(found, odom_from_imu)});
  restart_if_failed();
  odom_from_lidar_ = smoother_.latest().world_from_imu * imu_from_lidar_;
  found.map_from_lidar = orthonormalized(odom_from_world.inverse() * odom_from_lidar_);
  world_from_lidar_ = found.map_from_lidar;
  pending_ = empty_preintegration();
}

estimation::PoseMeasurement::Information ArenaSlam::information_of(
    const Registration& found, const Pose& odom_from_imu) const {
  using Matrix6 = estimation::PoseMeasurement::Information;
  const auto squared = [](double x) { return x * x; };
  Matrix6 min_covariance = Matrix6::Zero();
  min_covariance.diagonal().head<3>().setConstant(squared(kMinRotationSigma));
  min_covariance.diagonal().tail<3>().setConstant(squared(kMinPositionSigma));

  // Jacobian of the errors of the registered LiDAR pose by those of the IMU's pose.
  const Eigen::Matrix3d world_from_odom =
      found.map_from_lidar.linear() * odom_from_lidar_.linear().transpose();
  const Eigen::Matrix3d world_from_imu = world_from_odom * odom_from_imu.linear();
  Matrix6 by_imu = Matrix6::Zero();
  by_imu.topLeftCorner<3, 3>() = world_from_imu;
  by_imu.bottomLeftCorner<3, 3>() = -world_from_imu * so3::hat(imu_from_lidar_.translation());
  by_imu.bottomRightCorner<3, 3>() = world_from_odom;
  const Matrix6 points =
      by_imu.transpose() * found.points.hessian * by_imu / squared(config_.point_sigma_m);
  return points * (Matrix6::Identity() + min_covariance * points).inverse();
}

void ArenaSlam::restart_if_failed() {
  const estimation::NavState& state = smoother_.latest();
  if (state.velocity.norm() < kMaxSpeed && state.bias.accel.norm() < kMaxBias &&
      state.bias.gyro.norm() < kMaxBias)
    return;
  estimation::InertialStart again;
  again.state.world_from_imu = odom_from_lidar_ * imu_from_lidar_.inverse();
  again.gravity = smoother_.gravity();
  again.gravity_sigma = kGravitySigma;
  again.covariance.diagonal()
      .segment<3>(estimation::NavState::kVelocity)
      .setConstant(kRestartVariance);
  smoother_.start(again);
  ++restarts_;
}

void ArenaSlam::keep(Time stamp, Pose& world_from_lidar, map::Features features) {
  if (merge(world_from_lidar, features)) return;
  const Pose previous_from_this =
      keyframes_.empty() ? world_from_lidar
                         : keyframes_.back().world_from_lidar.inverse() * world_from_lidar;
  poses_.add_anchor(stamp, previous_from_this);
  merger_.begin(features);
  keyframes_.push_back({stamp, world_from_lidar, std::move(features), 0});
  const bool moved = closer_.add(stamp, previous_from_this, [this](std::size_t keyframe) {
    return std::span<const Eigen::Vector3f>(keyframes_[keyframe].features.surfaces);
  });
  if (!moved) return;
  map::move_to(closer_.poses(), keyframes_);
  world_from_lidar = keyframes_.back().world_from_lidar;
  world_from_lidar_ = world_from_lidar;  // corrected pose of the scan just registered
}

bool ArenaSlam::merge(const Pose& world_from_lidar, const map::Features& features) {
  if (keyframes_.empty()) return false;
  map::Keyframe& last = keyframes_.back();
  const bool due = map::has_moved(last, world_from_lidar, config_.keyframe_translation_m,
                                  config_.keyframe_rotation_rad);
  const bool renew =
      due ? config_.scans_per_keyframe > 1
          : merger_.add(features, last.world_from_lidar.inverse() * world_from_lidar, config_);
  if (renew) {
    last.features = merger_.merged(config_);
    ++last.revision;
  }
  return !due;
}

ScanResult ArenaSlam::finish_scan(Time stamp, const Pose& world_from_lidar, ScanStatus status,
                                  const ScanCounters& counters) {
  if (status != ScanStatus::kDiverged) {
    poses_.add(stamp, keyframes_.empty()
                          ? world_from_lidar
                          : keyframes_.back().world_from_lidar.inverse() * world_from_lidar);
  }
  return result_of(stamp, world_from_lidar, status, counters);
}

ScanResult ArenaSlam::result_of(Time stamp, const Pose& world_from_lidar, ScanStatus status,
                                const ScanCounters& counters) const {
  ScanResult result;
  result.estimate = {stamp, orthonormalized(world_from_lidar * body_from_lidar_.inverse())};
  result.status = status;
  result.counters = counters;
  result.counters.imu_gap_s = longest_gap_s_;
  result.counters.imu_refused = imu_.refused();
  result.counters.imu_restarts = restarts_;
  result.counters.accel_scale = accel_scale_;
  result.counters.keyframes = keyframes_.size();
  result.counters.loops = closer_.accepted();
  result.counters.loops_tried = closer_.records().size();
  return result;
}

Trajectory ArenaSlam::trajectory() const {
  std::vector<Pose> anchors;
  for (const map::Keyframe& keyframe : keyframes_) anchors.push_back(keyframe.world_from_lidar);
  std::vector<StampedPose> poses = poses_.placed(anchors);
  const Pose lidar_from_body = body_from_lidar_.inverse();
  for (StampedPose& pose : poses)
    pose.world_from_body = orthonormalized(pose.world_from_body * lidar_from_body);
  return Trajectory(std::move(poses), "arena_slam");
}

std::map<std::string, std::uint64_t> ArenaSlam::memory() const {
  return {{"map", map::memory_bytes(keyframes_) + submap_.memory_bytes()},
          {"scan_buffer", 0},
          {"backlog", imu_.memory_bytes()},
          {"other", poses_.memory_bytes() + closer_.memory_bytes()}};
}

}  // namespace lidarena::odometry::arena_slam
