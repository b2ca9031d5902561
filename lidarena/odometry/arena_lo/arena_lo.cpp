// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/arena_lo/arena_lo.hpp"

#include <algorithm>
#include <utility>

#include "lidarena/base/so3.hpp"

namespace lidarena::odometry::arena_lo {

namespace {

constexpr double kStartSpeed = 5.0;        // m/s, standard deviation before any motion is seen
constexpr double kStartRate = 1.0;         // rad/s, likewise
constexpr double kStartPose = 1e-6;        // m and rad: the first pose defines the map's frame
constexpr std::size_t kMinMatches = 50;    // points near planes; with fewer, a scan is not used
constexpr std::size_t kStartScans = 3;     // the map begins anew with each of them, see README.md
constexpr int kStartPasses = 5;            // over the first two scans
constexpr double kLostMotionFactor = 0.5;  // on the velocity after each scan without registration

estimation::MotionEstimate start(const Config& config) {
  estimation::MotionVector deviation;
  deviation << Eigen::Matrix<double, 6, 1>::Constant(kStartPose),
      Eigen::Vector3d::Constant(kStartSpeed), Eigen::Vector3d::Constant(kStartRate),
      Eigen::Vector3d::Constant(config.acceleration_m_s2),
      Eigen::Vector3d::Constant(config.angular_acceleration_rad_s2);
  return {{}, deviation.cwiseAbs2().asDiagonal()};
}

}  // namespace

ArenaLo::ArenaLo(const Config& config, const LidarInfo& lidar, Parallel parallel)
    : config_(config),
      body_from_lidar_(lidar.body_from_lidar),
      parallel_(std::move(parallel)),
      known_{start(config), Time{0}},
      map_(config.map.options()),
      tracking_(config.tracking),
      scan_duration_(from_seconds(1.0 / lidar.rate_hz)) {}

ScanResult ArenaLo::track(const Scan& scan) {
  const estimation::ScanTimes times = estimation::times_of(scan, scan_duration_);
  const std::vector<Slice> slices = slices_of(scan, times, slice_duration(times), config_);
  if (map_.empty()) opening_ = {slices, {start(config_), slices.front().middle}, times.last};
  if (scans_mapped_ == 1) begin_again(slices, times.last);
  const Registration found = align(slices, times.last);
  const Measurement& measurement = found.measurement;
  const ScanStatus status = status_of(found, count_points(slices));
  const bool used = is_used(status);
  const bool moves_on = used || map_.empty();
  const Steps steps = moves_on ? found.steps : coasted(slices, times.last);
  const Motion motion = moves_on ? found.motion : estimation::smoothed(steps);

  const std::vector<Eigen::Vector3f> points = points_in_map(slices, motion);
  std::vector<StampedPose> revised = revise(steps, motion);
  advance(slices, steps, times);
  if (used) grow_map(points);
  if (scans_mapped_ > 1) opening_.reset();
  registered_scan_ = transformed(body_from_lidar_, points);
  return {.estimate = poses_.back(),
          .status = status,
          .counters = {.points = points.size()},
          .motion = times.timed ? poses_within(last_, motion) : std::vector<StampedPose>{},
          .revised = std::move(revised),
          .details = {{"keypoints", measurement.points},
                      {"matches", measurement.on_planes},
                      {"near_planes", measurement.near_planes},
                      {"iterations", found.passes},
                      {"map_points", map_.fine().size()},
                      {"inserted", used}}};
}

double ArenaLo::slice_duration(const estimation::ScanTimes& times) const {
  return scans_mapped_ <= 1 ? std::max(config_.slice_s, times.seconds()) : config_.slice_s;
}

void ArenaLo::begin_again(const std::vector<Slice>& second, Time end) {
  const double seconds = to_seconds(second.front().middle - opening_->known.instant);
  if (seconds <= 0.0) return;
  for (int pass = 0; pass < kStartPasses; ++pass) {
    known_ = opening_->known;
    const Registration found = align(second, end);
    if (found.measurement.near_planes < kMinMatches) return;
    const Pose moved = found.motion.front().state.pose;
    estimation::MotionState& state = opening_->known.estimate.state;
    state.velocity = moved.translation() / seconds;
    state.rate = so3::log(moved.linear()) / seconds;
    map_.clear();
    map_.insert(placed(opening_->slices.front(), state, Pose::Identity(), parallel_),
                Eigen::Vector3f::Zero());
  }
  known_ = opening_->known;
  const auto published = std::ranges::find(poses_, opening_->end, &StampedPose::stamp);
  const double after_middle = to_seconds(opening_->end - known_.instant);
  *published = body_pose(opening_->end, known_.estimate.state.pose_after(after_middle));
}

Registration ArenaLo::align(const std::vector<Slice>& slices, Time end) const {
  if (!map_.empty()) return register_slices(known_, slices, end, map_, config_, parallel_);
  return {Steps(slices.size() + 1, {{known_.estimate}, known_.estimate}),
          Motion(slices.size() + 1, known_.estimate),
          {},
          0};
}

ScanStatus ArenaLo::status_of(const Registration& found, std::size_t points) {
  const Measurement& measurement = found.measurement;
  if (points == 0) return ScanStatus::kTooFewPoints;
  if (map_.empty()) return ScanStatus::kInitializing;
  if (measurement.near_planes < kMinMatches) return ScanStatus::kTooFewPoints;
  const double share =
      static_cast<double>(measurement.on_planes) / static_cast<double>(measurement.near_planes);
  const double returns_per_average =
      static_cast<double>(points) / static_cast<double>(measurement.points);
  const ScanStatus status =
      tracking_.judge(share, leaves_a_direction_open(found.contacts, returns_per_average));
  return tracking_.is_lost() ? ScanStatus::kDiverged : status;
}

bool ArenaLo::is_used(ScanStatus status) const {
  return status != ScanStatus::kTooFewPoints && !tracking_.contradicts();
}

Steps ArenaLo::coasted(const std::vector<Slice>& slices, Time end) const {
  Steps steps = coast(known_, slices, end, config_);
  estimation::MotionState& last = steps.back().estimate.state;
  last.velocity *= kLostMotionFactor;
  last.rate *= kLostMotionFactor;
  return steps;
}

std::vector<StampedPose> ArenaLo::revise(const Steps& steps, const Motion& motion) {
  if (scans_mapped_ < 2) return {};
  Steps before = last_.steps;
  before.push_back({steps.front().prediction, motion.front()});
  const std::vector<StampedPose> revised = poses_within(last_, estimation::smoothed(before));
  poses_.back() = revised.back();
  return revised;
}

void ArenaLo::advance(const std::vector<Slice>& slices, const Steps& steps,
                      const estimation::ScanTimes& times) {
  last_ = {times, {}, steps};
  for (const Slice& slice : slices) last_.instants.push_back(slice.middle);
  last_.instants.push_back(times.last);
  known_ = {steps.back().estimate, times.last};
  poses_.push_back(body_pose(times.last, known_.estimate.state.pose));
  if (times.timed) scan_duration_ = times.last - times.first;
}

void ArenaLo::grow_map(const std::vector<Eigen::Vector3f>& points) {
  if (scans_mapped_ < kStartScans) map_.clear();
  ++scans_mapped_;
  const Eigen::Vector3f sensor = known_.estimate.state.pose.translation().cast<float>();
  map_.insert(points, sensor);
  map_.follow(sensor);
}

std::vector<Eigen::Vector3f> ArenaLo::points_in_map(const std::vector<Slice>& slices,
                                                    const Motion& motion) const {
  std::vector<Eigen::Vector3f> points;
  points.reserve(count_points(slices));
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const auto part = placed(slices[i], motion[i].state, Pose::Identity(), parallel_);
    points.insert(points.end(), part.begin(), part.end());
  }
  return points;
}

std::vector<StampedPose> ArenaLo::poses_within(const ScanSteps& scan, const Motion& motion) const {
  std::vector<StampedPose> poses;
  if (scan.times.timed) {
    const double lead = to_seconds(scan.times.first - scan.instants.front());
    poses.push_back(body_pose(scan.times.first, motion.front().state.pose_after(lead)));
  }
  for (std::size_t i = 0; i < scan.instants.size(); ++i)
    poses.push_back(body_pose(scan.instants[i], motion[i].state.pose));
  return poses;
}

StampedPose ArenaLo::body_pose(Time instant, const Pose& map_from_lidar) const {
  return {instant, body_from_lidar_ * map_from_lidar * body_from_lidar_.inverse()};
}

std::vector<Eigen::Vector3f> ArenaLo::map() const {
  return transformed(body_from_lidar_, map_.fine().centers());
}

MemoryUse ArenaLo::memory() const {
  return {.map = map_.memory_bytes(),
          .scan_buffer = registered_scan_.capacity() * sizeof(Eigen::Vector3f),
          .other = poses_.capacity() * sizeof(StampedPose) +
                   last_.steps.capacity() * sizeof(estimation::MotionStep)};
}

}  // namespace lidarena::odometry::arena_lo
