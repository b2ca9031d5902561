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
  bool clipped = false;                             ///< a sample stood at the end of its range
  double seconds() const { return to_seconds(end - begin); }
};

/// Whether the sensor stands at the end of its range: an axis repeats a large value to the last
/// bit, which noise hardly ever does. The range itself is on few data sheets. `accel_scale` brings
/// the samples to m/s^2.
bool is_clipped(const ImuSample& before, const ImuSample& sample, double accel_scale);

/// IMU samples that wait for the scan they span.
class ImuWindow {
 public:
  explicit ImuWindow(double max_gap_s) : max_gap_(from_seconds(max_gap_s)) {}

  /// Refuses samples that are not finite or not later than the one before; true if it was taken.
  /// A stamp that lies far ahead of all others is refused when the next sample gives it away.
  bool add(const ImuSample& sample);
  /// Inputs from where the last call ended (at first: from the first sample) to `end`, and the
  /// samples among them. The sample at `end` is interpolated, or the last one if none follows.
  std::vector<ImuInput> take_until(Time end, std::vector<ImuSample>& samples);

  /// Brings the samples' accelerations to m/s^2; for judging them alone.
  void set_accel_scale(double scale) { accel_scale_ = scale; }
  bool empty() const { return waiting_.empty() && !last_; }
  std::size_t refused() const { return refused_; }
  /// Inputs of the last call that were clipped, and the longest that was a gap, s.
  std::size_t clipped() const { return clipped_; }
  double longest_gap_s() const { return longest_gap_s_; }
  std::uint64_t memory_bytes() const { return waiting_.size() * sizeof(ImuSample); }

 private:
  ImuInput between(const ImuSample& a, const ImuSample& b) const;
  /// From the last sample to `end`, with the next one's help if that is here.
  ImuInput last_input(Time end);
  void note(const std::vector<ImuInput>& inputs);

  Time max_gap_;
  double accel_scale_ = 1.0;
  std::deque<ImuSample> waiting_;
  std::optional<ImuSample> last_;  ///< where the last call ended
  Time newest_{Time::min()};
  Time before_newest_{Time::min()};
  std::size_t refused_ = 0;
  std::size_t clipped_ = 0;
  double longest_gap_s_ = 0.0;
};

}  // namespace lidarena::fast_lio2
