// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "lidarena/base/imu_sample.hpp"

namespace lidarena::fast_lio2 {

/// Rate and specific force between two instants, taken as constant: the mean of the two samples.
struct ImuInput {
  Time begin{0};
  Time end{0};
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< rad/s
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< m/s^2
  bool gap = false;                                 ///< too long between the samples
  bool clipped = false;                             ///< a sample was at the end of its range
  double seconds() const { return to_seconds(end - begin); }
};

/// Whether the sensor is at the end of its measuring range: an axis repeats a large value to the
/// last bit, which noise makes very unlikely otherwise. Few data sheets give the range itself.
/// `accel_scale` converts the accelerations to m/s^2.
bool is_clipped(const ImuSample& before, const ImuSample& sample, double accel_scale);

/// Buffer of IMU samples up to the scan during which they were taken.
class ImuWindow {
 public:
  explicit ImuWindow(double max_gap_s) : max_gap_(from_seconds(max_gap_s)) {}

  /// Rejects samples that are not finite or not later than the previous one; returns whether the
  /// sample was accepted. A sample with a stamp far ahead of the others is removed when the next
  /// sample shows that.
  bool add(const ImuSample& sample);
  /// Returns the inputs from the end of the last call (at first: from the first sample) to `end`,
  /// and appends the samples of that time. The sample at `end` is interpolated, or a copy of the
  /// last one if none follows.
  std::vector<ImuInput> take_until(Time end, std::vector<ImuSample>& samples);

  /// Factor from the samples' accelerations to m/s^2; used only to detect clipping.
  void set_accel_scale(double scale) { accel_scale_ = scale; }
  bool empty() const { return waiting_.empty() && !last_; }
  std::size_t refused() const { return refused_; }
  /// Number of clipped inputs of the last call, and its longest gap, s.
  std::size_t clipped() const { return clipped_; }
  double longest_gap_s() const { return longest_gap_s_; }
  std::uint64_t memory_bytes() const { return waiting_.size() * sizeof(ImuSample); }

 private:
  ImuInput between(const ImuSample& a, const ImuSample& b) const;
  /// From the last sample to `end`, interpolated towards the next sample if there is one.
  ImuInput last_input(Time end);
  void note(const std::vector<ImuInput>& inputs);

  Time max_gap_;
  double accel_scale_ = 1.0;
  std::deque<ImuSample> waiting_;
  std::optional<ImuSample> last_;  ///< at the end of the last call
  Time newest_{Time::min()};
  Time before_newest_{Time::min()};
  std::size_t refused_ = 0;
  std::size_t clipped_ = 0;
  double longest_gap_s_ = 0.0;
};

}  // namespace lidarena::fast_lio2
