// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/stream_merge.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::dataset {

StreamMerge::StreamMerge(std::string place, const std::vector<std::string>& imu_ids)
    : place_(std::move(place)) {
  for (const std::string& id : imu_ids) covered_[id] = Time::min();
}

void StreamMerge::push(Event event) {
  if (std::holds_alternative<ImuSample>(event.data)) {
    push_imu(std::move(event));
  } else {
    push_scan(std::move(event));
  }
}

void StreamMerge::finish() {
  for (auto& [end, scan] : waiting_) ready_.push_back(std::move(scan));
  waiting_.clear();
}

std::optional<Event> StreamMerge::pop() {
  if (ready_.empty()) return std::nullopt;
  Event event = std::move(ready_.front());
  ready_.pop_front();
  return event;
}

void StreamMerge::fail_not_increasing(const Event& event, Time previous, Time stamp) const {
  throw InputError(place_,
                   fmt::format("times do not increase: '{}' has {} s after {} s", event.sensor_id,
                               format_seconds(stamp), format_seconds(previous)),
                   "the file holds several recordings, or a clock was set; split it there");
}

void StreamMerge::push_imu(Event event) {
  const Time stamp = std::get<ImuSample>(event.data).stamp;
  const auto latest = latest_imu_.try_emplace(event.sensor_id, stamp).first;
  if (stamp < latest->second) fail_not_increasing(event, latest->second, stamp);
  latest->second = stamp;
  if (const auto imu = covered_.find(event.sensor_id); imu != covered_.end()) imu->second = stamp;
  ready_.push_back(std::move(event));
  release();
}

void StreamMerge::push_scan(Event event) {
  const Scan& scan = std::get<Scan>(event.data);
  const auto [latest, first] = latest_scan_.try_emplace(event.sensor_id, scan.stamp);
  if (!first && scan.stamp <= latest->second)
    fail_not_increasing(event, latest->second, scan.stamp);
  latest->second = scan.stamp;
  const Time end = end_of(scan);
  waiting_.emplace_back(end, std::move(event));
  release();
  if (waiting_.empty() || end - waiting_.front().first <= kMaxGap) return;
  const auto late =
      std::ranges::min_element(covered_, {}, [](const auto& imu) { return imu.second; });
  throw InputError(
      place_,
      fmt::format("IMU '{}' has no sample from {} s on, while scans continue to {} s", late->first,
                  format_seconds(waiting_.front().first), format_seconds(end)),
      "cut the recording there, or leave out the IMU's topic");
}

void StreamMerge::release() {
  Time covered = Time::max();
  for (const auto& [id, latest] : covered_) covered = std::min(covered, latest);
  while (!waiting_.empty() && waiting_.front().first <= covered) {
    ready_.push_back(std::move(waiting_.front().second));
    waiting_.pop_front();
  }
}

}  // namespace lidarena::dataset
