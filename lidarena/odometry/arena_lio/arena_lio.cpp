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
constexpr double kConvergence = 1e-3;  // m, rad, m/s: largest step of a converged update
// Of a start in motion:
constexpr std::size_t kOpeningScans = 5;  // that are registered again with each that follows
constexpr int kFirstPasses = 5;           // over the first two scans
// Corrections of the velocity count as the accelerometer's noise beyond so many times the other
// noise.
constexpr double kAccelSurprise = 10.0;
constexpr int kStandingScansMapped = 20;  // in a standstill; more of them add nothing but noise

/// The data sheet's noise, but at least the nominal one, with a factor for each of the two sensors.
/// The factors stand for errors that no data sheet states, and that a better IMU has, too.
estimation::ImuNoise noise_for(const ImuInfo& imu, const Config& config) {
  const ImuInfo at_least_nominal = estimation::at_least_nominal(imu);
  estimation::ImuNoise noise = estimation::noise_of(at_least_nominal, config.gyro_noise_factor);
  const estimation::ImuNoise of_accel =
      estimation::noise_of(at_least_nominal, config.accel_noise_factor);
  noise.accel_density = of_accel.accel_density;
  noise.accel_bias_walk = of_accel.accel_bias_walk;
  return noise;
}

/// The points that are finite and farther than `min_range` (m) from their LiDAR.
Scan usable_points(const Scan& scan, double min_range) {
  Scan usable{.stamp = scan.stamp, .points = {}, .timed = scan.timed, .origins = scan.origins};
  const auto nearest = static_cast<float>(min_range * min_range);
  usable.points.reserve(scan.points.size());
  for (const Point& point : scan.points) {
    const float squared = (point.position - origin_of(scan, point)).squaredNorm();
    if (std::isfinite(squared) && squared > nearest) usable.points.push_back(point);
  }
  return usable;
}

/// What one LiDAR has seen: points (m), and from where. In the frame of the scan.
struct Seen {
  Eigen::Vector3f from;
  std::vector<Eigen::Vector3f> points;
};

/// The positions of the scan's points by their LiDARs.
std::vector<Seen> by_lidar(const Scan& scan, std::vector<Eigen::Vector3f> positions) {
  if (scan.origins.size() < 2) return {{Eigen::Vector3f::Zero(), std::move(positions)}};
  std::vector<Seen> all;
  for (const Eigen::Vector3f& origin : scan.origins) all.push_back({origin, {}});
  for (std::size_t i = 0; i < positions.size(); ++i)
    all[scan.points[i].lidar].points.push_back(positions[i]);
  return all;
}

/// Standard deviation (m) of the position in its least certain direction.
double position_sigma(const estimation::StateEstimate& estimate) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> directions(
      estimate.covariance.topLeftCorner<3, 3>(), Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, directions.eigenvalues()[2]));
}

/// What the update of a slice has added to its prediction.
Correction correction(const Filter& predicted, const estimation::InertialState& updated,
                      const Slice& slice) {
  using State = estimation::InertialState;
  const State& state = predicted.estimate.state;
  return {.turn = predicted.turn,
          .rotation = so3::log(state.rotation().transpose() * updated.rotation()),
          .velocity = updated.nav.velocity - state.nav.velocity,
          .seconds = to_seconds(slice.intervals.back().end - slice.intervals.front().begin)};
}

}  // namespace

ArenaLio::ArenaLio(const Config& config, const LidarInfo& lidar, const ImuInfo& imu,
                   Parallel parallel)
    : config_(config),
      lidar_from_body_(lidar.body_from_lidar.inverse()),
      map_from_start_(map::grid_from_points(kGrid)),
      imu_from_lidar_(imu.body_from_imu.inverse() * lidar.body_from_lidar),
      noise_(noise_for(imu, config)),
      parallel_(std::move(parallel)),
      imu_(config.max_imu_gap_s),
      scan_duration_(from_seconds(1.0 / lidar.rate_hz)),
      world_{imu.body_from_imu *
                 make_pose(Eigen::Matrix3d(map_from_start_.transpose()), Eigen::Vector3d::Zero()),
             map::LocalPlanes(config.map.options())},
      tracking_(config.tracking) {
  filter_.estimate.state.rotation() = map_from_start_;  // of poses before the initialization
  filter_.estimate.state.imu_from_lidar = imu_from_lidar_;
}

