// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/flight/flight.hpp"

namespace lidarena::sensor {

/// The samples of a flight's real IMU, in place of a simulated one's, in the axes of the IMU that
/// the rig describes. Has the interface of Imu.
class RecordedImuReader {
 public:
  /// `body_from_imu`: pose of the IMU `id` that the rig describes. Throws InputError if it is not
  /// where the recorded one was, or there are no samples.
  RecordedImuReader(const flight::RecordedImu& recorded, const Pose& body_from_imu,
                    const std::string& id);

  /// Time::max() after the last sample.
  Time next_stamp() const;
  Time next_true_time() const { return next_stamp(); }
  ImuSample measure(const flight::Flight&) { return samples_[next_++]; }
  /// Stamp of the first sample at or after `t`; `t` itself if there is none.
  Time first_stamp_from(Time t) const;

 private:
  std::vector<ImuSample> samples_;
  std::size_t next_ = 0;
};

}  // namespace lidarena::sensor
