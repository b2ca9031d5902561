// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/late_start.hpp"

#include <utility>

namespace lidarena::flight {

LateStart::LateStart(std::unique_ptr<Flight> whole, Time begin)
    : whole_(std::move(whole)), begin_(begin) {
  const RecordedImu* recorded = whole_->recorded_imu();
  if (recorded == nullptr) return;
  imu_ = RecordedImu{{}, recorded->body_from_imu};
  for (ImuSample sample : recorded->samples) {
    sample.stamp -= begin_;
    if (sample.stamp >= Time{0}) imu_->samples.push_back(sample);
  }
}

Motion LateStart::at(Time t) const {
  if (t >= Time{0}) return whole_->at(t + begin_);
  Motion rest;
  rest.world_from_body = pose_at(Time{0});
  return rest;
}

}  // namespace lidarena::flight
