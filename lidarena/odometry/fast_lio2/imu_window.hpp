// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "lidarena/base/imu_sample.hpp"

namespace lidarena::fast_lio2 {

/// Rate and specific force between two instants, held constant: the mean of the samples at both.
struct ImuInput {
  Time begin{0};
  Time end{0};
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< rad/s
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< m/s^2
  bool gap = false;                                 ///< too long to be trusted
  double seconds() const { return to_seconds(end - begin); }
};

/// Mean and spread of some samples.
struct ImuStatistics {
  std::size_t count = 0;
  Eigen::Vector3d mean_gyro = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_accel = Eigen::Vector3d::Zero();
  double gyro_sigma = 0.0;   ///< rad/s, root of the mean square over three axes
  double accel_sigma = 0.0;  ///< m/s^2
};
ImuStatistics statistics(const std::vector<ImuSample>& samples);

/// IMU samples that wait for the scan they span.
class ImuWindow {
 public:
  explicit ImuWindow(double max_gap_s) : max_gap_(from_seconds(max_gap_s)) {}

  /// Refuses samples that are not finite or not later than the one before; true if it was taken.
  bool add(const ImuSample& sample);
  /// Inputs from where the last call ended (at first: from the first sample) to `end`, and the
  /// samples among them. The sample at `end` is interpolated, or the last one if none follows.
  std::vector<ImuInput> take_until(Time end, std::vector<ImuSample>& samples);

  bool empty() const { return waiting_.empty() && !last_; }
  std::size_t refused() const { return refused_; }
  std::uint64_t memory_bytes() const { return waiting_.size() * sizeof(ImuSample); }

 private:
  ImuInput between(const ImuSample& a, const ImuSample& b) const;

  Time max_gap_;
  std::deque<ImuSample> waiting_;
  std::optional<ImuSample> last_;  ///< where the last call ended
  Time newest_{Time::min()};
  std::size_t refused_ = 0;
};

}  // namespace lidarena::fast_lio2
