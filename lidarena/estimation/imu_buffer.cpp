// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/imu_buffer.hpp"

#include <algorithm>
#include <chrono>

namespace lidarena::estimation {
namespace {

constexpr Time kMaxPause = std::chrono::seconds(1);  // no IMU pauses longer and then continues
// The smallest ranges of IMUs for vehicles: 125 deg/s and 2 g.
constexpr double kMinGyroRange = 2.1;    // rad/s
constexpr double kMinAccelRange = 18.6;  // m/s^2

Axes repeated(const Eigen::Vector3d& previous, const Eigen::Vector3d& value, double min_range) {
  return (previous.array() == value.array()) && (value.array().abs() > min_range);
}

auto first_after(const std::deque<ImuSample>& samples, Time t) {
  return std::upper_bound(samples.begin(), samples.end(), t,
                          [](Time instant, const ImuSample& s) { return instant < s.stamp; });
}

}  // namespace

double longest_gap_s(const std::vector<ImuInterval>& intervals) {
  double longest = 0.0;
  for (const ImuInterval& interval : intervals)
    if (interval.gap) longest = std::max(longest, interval.seconds());
  return longest;
}

double longest_pause_s(const std::vector<ImuSample>& samples, Time end) {
  Time longest{0};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Time next = i + 1 < samples.size() ? samples[i + 1].stamp : end;
    longest = std::max(longest, next - samples[i].stamp);
  }
  return to_seconds(longest);
}

std::size_t count_saturated(const std::vector<ImuInterval>& intervals) {
  return static_cast<std::size_t>(
      std::count_if(intervals.begin(), intervals.end(),
                    [](const ImuInterval& interval) { return interval.saturated(); }));
}

bool ImuBuffer::add(const ImuSample& sample) {
  if (!sample.gyro.allFinite() || !sample.accel.allFinite()) {
    ++refused_;
    return false;
  }
  if (!samples_.empty() && sample.stamp <= samples_.back().stamp) {
    ++refused_;
    // Either this stamp is wrong, or the previous one, if that was far ahead of all others.
    const bool previous_jumped = before_newest_ != Time::min() && sample.stamp > before_newest_ &&
                                 samples_.back().stamp - before_newest_ > kMaxPause;
    if (!previous_jumped) return false;
    samples_.pop_back();
  } else if (!samples_.empty()) {
    before_newest_ = samples_.back().stamp;
  }
  samples_.push_back(sample);
  return true;
}

ImuSample ImuBuffer::at(Time t) const {
  const auto after = first_after(samples_, t);
  if (after == samples_.begin()) return samples_.front();
  if (after == samples_.end()) return samples_.back();
  const ImuSample& a = *(after - 1);
  const double share = to_seconds(t - a.stamp) / to_seconds(after->stamp - a.stamp);
  return {t, a.gyro + share * (after->gyro - a.gyro), a.accel + share * (after->accel - a.accel)};
}

bool ImuBuffer::is_gap(Time t) const {
  const auto after = first_after(samples_, t);
  if (after == samples_.begin()) return samples_.front().stamp - t > max_gap_;
  if (after == samples_.end()) return t - samples_.back().stamp > max_gap_;
  return after->stamp - (after - 1)->stamp > max_gap_;
}

ImuInterval ImuBuffer::with_clipped(ImuInterval interval) const {
  const auto after = first_after(samples_, interval.begin);
  if (after == samples_.begin() || after == samples_.end()) return interval;
  // A run of equal values may end with the interval's first sample, or begin with its second one.
  auto previous = after - 1;
  if (previous != samples_.begin()) --previous;
  const auto end = after + 1 == samples_.end() ? samples_.end() : after + 2;
  for (auto sample = previous + 1; sample != end; previous = sample++) {
    interval.gyro_clipped =
        interval.gyro_clipped || repeated(previous->gyro, sample->gyro, kMinGyroRange);
    interval.accel_clipped =
        interval.accel_clipped ||
        repeated(previous->accel, sample->accel, kMinAccelRange / accel_scale_);
  }
  return interval;
}

std::vector<ImuInterval> ImuBuffer::between(Time begin, Time end) const {
  std::vector<ImuInterval> intervals;
  if (samples_.empty()) return intervals;
  ImuSample a = at(begin);
  a.stamp = begin;
  while (a.stamp < end) {
    const auto after = first_after(samples_, a.stamp);
    const Time cut = after == samples_.end() ? end : std::min(end, after->stamp);
    ImuSample b = at(cut);
    b.stamp = cut;
    intervals.push_back(with_clipped({.begin = a.stamp,
                                      .end = cut,
                                      .gyro = 0.5 * (a.gyro + b.gyro),
                                      .accel = 0.5 * (a.accel + b.accel),
                                      .gap = is_gap(after == samples_.end() ? cut : a.stamp)}));
    a = b;
  }
  return intervals;
}

std::vector<ImuSample> ImuBuffer::samples(Time begin, Time end) const {
  std::vector<ImuSample> inside;
  for (const ImuSample& sample : samples_) {
    if (sample.stamp >= begin && sample.stamp <= end) inside.push_back(sample);
  }
  return inside;
}

void ImuBuffer::remove_before(Time t) {
  while (samples_.size() > 1 && samples_[1].stamp <= t) samples_.pop_front();
}

}  // namespace lidarena::estimation
