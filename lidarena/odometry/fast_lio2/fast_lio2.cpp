// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/fast_lio2.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "lidarena/base/so3.hpp"
#include "lidarena/map/voxel_filter.hpp"
#include "lidarena/odometry/fast_lio2/plane_residuals.hpp"

namespace lidarena::odometry::fast_lio2 {
namespace {

using State = estimation::InertialState;

constexpr double kStillSpeedSigma = 0.01;        // m/s, of the zero velocity at a standstill
constexpr double kStillTranslationSigma = 1e-4;  // m, of the held first pose
constexpr double kStillRotationSigma = 1e-5;     // rad, likewise
constexpr int kLostScans = 15;        // in a row that contradict the map: tracking is lost
constexpr double kDegenerate = 0.01;  // minimum share of a direction; isotropic: 1/3

/// At most `most` of the points, at even intervals of their order.
std::vector<Eigen::Vector3f> evenly(std::vector<Eigen::Vector3f> points, int most) {
  const auto count = static_cast<std::size_t>(most);
  if (points.size() <= count) return points;
  for (std::size_t i = 0; i < count; ++i) points[i] = points[i * points.size() / count];
  points.resize(count);
  return points;
}

Eigen::Matrix3d orthonormal(const Eigen::Matrix3d& rotation) {
  return Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
}

}  // namespace

FastLio2::FastLio2(const Config& config, const LidarInfo& lidar, const ImuInfo& imu,
                   Parallel parallel)
    : config_(config),
      body_from_imu_(imu.body_from_imu),
      map_from_start_(map::grid_from_points(config.grid_axes)),
      world_from_map_(body_from_imu_ * make_pose(Eigen::Matrix3d(map_from_start_.transpose()),
                                                 Eigen::Vector3d::Zero())),
      imu_from_lidar_(imu.body_from_imu.inverse() * lidar.body_from_lidar),
      noise_(estimation::noise_of(imu, config.imu_noise_factor)),
      parallel_(std::move(parallel)),
      imu_(config.max_imu_gap_s),
      map_window_(config.map_radius_m),
      scan_duration_(from_seconds(1.0 / lidar.rate_hz)) {}

ScanResult FastLio2::register_scan(const Scan& scan) {
  const Time end = scan_end(scan);
  if (!poses_.empty() && end <= poses_.back().stamp) return refused_scan();
  const std::vector<ImuSample> samples = imu_.samples(
      integrated_until_ ? *integrated_until_ + Time{1} : Time::min(), end);  // since the last scan
  const std::vector<estimation::ImuInterval> intervals = intervals_until(end);
  if (started_) {
    predict(intervals);
  } else if (!start(samples) || config_.skip_first_scan) {
    return finish_scan(
        end, scan.points.empty() ? ScanStatus::kTooFewPoints : ScanStatus::kInitializing, {});
  }

  const State predicted = estimate_.state;
  const std::vector<Eigen::Vector3f> points = preprocess(scan);
  const std::vector<Eigen::Vector3f> reduced =
      evenly(map::voxel_means(points, config_.scan_voxel_size_m, config_.grid_axes),
             config_.max_scan_points);
  PlaneResiduals residuals(reduced, map_, config_, parallel_);
  const estimation::IteratedUpdate update = estimation::iterated_update(
      estimate_, std::ref(residuals),
      {config_.max_iterations, config_.convergence, config_.point_variance_m2});
  estimate_ = update.estimate;
  const bool still = config_.zero_velocity_updates &&
                     still_.observe(estimation::statistics(samples), predicted,
                                    estimate_.state.position(), config_, accel_scale_);
  if (still) stand();
  has_moved_ = has_moved_ || !still;

  const ScanStatus status = status_of(update, residuals);
  const bool seen_enough = still && still_.scans() > config_.standing_scans_mapped;
  if (!seen_enough && contradicting_scans_ == 0) grow_map(reduced, residuals);
  publish(points);
  return finish_scan(end, status,
                     {.points = points.size(),
                      .keypoints = reduced.size(),
                      .matches = update.points.count,
                      .near_planes = residuals.near_planes(),
                      .iterations = update.evaluations,
                      .map_points = map_.size(),
                      .standing = still});
}

Time FastLio2::scan_end(const Scan& scan) {
  if (scan.timed && !scan.points.empty()) scan_duration_ = end_of(scan) - scan.stamp;
  return scan.timed ? scan.stamp + scan_duration_ : scan.stamp;
}

std::vector<estimation::ImuInterval> FastLio2::intervals_until(Time end) {
  const bool silent = imu_.empty() || (!integrated_until_ && imu_.first_stamp() > end);
  const Time begin = silent ? end : integrated_until_.value_or(imu_.first_stamp());
  std::vector<estimation::ImuInterval> intervals = imu_.between(begin, end);
  if (!silent) integrated_until_ = end;
  imu_.remove_before(end);
  longest_gap_s_ = estimation::longest_gap_s(intervals);
  saturated_ = estimation::count_saturated(intervals);
  return intervals;
}

bool FastLio2::start(const std::vector<ImuSample>& samples) {
  const bool skip = first_scan_ && config_.skip_first_scan;
  first_scan_ = false;
  if (!skip) start_samples_.insert(start_samples_.end(), samples.begin(), samples.end());
  if (start_samples_.size() < static_cast<std::size_t>(config_.initialization_samples))
    return false;
  const Start begin = start_from(start_samples_, imu_from_lidar_, config_);
  estimate_ = begin.estimate;
  estimate_.state.rotation() = map_from_start_ * estimate_.state.rotation();
  estimate_.state.gravity = map_from_start_ * estimate_.state.gravity;
  accel_scale_ = begin.accel_scale;
  first_pose_ = estimate_.state.world_from_imu();
  started_ = true;
  imu_.set_accel_scale(accel_scale_);
  start_samples_ = {};
  return true;
}

void FastLio2::stand() {
  estimate_ = estimation::zero_velocity_update(estimate_, kStillSpeedSigma);
  if (!config_.hold_first_pose || has_moved_) return;
  estimate_ =
      estimation::pose_update(estimate_, first_pose_, kStillTranslationSigma, kStillRotationSigma);
}

void FastLio2::predict(const std::vector<estimation::ImuInterval>& intervals) {
  State& state = estimate_.state;
  track_.clear();
  const estimation::Integration integration = config_.second_order_integration
                                                  ? estimation::Integration::kSecondOrder
                                                  : estimation::Integration::kFirstOrder;
  for (const estimation::ImuInterval& interval : intervals) {
    Eigen::Vector3d accel = accel_scale_ * interval.accel;
    if (interval.gap) {  // coast with constant velocity
      accel = state.nav.bias.accel - state.rotation().transpose() * state.gravity;
    }
    const Eigen::Vector3d acceleration =
        state.rotation() * (accel - state.nav.bias.accel) + state.gravity;
    track_.push_back({interval.begin, state.world_from_imu(), state.nav.velocity, acceleration,
                      interval.gyro - state.nav.bias.gyro});
    const State::Matrix f =
        estimation::propagate(state, interval.gyro, accel, interval.seconds(), integration);
    estimate_.covariance = f * estimate_.covariance * f.transpose() +
                           estimation::step_noise(noise_over(interval), interval.seconds());
  }
  state.rotation() = orthonormal(state.rotation());
  state.imu_from_lidar.linear() = orthonormal(state.imu_from_lidar.linear());
}

estimation::ImuNoise FastLio2::noise_over(const estimation::ImuInterval& interval) const {
  if (interval.gap || (config_.detect_saturation && interval.saturated))
    return estimation::kCoastingNoise;
  if (config_.noise_model == NoiseModel::kDensity) return noise_;
  // A sample's variance times dt^2 is a density of sqrt(variance dt) over dt.
  const auto density = [&](double variance) { return std::sqrt(variance * interval.seconds()); };
  return {density(config_.gyro_variance), density(config_.accel_variance),
          density(config_.gyro_bias_variance), density(config_.accel_bias_variance)};
}

std::vector<Eigen::Vector3f> FastLio2::preprocess(const Scan& scan) const {
  Scan used;
  used.stamp = scan.stamp;
  used.timed = scan.timed;
  const auto stride = static_cast<std::size_t>(config_.point_stride);
  const auto nearest = static_cast<float>(config_.min_range_m * config_.min_range_m);
  used.points.reserve(scan.points.size() / stride + 1);
  for (std::size_t i = 0; i < scan.points.size(); i += stride) {
    const float squared = scan.points[i].position.squaredNorm();
    if (std::isfinite(squared) && squared > nearest) used.points.push_back(scan.points[i]);
  }
  std::vector<Eigen::Vector3f> at_end = estimation::deskew(
      used, track_, estimate_.state.imu_from_lidar, estimate_.state.world_from_imu(), parallel_);
  for (std::size_t i = 0; !config_.deskew_first_instant && i < at_end.size(); ++i) {
    if (used.points[i].dt_ns == 0) at_end[i] = used.points[i].position;
  }
  return at_end;
}

void FastLio2::grow_map(const std::vector<Eigen::Vector3f>& points,
                        const PlaneResiduals& residuals) {
  const Pose world_from_lidar = estimate_.state.world_from_lidar();
  add_scan(transformed(world_from_lidar, points),
           map_.empty() ? std::vector<Match>{} : residuals.matches(),
           static_cast<float>(config_.map_voxel_size_m), map_);
  map_window_.follow(world_from_lidar.translation().cast<float>(), map_);
}

ScanStatus FastLio2::status_of(const estimation::IteratedUpdate& update,
                               const PlaneResiduals& residuals) {
  const State& state = estimate_.state;
  if (!state.position().allFinite() || !state.rotation().allFinite() ||
      !(state.nav.velocity.norm() < estimation::kMaxPlausibleSpeed)) {
    return ScanStatus::kDiverged;
  }
  if (residuals.matches().empty()) return ScanStatus::kTooFewPoints;
  if (map_.empty()) return ScanStatus::kInitializing;
  if (contradicting_scans_ > kLostScans) return ScanStatus::kDiverged;  // permanently
  const bool contradicts = static_cast<double>(update.points.count) <
                           config_.min_inlier_share * static_cast<double>(residuals.near_planes());
  contradicting_scans_ = contradicts ? contradicting_scans_ + 1 : 0;
  if (contradicts) return ScanStatus::kDegenerate;
  if (update.points.count == 0) return ScanStatus::kTooFewPoints;
  // The block of the position is the weighted sum of n n^T over all normals n.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> directions(
      update.points.hessian.topLeftCorner<3, 3>(), Eigen::EigenvaluesOnly);
  const double weakest = directions.eigenvalues()[0] / directions.eigenvalues().sum();
  return weakest < kDegenerate ? ScanStatus::kDegenerate : ScanStatus::kTracked;
}

