// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/imu_window.hpp"

#include <cmath>

namespace lidarena::fast_lio2 {

ImuStatistics statistics(const std::vector<ImuSample>& samples) {
  ImuStatistics s;
  s.count = samples.size();
  if (samples.empty()) return s;
  const auto n = static_cast<double>(s.count);
  for (const ImuSample& sample : samples) {
    s.mean_gyro += sample.gyro / n;
    s.mean_accel += sample.accel / n;
  }
  double gyro = 0.0;
  double accel = 0.0;
  for (const ImuSample& sample : samples) {
    gyro += (sample.gyro - s.mean_gyro).squaredNorm();
    accel += (sample.accel - s.mean_accel).squaredNorm();
  }
  s.gyro_sigma = std::sqrt(gyro / (3.0 * n));
  s.accel_sigma = std::sqrt(accel / (3.0 * n));
  return s;
}

bool ImuWindow::add(const ImuSample& sample) {
  if (sample.stamp <= newest_ || !sample.gyro.allFinite() || !sample.accel.allFinite()) {
    ++refused_;
    return false;
  }
  newest_ = sample.stamp;
  waiting_.push_back(sample);
  return true;
}

ImuInput ImuWindow::between(const ImuSample& a, const ImuSample& b) const {
  return {a.stamp, b.stamp, 0.5 * (a.gyro + b.gyro), 0.5 * (a.accel + b.accel),
          b.stamp - a.stamp > max_gap_};
}

std::vector<ImuInput> ImuWindow::take_until(Time end, std::vector<ImuSample>& samples) {
  std::vector<ImuInput> inputs;
  while (!waiting_.empty() && waiting_.front().stamp <= end) {
    const ImuSample& sample = waiting_.front();
    if (last_ && last_->stamp < sample.stamp) inputs.push_back(between(*last_, sample));
    samples.push_back(sample);
    last_ = sample;
    waiting_.pop_front();
  }
  if (!last_ || last_->stamp >= end) return inputs;
  ImuSample at_end = *last_;
  at_end.stamp = end;
  bool gap = end - last_->stamp > max_gap_;
  if (!waiting_.empty()) {
    const ImuSample& next = waiting_.front();
    const double share = to_seconds(end - last_->stamp) / to_seconds(next.stamp - last_->stamp);
    at_end.gyro += share * (next.gyro - last_->gyro);
    at_end.accel += share * (next.accel - last_->accel);
    gap = next.stamp - last_->stamp > max_gap_;
  }
  inputs.push_back(between(*last_, at_end));
  inputs.back().gap = gap;
  last_ = at_end;
  return inputs;
}

}  // namespace lidarena::fast_lio2