ScanResult ArenaLio::track(const Scan& scan) {
  const Time end = scan_end(scan);
  const ScanImu imu = imu_until(end);
  const bool starts = !start_.initialized;
  if (starts) initialize(imu.samples);
  if (!start_.initialized) {
    using enum ScanStatus;
    return finish_scan(scan.stamp, end, scan.points.empty() ? kTooFewPoints : kInitializing, imu, 0,
                       {});
  }
  const Scan usable = usable_points(scan, config_.min_range_m);
  const bool opens = starts || start_.opening;
  if (start_.opening) begin_again({usable, end, imu.intervals});

  if (!starts) filter_ = begun(std::move(filter_));
  const int slices = opens ? 1 : slices_of(usable, imu, end);
  const Registration found = registered(
      sliced(usable, end, starts ? Intervals{} : imu.intervals, slices), std::move(filter_));
  const ScanStatus status = judge(found.match);
  filter_ = correct(found, imu, status == ScanStatus::kTracked);
  const bool smooths = !opens && status != ScanStatus::kDiverged;
  filter_ = smooths ? smoothed(std::move(filter_)) : bent(std::move(filter_), end);
  std::vector<StampedPose> revised = smooths ? revise(filter_) : std::vector<StampedPose>{};
  last_ = {scan.stamp, end, filter_.track};
  const std::vector<Eigen::Vector3f> points = deskewed(usable, filter_, parallel_);
  if (!tracking_.contradicts()) world_ = grown(std::move(world_), filter_, usable, points);

  const Pose map_from_lidar = filter_.estimate.state.world_from_lidar();
  registered_scan_ = transformed(world_.world_from_map * map_from_lidar, points);
  ScanResult result = finish_scan(scan.stamp, end, status, imu, points.size(),
                                  {{"keypoints", found.match.keypoints},
                                   {"matches", found.match.agreement.on_planes},
                                   {"near_planes", found.match.agreement.near_planes},
                                   {"iterations", found.match.update.evaluations},
                                   {"slices", slices},
                                   {"map_points", world_.map.fine().size()},
                                   {"standing", filter_.still.scans() > 0}});
  result.revised = std::move(revised);
  return result;
}

Time ArenaLio::scan_end(const Scan& scan) {
  if (scan.timed && !scan.points.empty()) scan_duration_ = end_of(scan) - scan.stamp;
  return scan.timed ? scan.stamp + scan_duration_ : scan.stamp;
}

ArenaLio::ScanImu ArenaLio::imu_until(Time end) {
  ScanImu found;
  found.samples = imu_.samples(integrated_until_ ? *integrated_until_ + Time{1} : Time::min(), end);
  const bool silent = imu_.empty() || (!integrated_until_ && imu_.first_stamp() > end);
  const Time begin = silent ? end : integrated_until_.value_or(imu_.first_stamp());
  const Time late = from_seconds(filter_.gyro.delay_s());
  found.intervals = imu_.between(begin + late, end + late);
  for (estimation::ImuInterval& interval : found.intervals) {
    interval.begin -= late;
    interval.end -= late;
  }
  if (!silent) integrated_until_ = end;
  imu_.remove_before(end - 2 * from_seconds(estimation::GyroCalibration::kMaxDelay));
  found.longest_gap_s = estimation::longest_gap_s(found.intervals);
  found.saturated = estimation::count_saturated(found.intervals);
  return found;
}

void ArenaLio::initialize(const std::vector<ImuSample>& samples) {
  start_.samples.insert(start_.samples.end(), samples.begin(), samples.end());
  const std::optional<Initialization> found = start_from(start_.samples, imu_from_lidar_);
  if (!found) return;
  filter_ = initial_filter(*found, map_from_start_);
  start_ = {.samples = {}, .initialized = true, .opening = std::nullopt};
  if (!found->still) start_.opening = {{}, filter_.estimate};
  imu_.set_accel_scale(filter_.accel_scale);
  const Pose leveled = leveled_from_world();
  world_.world_from_map = leveled * world_.world_from_map;
  for (StampedPose& pose : poses_) pose.world_from_body = leveled * pose.world_from_body;
}

