// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/merge_lidars.hpp"

#include <algorithm>
#include <utility>

#include "lidarena/base/error.hpp"

namespace lidarena::stages {
namespace {

constexpr std::size_t kPatience = 3;  // scans that are held while another LiDAR is silent

void check_times(const std::string& id, const Scan& scan) {
  if (scan.timed || scan.points.empty()) return;
  throw InputError("--also", "the points of " + id + " have no times of their own",
                   "leave --also out");
}

}  // namespace

MergeLidars::MergeLidars(std::unique_ptr<EventSource> source, const LidarInfo& lidar,
                         const std::vector<LidarInfo>& others)
    : source_(std::move(source)),
      lidar_id_(lidar.id),
      period_(from_seconds(1.0 / lidar.rate_hz)),
      origins_{Eigen::Vector3f::Zero()} {
  for (const LidarInfo& other : others) {
    const Pose lidar_from_other = lidar.body_from_lidar.inverse() * other.body_from_lidar;
    origins_.emplace_back(lidar_from_other.translation().cast<float>());
    others_.push_back({.id = other.id, .lidar_from_other = lidar_from_other});
  }
}

std::optional<Event> MergeLidars::next() {
  while (held_.empty() ||
         (is_scan(held_.front()) && !ended_ && !is_complete(std::get<Scan>(held_.front().data)))) {
    std::optional<Event> event = source_->next();
    ended_ = !event;
    if (event) take(std::move(*event));
    if (ended_ && held_.empty()) return std::nullopt;
  }
  Event event = std::move(held_.front());
  held_.pop_front();
  if (is_scan(event)) {
    --held_scans_;
    add_points(std::get<Scan>(event.data));
  }
  return event;
}

bool MergeLidars::is_scan(const Event& event) const {
  return event.sensor_id == lidar_id_ && std::holds_alternative<Scan>(event.data);
}

bool MergeLidars::is_complete(const Scan& scan) const {
  const Time end = end_of(scan);
  return held_scans_ >= kPatience || std::ranges::all_of(others_, [&](const Other& other) {
           return other.measured_until >= end;
         });
}

void MergeLidars::take(Event event) {
  const auto* scan = std::get_if<Scan>(&event.data);
  const auto other = std::ranges::find(others_, event.sensor_id, &Other::id);
  if (scan == nullptr || (other == others_.end() && !is_scan(event))) {
    held_.push_back(std::move(event));
    return;
  }
  check_times(event.sensor_id, *scan);
  if (other == others_.end()) {
    ++held_scans_;
    held_.push_back(std::move(event));
    return;
  }
  other->measured_until = end_of(*scan);
  for (Point point : scan->points) {
    const Time stamp = time_of(*scan, point);
    point.position = (other->lidar_from_other * point.position.cast<double>()).cast<float>();
    point.lidar = static_cast<std::uint8_t>(1 + (other - others_.begin()));
    other->points.push_back({stamp, point});
  }
}

void MergeLidars::add_points(Scan& scan) {
  const Time end = end_of(scan);
  std::vector<Waiting> all;
  for (const Point& point : scan.points) all.push_back({time_of(scan, point), point});
  for (Other& other : others_) {
    const auto later = std::ranges::stable_partition(
        other.points, [&](const Waiting& waiting) { return waiting.stamp <= end; });
    // What is older than a scan belongs to scans that are missing.
    std::copy_if(other.points.begin(), later.begin(), std::back_inserter(all),
                 [&](const Waiting& waiting) { return waiting.stamp > scan.stamp - period_; });
    other.points.erase(other.points.begin(), later.begin());
  }
  std::ranges::stable_sort(all, {}, &Waiting::stamp);
  if (!all.empty()) scan.stamp = std::min(scan.stamp, all.front().stamp);
  scan.points.clear();
  for (Waiting& waiting : all) {
    waiting.point.dt_ns = static_cast<std::int32_t>((waiting.stamp - scan.stamp).count());
    scan.points.push_back(waiting.point);
  }
  scan.origins = origins_;
}

}  // namespace lidarena::stages
