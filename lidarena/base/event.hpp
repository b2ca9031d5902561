// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/scan.hpp"

namespace lidarena {

/// One measurement and the sensor (its id in the rig) that made it.
struct Event {
  std::string sensor_id;
  std::variant<ImuSample, Scan> data;
};

/// Measurements in order: IMU samples by time, and each scan only after every IMU sample up to the
/// scan's last point. Implemented by the simulator and by all dataset readers.
class EventSource {
 public:
  virtual ~EventSource() = default;
  /// The next event; empty at the end. Throws InputError on broken input.
  virtual std::optional<Event> next() = 0;
};

class EventSink {
 public:
  virtual ~EventSink() = default;
  virtual void write(const Event& event) = 0;
  /// Completes the output, which otherwise stays recognizable as unfinished. Throws Error when the
  /// disk is full.
  virtual void close() = 0;
};

}  // namespace lidarena