/// A scan out of time order is counted and changes nothing else.
ScanResult FastLio2::refused_scan() {
  ++scans_refused_;
  return finish_scan(poses_.back().stamp, ScanStatus::kTooFewPoints, {});
}

ScanResult FastLio2::finish_scan(Time end, ScanStatus status, const ScanCounters& counters) {
  ScanResult result;
  result.estimate = {end, body_pose(estimate_.state.world_from_imu())};
  result.status = status;
  if (started_) result.covariance = body_covariance();
  result.counters = counters;
  result.counters.imu_gap_s = longest_gap_s_;
  result.counters.imu_saturated = saturated_;
  result.counters.imu_refused = imu_.refused();
  result.counters.scans_refused = scans_refused_;
  result.counters.accel_scale = accel_scale_;
  if (poses_.empty() || end > poses_.back().stamp) poses_.push_back(result.estimate);
  return result;
}

Pose FastLio2::body_pose(const Pose& map_from_imu) const {
  return world_from_map_ * map_from_imu * body_from_imu_.inverse();
}

Eigen::Matrix<double, 6, 6> FastLio2::body_covariance() const {
  const State& state = estimate_.state;
  const Pose imu_from_body = body_from_imu_.inverse();
  Eigen::Matrix<double, 6, 6> by_state = Eigen::Matrix<double, 6, 6>::Zero();
  by_state.topLeftCorner<3, 3>() = world_from_map_.linear();
  by_state.topRightCorner<3, 3>() =
      -world_from_map_.linear() * state.rotation() * so3::hat(imu_from_body.translation());
  by_state.bottomRightCorner<3, 3>() = imu_from_body.linear().transpose();
  return by_state * estimate_.covariance.topLeftCorner<6, 6>() * by_state.transpose();
}

void FastLio2::publish(std::span<const Eigen::Vector3f> points) {
  registered_scan_ = transformed(world_from_map_ * estimate_.state.world_from_lidar(), points);
  if (!config_.keep_all_scans) return;
  for (const Eigen::Vector3f& p : registered_scan_) archive_.push_back({p.x(), p.y(), p.z()});
}

std::vector<Eigen::Vector3f> FastLio2::map() const {
  return transformed(world_from_map_, map_.points());
}

std::map<std::string, std::uint64_t> FastLio2::memory() const {
  return {{"map", map_.memory_bytes()},
          {"scan_buffer", archive_.size() * sizeof(ArchivedPoint) +
                              registered_scan_.capacity() * sizeof(Eigen::Vector3f)},
          {"backlog", imu_.memory_bytes()},
          {"other", poses_.capacity() * sizeof(StampedPose)}};
}

}  // namespace lidarena::odometry::fast_lio2