void ArenaLio::begin_again(OpeningScan latest) {
  Opening& opening = *start_.opening;
  if (opening.scans.empty()) {
    filter_ = tracked_back(std::move(filter_), latest.intervals);
    opening.scans.push_back(std::move(latest));
    return;
  }
  const int passes = opening.scans.size() == 1 ? kFirstPasses : 1;
  Replay again = replay(opening, std::move(filter_), std::move(world_));
  for (int pass = 0; pass < passes; ++pass) {
    opening.estimate = reopened(opening, latest, again);
    again = replay(opening, std::move(again.filter), std::move(again.world));
  }
  filter_ = std::move(again.filter);
  world_ = std::move(again.world);
  for (const StampedPose& pose : again.poses) {
    const auto published = std::ranges::find(poses_, pose.stamp, &StampedPose::stamp);
    if (published != poses_.end()) *published = pose;
  }
  opening.scans.push_back(std::move(latest));
  if (opening.scans.size() == kOpeningScans) start_.opening.reset();
}

estimation::ImuNoise ArenaLio::noise_by(const Filter& filter) const {
  estimation::ImuNoise noise = measured_noise_.at_least(noise_);
  noise.gyro_density = std::max(noise.gyro_density, filter.gyro_noise.density());
  const double accel = filter.accel_noise.density();
  if (accel > kAccelSurprise * noise.accel_density) noise.accel_density = accel;
  return noise;
}

Filter ArenaLio::predict(Filter filter,
                         const std::vector<estimation::ImuInterval>& intervals) const {
  const estimation::ImuNoise noise = noise_by(filter);
  return predicted(std::move(filter), intervals, noise);
}

ArenaLio::Match ArenaLio::match(const Scan& usable, const Filter& predicted,
                                const map::LocalPlanes& map) const {
  std::vector<Eigen::Vector3f> reduced, seen_from;
  for (const Seen& seen : by_lidar(usable, deskewed(usable, predicted, parallel_))) {
    const auto means = map::voxel_means(seen.points, config_.scan_voxel_size_m, kGrid);
    reduced.insert(reduced.end(), means.begin(), means.end());
    seen_from.resize(reduced.size(), seen.from);
  }
  reduced = map::evenly(std::move(reduced), config_.max_scan_points);
  seen_from = map::evenly(std::move(seen_from), config_.max_scan_points);
  PlaneResiduals residuals(reduced, seen_from, map, position_sigma(predicted.estimate),
                           config_.estimate_extrinsics && predicted.has_moved, config_, parallel_);
  const estimation::IteratedUpdate update = estimation::iterated_update(
      predicted.estimate, std::ref(residuals),
      {config_.max_iterations + residuals.narrowing(), kConvergence, config_.point_variance_m2});
  return {update, residuals.agreement(update.estimate.state), reduced.size(), usable.points.size()};
}

int ArenaLio::slices_of(const Scan& usable, const ScanImu& imu, Time end) const {
  if (!usable.timed || end <= usable.stamp || world_.map.empty()) return 1;
  const double density = imu.saturated > 0 ? estimation::kCoastingNoise.accel_density
                                           : noise_by(filter_).accel_density;
  return slices_needed(imu.intervals, density, config_.max_slice_error_m);
}

ArenaLio::Registration ArenaLio::registered(const std::vector<Slice>& slices, Filter filter) const {
  Registration all;
  for (const Slice& slice : slices) {
    all.predicted = predict(std::move(filter), slice.intervals);
    Match found = match(slice.points, all.predicted, world_.map);
    if (!slice.intervals.empty()) {
      all.corrections.push_back(correction(all.predicted, found.update.estimate.state, slice));
      all.predicted =
          beyond_range(std::move(all.predicted), slice.intervals, all.corrections.back());
    }
    filter = all.predicted;
    filter.estimate = found.update.estimate;
    found.update.points += all.match.update.points;
    found.update.evaluations += all.match.update.evaluations;
    found.agreement += all.match.agreement;
    found.keypoints += all.match.keypoints;
    found.returns += all.match.returns;
    all.match = std::move(found);
  }
  return all;
}

