// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "lidarena/base/imu_sample.hpp"

namespace lidarena {

/// Rate and specific force between two instants, held constant: the mean of those at both.
struct ImuInterval {
  Time begin{0};
  Time end{0};
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< rad/s
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< m/s^2
  bool gap = false;                                 ///< too far from any sample to be trusted
  double seconds() const { return to_seconds(end - begin); }
};

/// The IMU's last samples, which can be asked for any span of time, and again.
class ImuBuffer {
 public:
  explicit ImuBuffer(double max_gap_s) : max_gap_(from_seconds(max_gap_s)) {}

  /// Refuses samples that are not finite or not later than the one before; true if it was taken.
  bool add(const ImuSample& sample);
  /// Intervals without gap between them from `begin` to `end`, cut at the samples. What lies
  /// between samples is interpolated; the first and the last sample hold beyond. Empty without
  /// samples, and unless begin < end.
  std::vector<ImuInterval> between(Time begin, Time end) const;
  /// The samples themselves in [begin, end].
  std::vector<ImuSample> samples(Time begin, Time end) const;
  /// Forgets what no question about `t` or later needs.
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
