// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/imu_buffer.hpp"

#include <algorithm>

namespace lidarena {
namespace {

auto first_after(const std::deque<ImuSample>& samples, Time t) {
  return std::upper_bound(samples.begin(), samples.end(), t,
                          [](Time instant, const ImuSample& s) { return instant < s.stamp; });
}

}  // namespace

bool ImuBuffer::add(const ImuSample& sample) {
  const bool later = samples_.empty() || sample.stamp > samples_.back().stamp;
  if (!later || !sample.gyro.allFinite() || !sample.accel.allFinite()) {
    ++refused_;
    return false;
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
    intervals.push_back({a.stamp, cut, 0.5 * (a.gyro + b.gyro), 0.5 * (a.accel + b.accel),
                         is_gap(after == samples_.end() ? cut : a.stamp)});
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

void ImuBuffer::forget_before(Time t) {
  while (samples_.size() > 1 && samples_[1].stamp <= t) samples_.pop_front();
}

}  // namespace lidarena
