// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/fast_lio2/imu_window.hpp"

#include <algorithm>
#include <chrono>

namespace lidarena::fast_lio2 {
namespace {

constexpr Time kJump = std::chrono::seconds(1);  // longer than any pause of a working IMU
// Smallest ranges of IMUs for vehicles, 125 deg/s and 2 g: smaller readings are not clipped.
constexpr double kSmallestGyroRange = 2.1;    // rad/s
constexpr double kSmallestAccelRange = 18.6;  // m/s^2

bool stuck(const Eigen::Vector3d& before, const Eigen::Vector3d& now, double range) {
  return ((before.array() == now.array()) && (now.array().abs() > range)).any();
}

}  // namespace

bool is_clipped(const ImuSample& before, const ImuSample& sample, double accel_scale) {
  return stuck(before.gyro, sample.gyro, kSmallestGyroRange) ||
         stuck(before.accel, sample.accel, kSmallestAccelRange / accel_scale);
}

bool ImuWindow::add(const ImuSample& sample) {
  const auto refuse = [this] {
    ++refused_;
    return false;
  };
  if (!sample.gyro.allFinite() || !sample.accel.allFinite()) return refuse();
  if (sample.stamp <= newest_) {
    // Either this stamp is wrong, or the previous one was far ahead of all others.
    const bool jumped = !waiting_.empty() && waiting_.back().stamp == newest_ &&
                        newest_ - before_newest_ > kJump && sample.stamp > before_newest_;
    if (!jumped) return refuse();
    waiting_.pop_back();
    ++refused_;
    newest_ = before_newest_;
  }
  before_newest_ = newest_ == Time::min() ? sample.stamp : newest_;
  newest_ = sample.stamp;
  waiting_.push_back(sample);
  return true;
}

ImuInput ImuWindow::between(const ImuSample& a, const ImuSample& b) const {
  return {a.stamp,
          b.stamp,
          0.5 * (a.gyro + b.gyro),
          0.5 * (a.accel + b.accel),
          b.stamp - a.stamp > max_gap_,
          is_clipped(a, b, accel_scale_)};
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
  if (last_ && last_->stamp < end) inputs.push_back(last_input(end));
  note(inputs);
  return inputs;
}

ImuInput ImuWindow::last_input(Time end) {
  ImuSample at_end = *last_;
  at_end.stamp = end;
  Time silence = end - last_->stamp;
  bool clipped = false;
  if (!waiting_.empty()) {
    const ImuSample& next = waiting_.front();
    silence = next.stamp - last_->stamp;
    const double share = to_seconds(end - last_->stamp) / to_seconds(silence);
    at_end.gyro += share * (next.gyro - last_->gyro);
    at_end.accel += share * (next.accel - last_->accel);
    clipped = is_clipped(*last_, next, accel_scale_);
  }
  ImuInput input = between(*last_, at_end);
  input.gap = silence > max_gap_;
  input.clipped = clipped;
  last_ = at_end;
  return input;
}

void ImuWindow::note(const std::vector<ImuInput>& inputs) {
  clipped_ = 0;
  longest_gap_s_ = 0.0;
  for (const ImuInput& input : inputs) {
    clipped_ += input.clipped ? 1 : 0;
    if (input.gap) longest_gap_s_ = std::max(longest_gap_s_, input.seconds());
  }
}

}  // namespace lidarena::fast_lio2
