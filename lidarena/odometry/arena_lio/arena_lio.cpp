// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lio/arena_lio.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "lidarena/base/so3.hpp"
#include "lidarena/map/voxel_filter.hpp"
#include "lidarena/odometry/arena_lio/lidar_covariance.hpp"

namespace lidarena::odometry::arena_lio {
namespace {

// Walls that are parallel to the sensor's axes at the start are not parallel to the grids.
constexpr map::GridAxes kGrid = map::GridAxes::kRotated;
constexpr double kConvergence = 1e-3;            // m, rad, m/s: largest step of a converged update
constexpr double kStillSpeedSigma = 0.01;        // m/s, of the zero velocity at a standstill
constexpr double kStillTranslationSigma = 1e-4;  // m, of the held first pose
constexpr double kStillRotationSigma = 1e-5;     // rad, likewise
// Of a start in motion:
constexpr std::size_t kOpeningScans = 5;  // that are registered again with each that follows
constexpr int kFirstPasses = 5;           // over the first two scans
constexpr int kStandingScansMapped = 20;  // in a standstill; more of them add nothing but noise

/// The data sheet's noise, with a factor for each of the two sensors.
estimation::ImuNoise noise_for(const ImuInfo& imu, const Config& config) {
  estimation::ImuNoise noise = estimation::noise_of(imu, config.gyro_noise_factor);
  const estimation::ImuNoise of_accel = estimation::noise_of(imu, config.accel_noise_factor);
  noise.accel_density = of_accel.accel_density;
  noise.accel_bias_walk = of_accel.accel_bias_walk;
  return noise;
}

/// The points that are finite and farther than `min_range` (m).
Scan usable_points(const Scan& scan, double min_range) {
  Scan usable{.stamp = scan.stamp, .points = {}, .timed = scan.timed};
  const auto nearest = static_cast<float>(min_range * min_range);
  usable.points.reserve(scan.points.size());
  for (const Point& point : scan.points) {
    const float squared = point.position.squaredNorm();
    if (std::isfinite(squared) && squared > nearest) usable.points.push_back(point);
  }
  return usable;
}

/// Standard deviation (m) of the position in its least certain direction.
double position_sigma(const estimation::StateEstimate& estimate) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> directions(
      estimate.covariance.topLeftCorner<3, 3>(), Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, directions.eigenvalues()[2]));
}

}  // namespace

ArenaLio::ArenaLio(const Config& config, const LidarInfo& lidar, const ImuInfo& imu,
                   Parallel parallel)
    : config_(config),
      lidar_from_body_(lidar.body_from_lidar.inverse()),
      map_from_start_(map::grid_from_points(kGrid)),
      world_from_map_(imu.body_from_imu * make_pose(Eigen::Matrix3d(map_from_start_.transpose()),
                                                    Eigen::Vector3d::Zero())),
      imu_from_lidar_(imu.body_from_imu.inverse() * lidar.body_from_lidar),
      noise_(noise_for(imu, config)),
      parallel_(std::move(parallel)),
      imu_(config.max_imu_gap_s),
      tracking_(config.min_inlier_share),
      map_({config.map_cell_size_m, config.max_cell_points, config.map_radius_m}),
      scan_duration_(from_seconds(1.0 / lidar.rate_hz)) {
  estimate_.state.rotation() = map_from_start_;  // of poses before the initialization
  estimate_.state.imu_from_lidar = imu_from_lidar_;
}

ScanResult ArenaLio::track(const Scan& scan) {
  const Time end = scan_end(scan);
  const std::vector<ImuSample> samples = new_samples(end);
  const std::vector<estimation::ImuInterval> intervals = intervals_until(end);
  const bool starts = !started_;
  if (starts && !start(samples)) {
    using enum ScanStatus;
    return finish_scan(scan.stamp, end, scan.points.empty() ? kTooFewPoints : kInitializing, 0, {});
  }
  const Scan usable = usable_points(scan, config_.min_range_m);
  if (opening_) begin_again({usable, end, intervals});
  if (!starts) predict(intervals);

  const State predicted = estimate_.state;
  const Match found = match(usable);
  estimate_ = found.update.estimate;
  ScanStatus status = tracking_.judge(found.update, found.agreement, map_.empty());
  if (opening_ && status == ScanStatus::kTracked) status = ScanStatus::kInitializing;
  const bool still = stands(samples, predicted);
  if (status == ScanStatus::kTracked && !still) calibrate(predicted);
  track_ = estimation::bent_track(std::move(track_), end, estimate_.state.world_from_imu());
  const std::vector<Eigen::Vector3f> points = deskewed(usable);
  if (!tracking_.contradicts()) grow_map(points);
  registered_scan_ = transformed(world_from_map_ * estimate_.state.world_from_lidar(), points);
  return finish_scan(scan.stamp, end, status, points.size(),
                     {{"keypoints", found.keypoints},
                      {"matches", found.agreement.on_planes},
                      {"near_planes", found.agreement.near_planes},
                      {"iterations", found.update.evaluations},
                      {"map_points", map_.fine().size()},
                      {"standing", still}});
}

