// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lidarena/base/event.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/sensor/imu.hpp"
#include "lidarena/sensor/lidar.hpp"

namespace lidarena::sensor {

/// A LiDAR and the IMU inside it, in a world that advances in time steps, as in a physics engine.
/// Each step casts the shots that fall into it, each from the body's pose at its own instant
/// (interpolated linearly between two steps, with an error of at most a h^2 / 8: 1.3e-6 m at
/// 10 m/s^2 and 1 ms), against the world at the end of the step. The noise of each shot equals that
/// of simulate() for the same id and seed. Scan k begins at k * period of the simulator's clock;
/// sample k of the IMU is at k / rate. Vibration is felt by the IMU alone: it does not move the
/// LiDAR here.
class SteppedSensor {
 public:
  /// The first scan is the first one that begins at or after `start`. Throws InputError as
  /// make_pattern() and Lidar do.
  SteppedSensor(const SensorConfig& config, const std::string& id, std::uint64_t seed, bool noise,
                Time start);

  /// Advances to the body pose `pose`; `world` is the world at that instant. Appends to `events`
  /// the measurements that are complete, in the order of EventSource: IMU samples one step late
  /// (see StepFlight), a scan after the samples that cover it. A step back in time restarts the
  /// sensor.
  void step(const world::Surfaces& world, const StampedPose& pose, std::vector<Event>& events);

  const Lidar& lidar() const { return lidar_; }
  std::uint64_t rays() const { return rays_; }  ///< cast so far

 private:
  void start_at(Time start);
  void cast(const world::Surfaces& world, const StampedPose& pose);
  void cast_frozen(const world::Surfaces& world, const PoseAt& world_from_lidar);
  void finish_scan();
  /// True instant at which the scan being simulated begins.
  Time begin() const { return lidar_.begin(index_); }
  void sample(std::vector<Event>& events);
  void deliver(std::vector<Event>& events);

  std::string id_;
  std::uint64_t seed_;
  bool noise_;
  Lidar lidar_;
  std::optional<Imu> imu_;
  std::vector<StampedPose> poses_;  ///< the last three
  std::uint64_t index_ = 0;         ///< of the scan being simulated
  std::size_t next_shot_ = 0;
  std::vector<Beam> storage_;
  std::span<const Beam> shots_;  ///< of that scan
  Scan scan_;
  std::vector<Scan> waiting_;  ///< scans that wait for IMU samples
  std::uint64_t rays_ = 0;
};

}  // namespace lidarena::sensor
