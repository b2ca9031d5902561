// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/stream_merge.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::dataset {

StreamMerge::StreamMerge(std::string place, const std::vector<std::string>& imu_ids,
                         ReadReport* report)
    : place_(std::move(place)), report_(report) {
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

void StreamMerge::refuse(const Event& event, Time previous, Time stamp) const {
  if (report_ != nullptr) {
    const bool is_scan = std::holds_alternative<Scan>(event.data);
    return report_->count(fmt::format("'{}': {} not later than the one before, left out",
                                      event.sensor_id, is_scan ? "sweep" : "IMU sample"),
                          stamp);
  }
  throw InputError(place_,
                   fmt::format("times do not increase: '{}' has {} s after {} s", event.sensor_id,
                               format_seconds(stamp), format_seconds(previous)),
                   "the file holds several recordings, or a clock was set; split it there");
}

void StreamMerge::push_imu(Event event) {
  const Time stamp = std::get<ImuSample>(event.data).stamp;
  const auto [latest, first] = latest_imu_.try_emplace(event.sensor_id, stamp);
  const bool repeats = !first && stamp == latest->second;
  if (stamp < latest->second || (repeats && report_ != nullptr))
    return refuse(event, latest->second, stamp);
  latest->second = stamp;
  if (const auto imu = covered_.find(event.sensor_id); imu != covered_.end()) imu->second = stamp;
  ready_.push_back(std::move(event));
  release();
}

void StreamMerge::push_scan(Event event) {
  const Scan& scan = std::get<Scan>(event.data);
  const auto [latest, first] = latest_scan_.try_emplace(event.sensor_id, scan.stamp);
  if (!first && scan.stamp <= latest->second) return refuse(event, latest->second, scan.stamp);
  latest->second = scan.stamp;
  waiting_.emplace_back(end_of(scan), std::move(event));
  release();
  const auto late = report_ == nullptr ? lagging() : std::nullopt;
  if (!late) return;
  throw InputError(
      place_,
      fmt::format("IMU '{}' has no sample from {} s on, while scans continue to {} s", *late,
                  format_seconds(waiting_.front().first), format_seconds(waiting_.back().first)),
      "cut the recording there, or leave out the IMU's topic");
}

std::optional<std::string> StreamMerge::lagging(Time gap) const {
  if (covered_.empty() || waiting_.empty()) return std::nullopt;
  if (waiting_.back().first - waiting_.front().first <= gap) return std::nullopt;
  return std::ranges::min_element(covered_, {}, [](const auto& imu) { return imu.second; })->first;
}

Time StreamMerge::latest_imu(const std::string& id) const {
  const auto found = latest_imu_.find(id);
  return found == latest_imu_.end() ? Time::min() : found->second;
}

Time StreamMerge::give_up(const std::string& imu) {
  const auto found = covered_.find(imu);
  const Time until = found == covered_.end() ? Time::min() : found->second;
  covered_.erase(imu);
  release();
  return until;
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