ArenaLio::Match ArenaLio::match(const Scan& usable) const {
  const std::vector<Eigen::Vector3f> reduced =
      map::evenly(map::voxel_means(deskewed(usable), config_.scan_voxel_size_m, kGrid),
                  config_.max_scan_points);
  PlaneResiduals residuals(reduced, map_, position_sigma(estimate_),
                           config_.estimate_extrinsics && has_moved_, config_, parallel_);
  const estimation::IteratedUpdate update = estimation::iterated_update(
      estimate_, std::ref(residuals),
      {config_.max_iterations + residuals.narrowing(), kConvergence, config_.point_variance_m2});
  return {update, residuals.agreement(update.estimate.state), reduced.size()};
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
  const Time late = from_seconds(gyro_.delay_s());
  std::vector<estimation::ImuInterval> intervals = imu_.between(begin + late, end + late);
  for (estimation::ImuInterval& interval : intervals) {
    interval.begin -= late;
    interval.end -= late;
  }
  if (!silent) integrated_until_ = end;
  imu_.remove_before(end - 2 * from_seconds(estimation::GyroCalibration::kMaxDelay));
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
  if (!begin->still) opening_ = {{}, estimate_};
  imu_.set_accel_scale(accel_scale_);
  Pose leveled = Pose::Identity();
  leveled.linear() = estimation::level_rotation(up().direction);
  world_from_map_ = leveled * world_from_map_;
  for (StampedPose& pose : poses_) pose.world_from_body = leveled * pose.world_from_body;
  start_samples_ = {};
  return true;
}

void ArenaLio::begin_again(OpeningScan latest) {
  std::vector<OpeningScan>& scans = opening_->scans;
  if (scans.empty()) {
    track_ = track_before(latest.intervals, estimate_.state, accel_scale_);
    scans.push_back(std::move(latest));
    return;
  }
  const int passes = scans.size() == 1 ? kFirstPasses : 1;
  std::vector<estimation::ImuInterval> since_first;
  for (std::size_t i = 1; i < scans.size(); ++i)
    since_first.insert(since_first.end(), scans[i].intervals.begin(), scans[i].intervals.end());
  since_first.insert(since_first.end(), latest.intervals.begin(), latest.intervals.end());
  for (int pass = 0; pass < passes; ++pass) {
    replay_opening();
    predict(latest.intervals);
    const State last = match(latest.usable).update.estimate.state;
    State& first = opening_->estimate.state;
    first = carried_back(last, since_first, first, accel_scale_);
  }
  replay_opening();
  scans.push_back(std::move(latest));
  if (scans.size() == kOpeningScans) opening_.reset();
}

void ArenaLio::replay_opening() {
  estimate_ = opening_->estimate;
  map_.clear();
  for (const OpeningScan& scan : opening_->scans) {
    const bool is_first = &scan == &opening_->scans.front();
    if (is_first) {
      track_ = track_before(scan.intervals, estimate_.state, accel_scale_);
    } else {
      predict(scan.intervals);
      estimate_ = match(scan.usable).update.estimate;
      track_ =
          estimation::bent_track(std::move(track_), scan.end, estimate_.state.world_from_imu());
    }
    insert(deskewed(scan.usable));
    const auto published = std::ranges::find(poses_, scan.end, &StampedPose::stamp);
    if (published != poses_.end()) published->world_from_body = world_from_body();
  }
}

Pose ArenaLio::world_from_body() const {
  return world_from_map_ * estimate_.state.world_from_lidar() * lidar_from_body_;
}

UpDirection ArenaLio::up() const {
  const auto of_gravity = estimate_.covariance.bottomRightCorner<2, 2>();
  return {-(world_from_map_.linear() * estimate_.state.gravity).normalized(),
          std::sqrt(of_gravity.trace())};
}

bool ArenaLio::stands(const std::vector<ImuSample>& samples, const State& predicted) {
  const bool still = still_.observe(estimation::statistics(samples), predicted,
                                    estimate_.state.position(), accel_scale_);
  has_moved_ = has_moved_ || !still;
  if (still) estimate_ = estimation::zero_velocity_update(estimate_, kStillSpeedSigma);
  if (!has_moved_) {
    estimate_ = estimation::pose_update(estimate_, first_pose_, kStillTranslationSigma,
                                        kStillRotationSigma);
  }
  return still;
}

