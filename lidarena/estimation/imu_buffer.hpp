// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "lidarena/base/imu_sample.hpp"

namespace lidarena::estimation {

/// One flag for each of the axes x, y, z.
using Axes = Eigen::Array<bool, 3, 1>;

/// Rate and specific force between two instants, held constant: the mean of the values at both.
struct ImuInterval {
  Time begin{0};
  Time end{0};
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< rad/s
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< m/s^2
  bool gap = false;                                 ///< too far from any sample to be reliable
  Axes gyro_clipped = Axes::Constant(false);        ///< one of its samples is at the range's end
  Axes accel_clipped = Axes::Constant(false);       ///< the same of the accelerometer
  double seconds() const { return to_seconds(end - begin); }
  bool saturated() const { return gyro_clipped.any() || accel_clipped.any(); }
};
/// Duration of the longest gap, s; 0 if there is none.
double longest_gap_s(const std::vector<ImuInterval>& intervals);
/// Longest time from a sample to the next, or from the last one to `end`, s; 0 without samples.
double longest_pause_s(const std::vector<ImuSample>& samples, Time end);
std::size_t count_saturated(const std::vector<ImuInterval>& intervals);

/// The most recent IMU samples, which can be queried repeatedly for any span of time.
/// A sensor is at the end of its range where an axis repeats a large value to the last bit, which
/// noise hardly ever does. (Few data sheets give the range that a maker has set.)
class ImuBuffer {
 public:
  explicit ImuBuffer(double max_gap_s) : max_gap_(from_seconds(max_gap_s)) {}

  /// Adds a sample. Returns false if it is rejected: not finite, or not later than the one before.
  /// A stamp far ahead of all others is dropped when the next sample shows that it was wrong.
  bool add(const ImuSample& sample);
  /// Factor that converts accelerations to m/s^2; used for judging saturation alone.
  void set_accel_scale(double scale) { accel_scale_ = scale; }
  /// Consecutive intervals that cover `begin` to `end`, cut at the samples. Values between samples
  /// are interpolated; before the first and after the last sample, the values of that sample are
  /// used. Empty without samples, and unless begin < end.
  std::vector<ImuInterval> between(Time begin, Time end) const;
  /// The samples themselves in [begin, end].
  std::vector<ImuSample> samples(Time begin, Time end) const;
  /// Removes the samples that queries for `t` or later do not need.
  void remove_before(Time t);

  bool empty() const { return samples_.empty(); }
  /// Of the first sample that is not forgotten; the buffer is not empty.
  Time first_stamp() const { return samples_.front().stamp; }
  std::size_t refused() const { return refused_; }
  std::uint64_t memory_bytes() const { return samples_.size() * sizeof(ImuSample); }

 private:
  ImuSample at(Time t) const;
  bool is_gap(Time t) const;
  ImuInterval with_clipped(ImuInterval interval) const;

  Time max_gap_;
  double accel_scale_ = 1.0;
  std::deque<ImuSample> samples_;
  Time before_newest_{Time::min()};  ///< stamp of the sample that was added before the last one
  std::size_t refused_ = 0;
};

}  // namespace lidarena::estimation
