// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/lio_sam.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "lidarena/base/so3.hpp"
#include "lidarena/odometry/lio_sam/initialization.hpp"
#include "lidarena/odometry/lio_sam/range_image.hpp"

namespace lidarena::odometry::lio_sam {
namespace {

constexpr std::size_t kStartSamples = 10;    // minimum number of IMU samples for initialization
constexpr Time kStartMemory{1'000'000'000};  // maximum age of these samples
constexpr double kMaxSpeed = 30.0;           // m/s; beyond this the smoother has failed
constexpr double kMaxBias = 1.0;             // m/s^2, rad/s; likewise

estimation::ImuNoise configured_noise(const ImuInfo& imu, const Config& config) {
  if (config.imu_noise_factor > 0.0) return estimation::noise_of(imu, config.imu_noise_factor);
  return {config.gyro_noise_density, config.accel_noise_density, config.gyro_bias_walk,
          config.accel_bias_walk};
}

Pose rotation_of(const Pose& pose) {
  return make_pose(Eigen::Matrix3d(pose.linear()), Eigen::Vector3d::Zero());
}

}  // namespace

LioSam::LioSam(const Config& config, const LidarInfo& lidar, const ImuInfo& imu, Parallel parallel)
    : config_(config),
      body_from_imu_(imu.body_from_imu),
      body_from_lidar_(lidar.body_from_lidar),
      imu_from_lidar_(imu.body_from_imu.inverse() * lidar.body_from_lidar),
      noise_(configured_noise(imu, config)),
      parallel_(std::move(parallel)),
      imu_(config.max_imu_gap_s),
      scan_duration_(from_seconds(1.0 / lidar.rate_hz)),
      pending_(estimation::ImuBias{}, noise_),
      submap_(config),
      closer_(config.loop, parallel_) {}

ScanResult LioSam::register_scan(const Scan& scan) {
  const Time end = scan_end(scan);
  const ScanStatus unused =
      scan.points.empty() ? ScanStatus::kTooFewPoints : ScanStatus::kInitializing;
  if (!started_ && !start(scan.stamp, end))
    return finish_scan(scan.stamp, body_from_lidar_, unused, {});
  const Prediction prediction = predict(scan.stamp, end);
  if (!is_due(scan.stamp))
    return result_of(scan.stamp, prediction.world_from_lidar, ScanStatus::kTracked, {});

  const RangeImage image = project(scan, deskewed(scan, prediction), config_);
  const Features raw = extract_features(image, config_, parallel_);
  Features features = thinned(raw, config_);

  Registration found = match(features, prediction.world_from_lidar, scan.stamp);
  const ScanStatus status = status_of(found, features);
  const bool matched = status == ScanStatus::kTracked || status == ScanStatus::kDegenerate;
  const bool first = keyframes_.empty() && status == ScanStatus::kInitializing;
  const ScanCounters counters{.points = image.pixels.size(),
                              .keypoints = features.edges.size() + features.surfaces.size(),
                              .matches = found.points.count,
                              .edges = raw.edges.size(),
                              .surfaces = raw.surfaces.size(),
                              .iterations = found.iterations,
                              .degenerate_directions = found.degenerate_directions,
                              .map_points = submap_.size()};
  if (matched) fuse(found);
  last_mapped_ = scan.stamp;
  Pose world_from_lidar = found.map_from_lidar;
  if (matched || first) keep(scan.stamp, world_from_lidar, std::move(features));
  return finish_scan(scan.stamp, world_from_lidar, status, counters);
}

Time LioSam::scan_end(const Scan& scan) {
  if (scan.timed && !scan.points.empty()) scan_duration_ = end_of(scan) - scan.stamp;
  return scan.timed ? scan.stamp + scan_duration_ : scan.stamp;
}

bool LioSam::start(Time stamp, Time end) {
  imu_.remove_before(end - kStartMemory);
  const std::vector<ImuSample> samples = imu_.samples(end - kStartMemory, end);
  if (samples.size() < kStartSamples) return false;
  const Start begin = start_from(samples, body_from_imu_, config_);
  smoother_.start(begin.inertial);
  accel_scale_ = begin.accel_scale;
  pending_ = empty_preintegration();
  integrated_until_ = stamp;
  odom_from_lidar_ = begin.inertial.state.world_from_imu * imu_from_lidar_;
  world_from_lidar_ = odom_from_lidar_;
  started_ = true;
  return true;
}

bool LioSam::is_due(Time stamp) const {
  return !last_mapped_ || to_seconds(stamp - *last_mapped_) >= config_.process_interval_s;
}

LioSam::Prediction LioSam::predict(Time stamp, Time end) {
  longest_gap_s_ = 0.0;
  const estimation::NavState& last = smoother_.latest();
  integrate(imu_.between(integrated_until_, stamp), last, pending_, nullptr);
  integrated_until_ = std::max(integrated_until_, stamp);
  imu_.remove_before(stamp);
  const estimation::NavState now = pending_.predict(last, smoother_.gravity());
  const Pose last_from_now = last.world_from_imu.inverse() * now.world_from_imu;

  Prediction prediction;
  prediction.world_from_lidar =
      world_from_lidar_ * imu_from_lidar_.inverse() * last_from_now * imu_from_lidar_;
  prediction.track_from_imu = now.world_from_imu;
  estimation::NavState within = now;
  if (!config_.deskew_bias) within.bias.gyro.setZero();
  estimation::Preintegration sum(within.bias, noise_);
  integrate(imu_.between(stamp, end), within, sum, &prediction.track);
  return prediction;
}

void LioSam::integrate(const std::vector<estimation::ImuInterval>& intervals,
                       const estimation::NavState& state, estimation::Preintegration& sum,
                       estimation::ImuTrack* track) {
  const Eigen::Vector3d& gravity = smoother_.gravity();
  for (const estimation::ImuInterval& interval : intervals) {
    const estimation::NavState now = sum.predict(state, gravity);
    const Eigen::Matrix3d rotation = now.world_from_imu.linear();
    Eigen::Vector3d accel = accel_scale_ * interval.accel;
    if (interval.gap) {  // coast with constant velocity
      accel = state.bias.accel - rotation.transpose() * gravity;
      longest_gap_s_ = std::max(longest_gap_s_, interval.seconds());
    }
    if (track != nullptr) {
      track->push_back({interval.begin, now.world_from_imu, now.velocity,
                        rotation * (accel - state.bias.accel) + gravity,
                        interval.gyro - state.bias.gyro});
    }
    sum.integrate(interval.gyro, accel, interval.seconds(),
                  interval.gap ? estimation::kCoastingNoise : noise_);
  }
}

std::vector<Eigen::Vector3f> LioSam::deskewed(const Scan& scan,
                                              const Prediction& prediction) const {
  if (config_.deskew_translation)
    return estimation::deskew(scan, prediction.track, imu_from_lidar_, prediction.track_from_imu,
                              parallel_);
  estimation::ImuTrack rotation_track =
      prediction.track;  // rotation about the LiDAR, without translation
  for (estimation::ImuStep& step : rotation_track) {
    step.world_from_imu = rotation_of(step.world_from_imu);
    step.velocity.setZero();
    step.acceleration.setZero();
  }
  return estimation::deskew(scan, rotation_track, rotation_of(imu_from_lidar_),
                            rotation_of(prediction.track_from_imu), parallel_);
}

Registration LioSam::match(const Features& features, const Pose& guess, Time stamp) {
  Registration none;
  none.map_from_lidar = guess;
  const bool enough = features.edges.size() >= static_cast<std::size_t>(config_.min_edges) &&
                      features.surfaces.size() >= static_cast<std::size_t>(config_.min_surfaces);
  if (keyframes_.empty() || !enough) return none;
  const Eigen::Vector3d here = keyframes_.back().world_from_lidar.translation();
  submap_.select(keyframes_, surrounding(keyframes_, here, stamp, config_));
  return register_features(features, submap_.map(), guess, config_, parallel_);
}

ScanStatus LioSam::status_of(const Registration& found, const Features& features) const {
  if (!found.map_from_lidar.matrix().allFinite() ||
      !(smoother_.latest().velocity.norm() < estimation::kMaxPlausibleSpeed))
    return ScanStatus::kDiverged;
  if (features.surfaces.empty()) return ScanStatus::kTooFewPoints;
  if (keyframes_.empty()) return ScanStatus::kInitializing;
  if (found.points.count == 0) return ScanStatus::kTooFewPoints;
  return found.degenerate_directions > 0 ? ScanStatus::kDegenerate : ScanStatus::kTracked;
}

void LioSam::fuse(Registration& found) {
  const Pose odom_from_world = odom_from_lidar_ * world_from_lidar_.inverse();
  odom_from_lidar_ = orthonormalized(odom_from_world * found.map_from_lidar);
  const Pose odom_from_imu = odom_from_lidar_ * imu_from_lidar_.inverse();
  smoother_.add(pending_, {odom_from_imu, information_of(found, odom_from_imu)});
  restart_if_failed();
  if (config_.smoothed_pose) {
    odom_from_lidar_ = smoother_.latest().world_from_imu * imu_from_lidar_;
    found.map_from_lidar = orthonormalized(odom_from_world.inverse() * odom_from_lidar_);
  }
  world_from_lidar_ = found.map_from_lidar;
  pending_ = empty_preintegration();
}

estimation::PoseMeasurement::Information LioSam::information_of(const Registration& found,
                                                                const Pose& odom_from_imu) const {
  using Matrix6 = estimation::PoseMeasurement::Information;
  const auto squared = [](double x) { return x * x; };
  Matrix6 min_covariance = Matrix6::Zero();  // covariance
  const bool all_or_nothing = config_.point_sigma_m <= 0.0 && found.degenerate_directions > 0;
  min_covariance.diagonal().head<3>().setConstant(
      all_or_nothing ? 1.0 : squared(config_.min_rotation_sigma_rad));
  min_covariance.diagonal().tail<3>().setConstant(
      all_or_nothing ? 1.0 : squared(config_.min_translation_sigma_m));
  if (config_.point_sigma_m <= 0.0) return min_covariance.inverse();

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

void LioSam::restart_if_failed() {
  const estimation::NavState& state = smoother_.latest();
  if (state.velocity.norm() < kMaxSpeed && state.bias.accel.norm() < kMaxBias &&
      state.bias.gyro.norm() < kMaxBias)
    return;
  estimation::InertialStart again;
  again.state.world_from_imu = odom_from_lidar_ * imu_from_lidar_.inverse();
  again.gravity = smoother_.gravity();
  again.gravity_sigma = config_.gravity_sigma_rad;
  again.covariance.diagonal().segment<3>(estimation::NavState::kVelocity).setConstant(9.0);
  smoother_.start(again);
  ++restarts_;
}

void LioSam::keep(Time stamp, Pose& world_from_lidar, Features features) {
  if (merge(stamp, world_from_lidar, features)) return;
  const Pose previous_from_this =
      keyframes_.empty() ? world_from_lidar
                         : keyframes_.back().world_from_lidar.inverse() * world_from_lidar;
  poses_.add_anchor(stamp, previous_from_this);
  merger_.begin(features);
  keyframes_.push_back({stamp, world_from_lidar, std::move(features), 0});
  if (!config_.loop_closure) return;
  const bool moved = closer_.add(stamp, previous_from_this, [this](std::size_t keyframe) {
    return std::span<const Eigen::Vector3f>(keyframes_[keyframe].features.surfaces);
  });
  if (!moved) return;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    keyframes_[i].world_from_lidar = closer_.poses()[i];
    ++keyframes_[i].revision;
  }
  world_from_lidar = keyframes_.back().world_from_lidar;
  world_from_lidar_ = world_from_lidar;  // corrected pose of the scan just registered
}

bool LioSam::merge(Time stamp, const Pose& world_from_lidar, const Features& features) {
  if (keyframes_.empty()) return false;
  Keyframe& last = keyframes_.back();
  const bool due = is_keyframe(last, stamp, world_from_lidar, config_);
  const bool renew =
      due ? config_.scans_per_keyframe > 1
          : merger_.add(features, last.world_from_lidar.inverse() * world_from_lidar, config_);
  if (renew) {
    last.features = merger_.merged(config_);
    ++last.revision;
  }
  return !due;
}

ScanResult LioSam::finish_scan(Time stamp, const Pose& world_from_lidar, ScanStatus status,
                               const ScanCounters& counters) {
  if (status != ScanStatus::kDiverged) {
    poses_.add(stamp, keyframes_.empty()
                          ? world_from_lidar
                          : keyframes_.back().world_from_lidar.inverse() * world_from_lidar);
  }
  return result_of(stamp, world_from_lidar, status, counters);
}

ScanResult LioSam::result_of(Time stamp, const Pose& world_from_lidar, ScanStatus status,
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

Trajectory LioSam::trajectory() const {
  std::vector<Pose> anchors;
  for (const Keyframe& keyframe : keyframes_) anchors.push_back(keyframe.world_from_lidar);
  std::vector<StampedPose> poses = poses_.placed(anchors);
  const Pose lidar_from_body = body_from_lidar_.inverse();
  for (StampedPose& pose : poses)
    pose.world_from_body = orthonormalized(pose.world_from_body * lidar_from_body);
  return Trajectory(std::move(poses), "lio_sam");
}

std::vector<Eigen::Vector3f> LioSam::map() const {
  std::vector<Eigen::Vector3f> points;
  for (const Keyframe& keyframe : keyframes_) {
    append_transformed(keyframe.world_from_lidar, keyframe.features.edges, points);
    append_transformed(keyframe.world_from_lidar, keyframe.features.surfaces, points);
  }
  return points;
}

std::map<std::string, std::uint64_t> LioSam::memory() const {
  std::uint64_t kept = 0;
  for (const Keyframe& keyframe : keyframes_)
    kept += sizeof(Keyframe) +
            (keyframe.features.edges.capacity() + keyframe.features.surfaces.capacity()) *
                sizeof(Eigen::Vector3f);
  return {{"map", kept + submap_.memory_bytes()},
          {"scan_buffer", 0},
          {"backlog", imu_.memory_bytes()},
          {"other", poses_.memory_bytes() + closer_.memory_bytes()}};
}

}  // namespace lidarena::odometry::lio_sam
