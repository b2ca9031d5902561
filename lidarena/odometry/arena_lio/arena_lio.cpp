// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/arena_lio.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <functional>

#include "lidarena/map/voxel_filter.hpp"

namespace lidarena::odometry::arena_lio {
namespace {

using State = estimation::InertialState;

// Walls that are parallel to the sensor's axes at the start are not parallel to the grids.
constexpr map::GridAxes kGrid = map::GridAxes::kRotated;
constexpr double kConvergence = 1e-3;            // m, rad, m/s: largest step of a converged update
constexpr double kStillSpeedSigma = 0.01;        // m/s, of the zero velocity at a standstill
constexpr double kStillTranslationSigma = 1e-4;  // m, of the held first pose
constexpr double kStillRotationSigma = 1e-5;     // rad, likewise
constexpr int kStandingScansMapped = 20;  // in a standstill; more of them add nothing but noise
constexpr int kLostScans = 15;            // in a row that contradict the map: tracking is lost
constexpr double kDegenerate = 0.01;      // minimum share of a direction; isotropic: 1/3

/// At most `most` of the points, at even intervals of their order.
std::vector<Eigen::Vector3f> evenly(std::vector<Eigen::Vector3f> points, int most) {
  const auto count = static_cast<std::size_t>(most);
  if (points.size() <= count) return points;
  for (std::size_t i = 0; i < count; ++i) points[i] = points[i * points.size() / count];
  points.resize(count);
  return points;
}

}  // namespace

ArenaLio::ArenaLio(const Config& config, const LidarInfo& lidar, const ImuInfo& imu,
                   Parallel parallel)
    : config_(config),
      imu_from_body_(imu.body_from_imu.inverse()),
      map_from_start_(map::grid_from_points(kGrid)),
      world_from_map_(imu.body_from_imu * make_pose(Eigen::Matrix3d(map_from_start_.transpose()),
                                                    Eigen::Vector3d::Zero())),
      imu_from_lidar_(imu.body_from_imu.inverse() * lidar.body_from_lidar),
      noise_(estimation::noise_of(imu, config.imu_noise_factor)),
      parallel_(std::move(parallel)),
      imu_(config.max_imu_gap_s),
      map_window_(config.map_radius_m),
      scan_duration_(from_seconds(1.0 / lidar.rate_hz)) {}

ScanResult ArenaLio::register_scan(const Scan& scan) {
  const Time end = scan_end(scan);
  if (!poses_.empty() && end <= poses_.back().stamp) return refused_scan();
  const std::vector<ImuSample> samples = new_samples(end);
  const std::vector<estimation::ImuInterval> intervals = intervals_until(end);
  if (started_) {
    predict(intervals);
  } else if (!start(samples)) {
    const bool empty = scan.points.empty();
    return finish_scan(scan.stamp, end,
                       empty ? ScanStatus::kTooFewPoints : ScanStatus::kInitializing, {});
  }

  const State predicted = estimate_.state;
  const std::vector<Eigen::Vector3f> points = preprocess(scan);
  const std::vector<Eigen::Vector3f> reduced =
      evenly(map::voxel_means(points, config_.scan_voxel_size_m, kGrid), config_.max_scan_points);
  PlaneResiduals residuals(reduced, map_, config_, parallel_);
  const estimation::IteratedUpdate update = estimation::iterated_update(
      estimate_, std::ref(residuals),
      {config_.max_iterations, kConvergence, config_.point_variance_m2});
  estimate_ = update.estimate;
  const bool still = still_.observe(estimation::statistics(samples), predicted,
                                    estimate_.state.position(), accel_scale_);
  if (still) stand();
  if (!still) has_moved_ = true;
  const ScanStatus status = status_of(update, residuals);
  const bool seen_enough = still && still_.scans() > kStandingScansMapped;
  if (!seen_enough && contradicting_scans_ == 0) grow_map(reduced, residuals);
  registered_scan_ = transformed(world_from_map_ * estimate_.state.world_from_lidar(), points);
  return finish_scan(scan.stamp, end, status,
                     {.points = points.size(),
                      .keypoints = reduced.size(),
                      .matches = update.points.count,
                      .near_planes = residuals.near_planes(),
                      .iterations = update.evaluations,
                      .map_points = map_.size(),
                      .standing = still});
}

Time ArenaLio::scan_end(const Scan& scan) {
  if (scan.timed && !scan.points.empty()) scan_duration_ = end_of(scan) - scan.stamp;
  return scan.timed ? scan.stamp + scan_duration_ : scan.stamp;
}

std::vector<ImuSample> ArenaLio::new_samples(Time end) const {
  return imu_.samples(integrated_until_ ? *integrated_until_ + Time{1} : Time::min(), end);
}

std::vector<estimation::ImuInterval> ArenaLio::intervals_until(Time end) {
  const bool silent = imu_.empty() || (!integrated_until_ && imu_.first_stamp() > end);
  const Time begin = silent ? end : integrated_until_.value_or(imu_.first_stamp());
  std::vector<estimation::ImuInterval> intervals = imu_.between(begin, end);
  if (!silent) integrated_until_ = end;
  imu_.remove_before(end);
  longest_gap_s_ = estimation::longest_gap_s(intervals);
  saturated_ = estimation::count_saturated(intervals);
  return intervals;
}

bool ArenaLio::start(const std::vector<ImuSample>& samples) {
  start_samples_.insert(start_samples_.end(), samples.begin(), samples.end());
  const std::optional<Start> begin = start_from(start_samples_, imu_from_lidar_);
  if (!begin) return false;
  estimate_ = begin->estimate;
  estimate_.state.rotation() = map_from_start_ * estimate_.state.rotation();
  estimate_.state.gravity = map_from_start_ * estimate_.state.gravity;
  accel_scale_ = begin->accel_scale;
  first_pose_ = estimate_.state.world_from_imu();
  started_ = true;
  imu_.set_accel_scale(accel_scale_);
  start_samples_ = {};
  return true;
}

void ArenaLio::stand() {
  estimate_ = estimation::zero_velocity_update(estimate_, kStillSpeedSigma);
  if (has_moved_) return;
  estimate_ =
      estimation::pose_update(estimate_, first_pose_, kStillTranslationSigma, kStillRotationSigma);
}

void ArenaLio::predict(const std::vector<estimation::ImuInterval>& intervals) {
  State& state = estimate_.state;
  track_.clear();
  for (const estimation::ImuInterval& interval : intervals) {
    Eigen::Vector3d accel = accel_scale_ * interval.accel;
    if (interval.gap) {  // coast with constant velocity
      accel = state.nav.bias.accel - state.rotation().transpose() * state.gravity;
    }
    const Eigen::Vector3d acceleration =
        state.rotation() * (accel - state.nav.bias.accel) + state.gravity;
    track_.push_back({interval.begin, state.world_from_imu(), state.nav.velocity, acceleration,
                      interval.gyro - state.nav.bias.gyro});
    const bool unreliable = interval.gap || interval.saturated;
    const State::Matrix f = estimation::propagate(state, interval.gyro, accel, interval.seconds(),
                                                  estimation::Integration::kSecondOrder);
    estimate_.covariance = f * estimate_.covariance * f.transpose() +
                           estimation::step_noise(unreliable ? estimation::kCoastingNoise : noise_,
                                                  interval.seconds());
  }
  state.nav.world_from_imu = orthonormalized(state.nav.world_from_imu);
  state.imu_from_lidar = orthonormalized(state.imu_from_lidar);
}

std::vector<Eigen::Vector3f> ArenaLio::preprocess(const Scan& scan) const {
  Scan used{.stamp = scan.stamp, .points = {}, .timed = scan.timed};
  const auto nearest = static_cast<float>(config_.min_range_m * config_.min_range_m);
  used.points.reserve(scan.points.size());
  for (const Point& point : scan.points) {
    const float squared = point.position.squaredNorm();
    if (std::isfinite(squared) && squared > nearest) used.points.push_back(point);
  }
  return estimation::deskew(used, track_, estimate_.state.imu_from_lidar,
                            estimate_.state.world_from_imu(), parallel_);
}

void ArenaLio::grow_map(const std::vector<Eigen::Vector3f>& points,
                        const PlaneResiduals& residuals) {
  const Pose world_from_lidar = estimate_.state.world_from_lidar();
  add_scan(transformed(world_from_lidar, points),
           map_.empty() ? std::span<const Nearest>{} : residuals.nearest(),
           static_cast<float>(config_.map_voxel_size_m), map_);
  map_window_.follow(world_from_lidar.translation().cast<float>(), map_);
}

ScanStatus ArenaLio::status_of(const estimation::IteratedUpdate& update,
                               const PlaneResiduals& residuals) {
  if (!estimation::is_plausible(estimate_.state)) {
    contradicting_scans_ = kLostScans + 1;
    return ScanStatus::kDiverged;
  }
  if (residuals.nearest().empty()) return ScanStatus::kTooFewPoints;
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
ScanResult ArenaLio::refused_scan() {
  ++scans_refused_;
  const Time last = poses_.back().stamp;
  return finish_scan(last, last, ScanStatus::kTooFewPoints, {});
}

ScanResult ArenaLio::finish_scan(Time begin, Time end, ScanStatus status,
                                 const ScanCounters& counters) {
  const Pose world_from_imu = world_from_map_ * estimate_.state.world_from_imu();
  ScanResult result;
  result.estimate = {end, world_from_imu * imu_from_body_};
  result.status = status;
  if (started_)
    result.covariance =
        estimation::body_covariance(estimate_, world_from_map_.linear(), imu_from_body_);
  result.motion = estimation::motion_along(track_, begin, end, end, world_from_imu, imu_from_body_);
  result.counters = counters;
  result.counters.imu_gap_s = longest_gap_s_;
  result.counters.imu_saturated = saturated_;
  result.counters.imu_refused = imu_.refused();
  result.counters.scans_refused = scans_refused_;
  result.counters.accel_scale = accel_scale_;
  if (poses_.empty() || end > poses_.back().stamp) poses_.push_back(result.estimate);
  return result;
}

std::vector<Eigen::Vector3f> ArenaLio::map() const {
  return transformed(world_from_map_, map_.points());
}

std::map<std::string, std::uint64_t> ArenaLio::memory() const {
  return {{"map", map_.memory_bytes()},
          {"scan_buffer", registered_scan_.capacity() * sizeof(Eigen::Vector3f)},
          {"backlog", imu_.memory_bytes()},
          {"other", poses_.capacity() * sizeof(StampedPose)}};
}

}  // namespace lidarena::odometry::arena_lio
