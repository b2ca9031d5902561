// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/simulate.hpp"

#include <algorithm>
#include <variant>

#include "lidarena/sensor/imu.hpp"
#include "lidarena/sensor/lidar.hpp"
#include "lidarena/sensor/recorded_imu_reader.hpp"

namespace lidarena::sensor {
namespace {

struct ImuStream {
  std::string id;
  std::variant<Imu, RecordedImuReader> imu;

  Time next_stamp() const {
    return std::visit([](const auto& of) { return of.next_stamp(); }, imu);
  }
  Time next_true_time() const {
    return std::visit([](const auto& of) { return of.next_true_time(); }, imu);
  }
  Time first_stamp_from(Time t) const {
    return std::visit([t](const auto& of) { return of.first_stamp_from(t); }, imu);
  }
  ImuSample measure(const flight::Flight& flight) {
    return std::visit([&flight](auto& of) { return of.measure(flight); }, imu);
  }
};

struct LidarStream {
  std::string id;
  Lidar lidar;
  std::uint64_t next = 0;   ///< index of the next scan
  std::uint64_t scans = 0;  ///< number of complete scans in the flight
};

class Simulation final : public EventSource {
 public:
  Simulation(const world::Surfaces& world, const flight::Flight& flight,
             const std::vector<SensorConfig>& sensors, const SimulationOptions& options,
             const Parallel& parallel)
      : world_(world),
        flight_(flight),
        parallel_(parallel),
        truth_(options.truth),
        end_(flight.duration()) {
    if (options.duration > Time{0}) end_ = std::min(end_, options.duration);
    const Rig rig = make_rig(sensors);
    std::size_t imu = 0;
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      const SensorConfig& sensor = sensors[i];
      const std::string& id = rig.lidars[i].id;
      LidarStream stream{id, {sensor, make_pattern(sensor), id, options.seed, options.noise}};
      if (options.lidar.empty() || options.lidar == id)
        stream.scans = static_cast<std::uint64_t>(end_ / stream.lidar.pattern().period());
      lidars_.push_back(std::move(stream));
      if (!sensor.imu) continue;
      const std::string& imu_id = rig.imus[imu++].id;
      const Pose body_from_imu = mounted(sensor) * sensor.imu->lidar_from_imu;
      const flight::RecordedImu* recorded = flight.recorded_imu();
      if (recorded != nullptr && options.noise)
        imus_.push_back({imu_id, RecordedImuReader(*recorded, body_from_imu, imu_id)});
      else
        imus_.push_back({imu_id, Imu(*sensor.imu, body_from_imu, imu_id, options.seed,
                                     options.noise, sensor.noise.clock)});
    }
  }

  std::optional<Event> next() override {
    ImuStream* imu = next_imu();
    LidarStream* lidar = next_lidar();
    if (imu != nullptr && (lidar == nullptr || imu->next_stamp() <= due(*lidar))) {
      return Event{imu->id, imu->measure(flight_)};
    }
    if (lidar == nullptr) return std::nullopt;
    return Event{lidar->id, measure(*lidar)};
  }

 private:
  Scan measure(LidarStream& stream) {
    const std::uint64_t index = stream.next++;
    if (truth_ == nullptr) return stream.lidar.measure(world_, flight_, index, parallel_);
    ScanTruth truth{stream.id, stream.lidar.stamp(index), {}};
    Scan scan = stream.lidar.measure(world_, flight_, index, parallel_, &truth.points);
    truth_->write(truth);
    return scan;
  }

  /// The IMU whose sample is next, on ties the first in the list; nullptr after the end.
  ImuStream* next_imu() {
    ImuStream* first = nullptr;
    for (ImuStream& stream : imus_) {
      if (stream.next_true_time() > end_) continue;
      if (first == nullptr || stream.next_stamp() < first->next_stamp()) first = &stream;
    }
    return first;
  }

  /// The LiDAR whose scan is due next; nullptr if there are no more scans.
  LidarStream* next_lidar() {
    LidarStream* first = nullptr;
    for (LidarStream& lidar : lidars_) {
      if (lidar.next == lidar.scans) continue;
      if (first == nullptr || due(lidar) < due(*first)) first = &lidar;
    }
    return first;
  }

  /// Earliest time at which a scan may be delivered: once every IMU has a sample at or after its
  /// last firing.
  Time due(const LidarStream& stream) const {
    const Time last = stream.lidar.last_firing(stream.next);
    Time covered = last;
    for (const ImuStream& stream_of_imu : imus_) {
      covered = std::max(covered, stream_of_imu.first_stamp_from(last));
    }
    return covered;
  }

  const world::Surfaces& world_;
  const flight::Flight& flight_;
  Parallel parallel_;
  ScanTruthSink* truth_;
  Time end_;
  std::vector<ImuStream> imus_;
  std::vector<LidarStream> lidars_;
};

}  // namespace

std::unique_ptr<EventSource> simulate(const world::Surfaces& world, const flight::Flight& flight,
                                      const std::vector<SensorConfig>& sensors,
                                      const SimulationOptions& options, const Parallel& parallel) {
  return std::make_unique<Simulation>(world, flight, sensors, options, parallel);
}

}  // namespace lidarena::sensor