void ArenaLio::predict(const std::vector<estimation::ImuInterval>& intervals) {
  State& state = estimate_.state;
  const Eigen::Matrix3d map_from_begin = state.rotation();
  const estimation::ImuNoise noise = measured_noise_.at_least(noise_);
  track_.clear();
  for (const estimation::ImuInterval& interval : intervals) {
    constexpr auto kIntegration = estimation::Integration::kSecondOrder;
    const double dt = interval.seconds();
    const estimation::ImuBias bias = state.nav.bias;
    const Eigen::Vector3d rate = gyro_.calibrated(interval.gyro - bias.gyro);
    const Eigen::Vector3d gyro = rate + bias.gyro;
    const Eigen::Matrix3d rotation = estimation::rotation_in_step(state, gyro, dt, kIntegration);
    Eigen::Vector3d force = accel_scale_ * interval.accel - bias.accel;
    if (interval.gap) force = -rotation.transpose() * state.gravity;  // constant velocity
    track_.push_back({interval.begin, state.world_from_imu(), state.nav.velocity,
                      rotation * force + state.gravity, rate});
    const bool unreliable = interval.gap || interval.saturated;
    const State::Matrix f =
        estimation::propagate(state, gyro, force + bias.accel, dt, kIntegration);
    estimate_.covariance =
        f * estimate_.covariance * f.transpose() +
        estimation::step_noise(unreliable ? estimation::kCoastingNoise : noise, dt);
  }
  state.nav.world_from_imu = orthonormalized(state.nav.world_from_imu);
  state.imu_from_lidar = orthonormalized(state.imu_from_lidar);
  if (intervals.empty()) return;
  turned_ = so3::log(map_from_begin.transpose() * state.rotation());
  const Eigen::Vector3d mean_rate =
      state.rotation() * turned_ / to_seconds(intervals.back().end - intervals.front().begin);
  rate_change_ = state.rotation().transpose() * (mean_rate - mean_rate_.value_or(mean_rate));
  mean_rate_ = mean_rate;
}

void ArenaLio::calibrate(const State& predicted) {
  if (!config_.calibrate_gyro || longest_gap_s_ > 0.0 || saturated_ > 0) return;
  gyro_.observe(turned_, rate_change_,
                so3::log(predicted.rotation().transpose() * estimate_.state.rotation()));
}

std::vector<Eigen::Vector3f> ArenaLio::deskewed(const Scan& usable) const {
  const State& state = estimate_.state;
  return estimation::deskew(usable, track_, state.imu_from_lidar, state.world_from_imu(),
                            parallel_);
}

void ArenaLio::insert(const std::vector<Eigen::Vector3f>& points) {
  const Pose world_from_lidar = estimate_.state.world_from_lidar();
  const Eigen::Vector3f sensor = world_from_lidar.translation().cast<float>();
  map_.insert(transformed(world_from_lidar, points), sensor);
}

void ArenaLio::grow_map(const std::vector<Eigen::Vector3f>& points) {
  if (still_.scans() > kStandingScansMapped) return;
  insert(points);
  map_.follow(estimate_.state.world_from_lidar().translation().cast<float>());
}

ScanResult ArenaLio::finish_scan(Time begin, Time end, ScanStatus status, std::size_t points,
                                 ScanDetails details) {
  const State& state = estimate_.state;
  ScanResult result;
  result.estimate = {end, world_from_body()};
  result.status = status;
  if (started_) {
    result.covariance = estimation::body_covariance(of_lidar(estimate_), world_from_map_.linear(),
                                                    lidar_from_body_);
    result.up = up();
  }
  result.motion =
      estimation::motion_along(track_, begin, end, end, world_from_map_ * state.world_from_imu(),
                               state.imu_from_lidar * lidar_from_body_);
  result.counters = {.points = points, .imu_saturated = saturated_};
  const Pose moved = imu_from_lidar_.inverse() * state.imu_from_lidar;
  const Eigen::Matrix3d turned =
      imu_from_lidar_.linear().transpose() * so3::exp(-gyro_.turned()) * imu_from_lidar_.linear();
  for (const auto& [name, value] : {std::pair("imu_gap_s", longest_gap_s_),
                                    {"imu_refused", static_cast<double>(imu_.refused())},
                                    {"imu_delay_s", gyro_.delay_s()},
                                    {"accel_scale", accel_scale_},
                                    {"lidar_moved_m", moved.translation().norm()},
                                    {"lidar_turned_rad", so3::angle(turned * moved.linear())}})
    details.emplace_back(name, value);
  result.details = std::move(details);
  if (poses_.empty() || end > poses_.back().stamp) poses_.push_back(result.estimate);
  return result;
}

Pose ArenaLio::leveled_from_world() const {
  Pose leveled = Pose::Identity();
  if (started_) leveled.linear() = estimation::level_rotation(up().direction);
  return leveled;
}

std::vector<Eigen::Vector3f> ArenaLio::map() const {
  return transformed(world_from_map_, map_.fine().centers());
}

MemoryUse ArenaLio::memory() const {
  return {.map = map_.memory_bytes(),
          .scan_buffer = registered_scan_.capacity() * sizeof(Eigen::Vector3f),
          .backlog = imu_.memory_bytes(),
          .other = poses_.capacity() * sizeof(StampedPose)};
}

}  // namespace lidarena::odometry::arena_lio
