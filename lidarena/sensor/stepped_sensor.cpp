// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/stepped_sensor.hpp"

#include <algorithm>

#include "lidarena/sensor/step_flight.hpp"

namespace lidarena::sensor {
namespace {

Lidar make_lidar(const SensorConfig& config, const std::string& id, std::uint64_t seed,
                 bool noise) {
  return {config, make_pattern(config), id, seed, noise};
}

/// The body's pose at `t`, interpolated between two stamped poses.
Pose between(const StampedPose& from, const StampedPose& to, Time t) {
  const double share = to_seconds(t - from.stamp) / to_seconds(to.stamp - from.stamp);
  return interpolate(from.world_from_body, to.world_from_body, std::clamp(share, 0.0, 1.0));
}

}  // namespace

SteppedSensor::SteppedSensor(const SensorConfig& config, const std::string& id, std::uint64_t seed,
                             bool noise, Time start)
    : id_(id), seed_(seed), noise_(noise), lidar_(make_lidar(config, id, seed, noise)) {
  start_at(start);
}

void SteppedSensor::start_at(Time start) {
  const SensorConfig& config = lidar_.config();
  poses_.clear();
  waiting_.clear();
  const Time period = lidar_.pattern().period();
  index_ = static_cast<std::uint64_t>((start + period - Time{1}) / period);
  next_shot_ = 0;
  scan_ = lidar_.empty_scan(index_);
  shots_ = lidar_.beams(index_, storage_);
  if (!config.imu) return;
  imu_.emplace(*config.imu, mounted(config) * config.imu->lidar_from_imu, id_, seed_, noise_,
               config.noise.clock);
}

void SteppedSensor::step(const world::Surfaces& world, const StampedPose& pose,
                         std::vector<Event>& events) {
  if (!poses_.empty() && pose.stamp <= poses_.back().stamp) {
    if (pose.stamp == poses_.back().stamp) return;
    start_at(pose.stamp);
  }
  if (poses_.size() == 3) poses_.erase(poses_.begin());
  poses_.push_back(pose);
  if (poses_.size() > 1) cast(world, pose);
  if (poses_.size() == 3 && imu_) sample(events);
  deliver(events);
}

void SteppedSensor::cast(const world::Surfaces& world, const StampedPose& pose) {
  const StampedPose& last = *(poses_.end() - 2);
  const Pose body_from_lidar = mounted(lidar_.config());
  const PoseAt world_from_lidar = [&](std::int32_t dt_ns) -> Pose {
    return between(last, pose, begin() + Time{dt_ns}) * body_from_lidar;
  };
  const bool rolling = lidar_.config().mode == ScanMode::kRolling;
  while (begin() <= pose.stamp) {
    if (!rolling && next_shot_ == 0) cast_frozen(world, world_from_lidar);
    const std::size_t first = next_shot_;
    while (next_shot_ < shots_.size() && begin() + Time{shots_[next_shot_].dt_ns} <= pose.stamp) {
      ++next_shot_;
    }
    if (rolling && next_shot_ > first) {
      const std::uint64_t ray = index_ * shots_.size() + first;
      lidar_.measure_part(world, world_from_lidar, shots_.subspan(first, next_shot_ - first), ray,
                          scan_.points);
      rays_ += next_shot_ - first;
    }
    if (next_shot_ < shots_.size()) return;
    finish_scan();
  }
}

/// Casts all shots of the scan from the pose at the stamp.
void SteppedSensor::cast_frozen(const world::Surfaces& world, const PoseAt& world_from_lidar) {
  const Pose frozen = world_from_lidar(0);
  const PoseAt constant_pose = [&](std::int32_t) { return frozen; };
  lidar_.measure_part(world, constant_pose, shots_, index_ * shots_.size(), scan_.points);
  rays_ += shots_.size();
}

void SteppedSensor::finish_scan() {
  lidar_.put_ramp(index_, scan_);
  waiting_.push_back(std::move(scan_));
  ++index_;
  next_shot_ = 0;
  scan_ = lidar_.empty_scan(index_);
  shots_ = lidar_.beams(index_, storage_);
}

/// Appends the IMU samples up to the middle one of the three poses.
void SteppedSensor::sample(std::vector<Event>& events) {
  const StepFlight flight({poses_[0], poses_[1], poses_[2]});
  while (imu_->next_stamp() <= poses_[1].stamp) {
    const bool is_old = imu_->next_stamp() < poses_[0].stamp;  // before the sensor's start
    ImuSample sample = imu_->measure(flight);
    if (is_old) continue;
    events.push_back({id_, std::move(sample)});
    deliver(events);
  }
}

/// Delivers a scan once an IMU sample at or after its last firing has been delivered.
void SteppedSensor::deliver(std::vector<Event>& events) {
  const auto is_covered = [&] {
    const std::uint64_t index = index_ - waiting_.size();  // of the first that waits
    return !imu_ || imu_->next_stamp() > imu_->first_stamp_from(lidar_.last_firing(index));
  };
  while (!waiting_.empty() && is_covered()) {
    events.push_back({id_, std::move(waiting_.front())});
    waiting_.erase(waiting_.begin());
  }
}

}  // namespace lidarena::sensor