ScanStatus ArenaLio::judge(const Match& found) {
  const Agreement& agreement = found.agreement;
  if (!estimation::is_plausible(found.update.estimate.state)) {
    tracking_.give_up();
    return ScanStatus::kDiverged;
  }
  if (agreement.points == 0) return ScanStatus::kTooFewPoints;
  if (world_.map.empty()) return ScanStatus::kInitializing;
  if (tracking_.is_lost()) return ScanStatus::kDiverged;  // permanently
  if (agreement.near_planes == 0 && !tracking_.contradicts()) return ScanStatus::kTooFewPoints;
  const ScanStatus status = tracking_.judge(
      agreement.share(), leaves_a_direction_open(agreement.contacts, found.returns_per_keypoint()));
  const bool opens = start_.opening && status == ScanStatus::kTracked;
  return opens ? ScanStatus::kInitializing : status;
}

Filter ArenaLio::correct(Registration found, const ScanImu& imu, bool tracked) const {
  Filter filter =
      held_at_rest(std::move(found.predicted), found.match.update.estimate, imu.samples);
  const bool reliable = imu.longest_gap_s == 0.0 && imu.saturated == 0;
  const bool still = filter.still.scans() > 0;
  if (!config_.calibrate_gyro || !tracked || !reliable || still) return filter;
  for (const Correction& correction : found.corrections)
    filter = informed(std::move(filter), correction);
  return filter;
}

std::vector<StampedPose> ArenaLio::revise(const Filter& filter) {
  if (filter.track.empty() || last_.track.empty()) return {};
  if (poses_.empty() || poses_.back().stamp != last_.end) return {};
  const Pose& map_from_imu = filter.track.front().world_from_imu;
  const Pose imu_from_body = filter.estimate.state.imu_from_lidar * lidar_from_body_;
  poses_.back().world_from_body = world_.world_from_map * map_from_imu * imu_from_body;
  const estimation::ImuTrack track =
      estimation::bent_track(std::move(last_.track), last_.end, map_from_imu);
  std::vector<StampedPose> revised =
      estimation::motion_along(track, last_.begin, last_.end, last_.end,
                               world_.world_from_map * map_from_imu, imu_from_body);
  if (revised.empty()) revised.push_back(poses_.back());
  return revised;
}

ArenaLio::World ArenaLio::with_points(World world, const Filter& filter, const Scan& scan,
                                      std::vector<Eigen::Vector3f> positions) {
  const Pose map_from_lidar = filter.estimate.state.world_from_lidar();
  for (const Seen& seen : by_lidar(scan, std::move(positions))) {
    const Eigen::Vector3d from = map_from_lidar * seen.from.cast<double>();
    world.map.insert(transformed(map_from_lidar, seen.points), from.cast<float>());
  }
  return world;
}

ArenaLio::World ArenaLio::grown(World world, const Filter& filter, const Scan& scan,
                                const std::vector<Eigen::Vector3f>& positions) {
  if (filter.still.scans() > kStandingScansMapped) return world;
  world = with_points(std::move(world), filter, scan, positions);
  world.map.follow(filter.estimate.state.world_from_lidar().translation().cast<float>());
  return world;
}

ArenaLio::Replay ArenaLio::replay(const Opening& opening, Filter filter, World world) const {
  Replay again{std::move(filter), std::move(world), {}};
  again.filter.estimate = opening.estimate;
  again.world.map.clear();
  for (const OpeningScan& scan : opening.scans) {
    const bool is_first = &scan == &opening.scans.front();
    if (is_first) {
      again.filter = tracked_back(std::move(again.filter), scan.intervals);
    } else {
      Filter predicted = predict(begun(std::move(again.filter)), scan.intervals);
      predicted.estimate = match(scan.usable, predicted, again.world.map).update.estimate;
      again.filter = bent(std::move(predicted), scan.end);
    }
    again.world = with_points(std::move(again.world), again.filter, scan.usable,
                              deskewed(scan.usable, again.filter, parallel_));
    again.poses.push_back({scan.end, world_from_body(again.world, again.filter)});
  }
  return again;
}

