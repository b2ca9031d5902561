// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "lidarena/base/imu_sample.hpp"

namespace lidarena {

/// Rate and specific force between two instants, held constant: the mean of the values at both.
struct ImuInterval {
  Time begin{0};
  Time end{0};
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< rad/s
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< m/s^2
  bool gap = false;                                 ///< too far from any sample to be reliable
  double seconds() const { return to_seconds(end - begin); }
};

/// The most recent IMU samples, which can be queried repeatedly for any span of time.
class ImuBuffer {
 public:
  explicit ImuBuffer(double max_gap_s) : max_gap_(from_seconds(max_gap_s)) {}

  /// Adds a sample. Returns false if it is rejected: not finite, or not later than the one before.
  bool add(const ImuSample& sample);
  /// Consecutive intervals that cover `begin` to `end`, cut at the samples. Values between samples
  /// are interpolated; before the first and after the last sample, the values of that sample are
  /// used. Empty without samples, and unless begin < end.
  std::vector<ImuInterval> between(Time begin, Time end) const;
  /// The samples themselves in [begin, end].
  std::vector<ImuSample> samples(Time begin, Time end) const;
  /// Removes the samples that queries for `t` or later do not need.
  void forget_before(Time t);

  bool empty() const { return samples_.empty(); }
  std::size_t refused() const { return refused_; }
  std::uint64_t memory_bytes() const { return samples_.size() * sizeof(ImuSample); }

 private:
  ImuSample at(Time t) const;
  bool is_gap(Time t) const;

  Time max_gap_;
  std::deque<ImuSample> samples_;
  std::size_t refused_ = 0;
};

}  // namespace lidarena
