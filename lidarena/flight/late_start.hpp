// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <memory>
#include <optional>

#include "lidarena/flight/flight.hpp"

namespace lidarena::flight {

/// A flight from a later instant on, where it usually is in motion: time 0 is `begin` of the whole
/// flight. As outside of any flight, the body rests before that.
class LateStart final : public Flight {
 public:
  /// `begin` must lie within the flight, before its end.
  LateStart(std::unique_ptr<Flight> whole, Time begin);

  Motion at(Time t) const override;
  Pose pose_at(Time t) const override { return whole_->pose_at(std::max(t, Time{0}) + begin_); }
  Time duration() const override { return whole_->duration() - begin_; }
  const RecordedImu* recorded_imu() const override { return imu_ ? &*imu_ : nullptr; }

 private:
  std::unique_ptr<Flight> whole_;
  Time begin_;
  std::optional<RecordedImu> imu_;
};

}  // namespace lidarena::flight