estimation::StateEstimate ArenaLio::reopened(const Opening& opening, const OpeningScan& latest,
                                             const Replay& before) const {
  std::vector<estimation::ImuInterval> since_first;
  for (std::size_t i = 1; i < opening.scans.size(); ++i) {
    const auto& intervals = opening.scans[i].intervals;
    since_first.insert(since_first.end(), intervals.begin(), intervals.end());
  }
  since_first.insert(since_first.end(), latest.intervals.begin(), latest.intervals.end());
  const Filter predicted = predict(begun(before.filter), latest.intervals);
  const State last = match(latest.usable, predicted, before.world.map).update.estimate.state;
  estimation::StateEstimate first = opening.estimate;
  first.state = carried_back(last, since_first, first.state, predicted.accel_scale);
  return first;
}

Pose ArenaLio::world_from_body(const World& world, const Filter& filter) const {
  return world.world_from_map * filter.estimate.state.world_from_lidar() * lidar_from_body_;
}

UpDirection ArenaLio::up() const {
  const auto of_gravity = filter_.estimate.covariance.bottomRightCorner<2, 2>();
  return {-(world_.world_from_map.linear() * filter_.estimate.state.gravity).normalized(),
          std::sqrt(of_gravity.trace())};
}

ScanResult ArenaLio::finish_scan(Time begin, Time end, ScanStatus status, const ScanImu& imu,
                                 std::size_t points, ScanDetails details) {
  const State& state = filter_.estimate.state;
  const Pose& world_from_map = world_.world_from_map;
  ScanResult result;
  result.estimate = {end, world_from_body(world_, filter_)};
  result.status = status;
  if (start_.initialized) {
    result.covariance = estimation::body_covariance(of_lidar(filter_.estimate),
                                                    world_from_map.linear(), lidar_from_body_);
    result.up = up();
  }
  result.motion = estimation::motion_along(filter_.track, begin, end, end,
                                           world_from_map * state.world_from_imu(),
                                           state.imu_from_lidar * lidar_from_body_);
  result.counters = {.points = points, .imu_saturated = imu.saturated};
  const Pose moved = imu_from_lidar_.inverse() * state.imu_from_lidar;
  const Eigen::Matrix3d turned = imu_from_lidar_.linear().transpose() *
                                 so3::exp(-filter_.gyro.turned()) * imu_from_lidar_.linear();
  for (const auto& [name, value] : {std::pair("imu_gap_s", imu.longest_gap_s),
                                    {"imu_refused", static_cast<double>(imu_.refused())},
                                    {"imu_delay_s", filter_.gyro.delay_s()},
                                    {"accel_scale", filter_.accel_scale},
                                    {"lidar_moved_m", moved.translation().norm()},
                                    {"lidar_turned_rad", so3::angle(turned * moved.linear())}})
    details.emplace_back(name, value);
  result.details = std::move(details);
  if (poses_.empty() || end > poses_.back().stamp) poses_.push_back(result.estimate);
  return result;
}

Pose ArenaLio::leveled_from_world() const {
  Pose leveled = Pose::Identity();
  if (start_.initialized) leveled.linear() = estimation::level_rotation(up().direction);
  return leveled;
}

std::vector<Eigen::Vector3f> ArenaLio::map() const {
  return transformed(world_.world_from_map, world_.map.fine().centers());
}

MemoryUse ArenaLio::memory() const {
  return {.map = world_.map.memory_bytes(),
          .scan_buffer = registered_scan_.capacity() * sizeof(Eigen::Vector3f),
          .backlog = imu_.memory_bytes(),
          .other = poses_.capacity() * sizeof(StampedPose)};
}

}  // namespace lidarena::odometry::arena_lio
