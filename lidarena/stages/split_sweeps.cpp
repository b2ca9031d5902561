// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/split_sweeps.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "lidarena/base/error.hpp"

namespace lidarena::stages {
namespace {

/// The parts of a sweep that have points.
std::vector<Scan> split(const Scan& sweep, int parts) {
  const auto [first, last] = std::ranges::minmax(sweep.points, {}, &Point::dt_ns);
  const std::int64_t begin = first.dt_ns;
  const std::int64_t span = last.dt_ns - begin + 1;
  std::vector<Scan> scans(static_cast<std::size_t>(parts));
  for (const Point& point : sweep.points)
    scans[static_cast<std::size_t>((point.dt_ns - begin) * parts / span)].points.push_back(point);
  std::erase_if(scans, [](const Scan& scan) { return scan.points.empty(); });
  for (Scan& scan : scans) {
    const std::int32_t start = std::ranges::min(scan.points, {}, &Point::dt_ns).dt_ns;
    scan.stamp = sweep.stamp + Time{start};
    scan.origins = sweep.origins;
    for (Point& point : scan.points) point.dt_ns -= start;
  }
  return scans;
}

bool has_times(const Scan& sweep) {
  return sweep.timed && std::ranges::any_of(sweep.points, [&](const Point& point) {
           return point.dt_ns != sweep.points.front().dt_ns;
         });
}

}  // namespace

SplitSweeps::SplitSweeps(std::unique_ptr<EventSource> source, std::string lidar_id, int parts)
    : source_(std::move(source)), lidar_id_(std::move(lidar_id)), parts_(parts) {}

std::optional<Event> SplitSweeps::next() {
  while (ready_.empty()) {
    std::optional<Event> event = source_->next();
    if (!event) {
      ready_.swap(held_);
      break;
    }
    if (event->sensor_id == lidar_id_ && std::holds_alternative<Scan>(event->data)) {
      hand_over(std::move(*event));
    } else {
      held_.push_back(std::move(*event));
    }
  }
  if (ready_.empty()) return std::nullopt;
  Event event = std::move(ready_.front());
  ready_.pop_front();
  return event;
}

void SplitSweeps::hand_over(Event sweep) {
  const Scan& scan = std::get<Scan>(sweep.data);
  if (scan.points.size() > 1 && !has_times(scan))
    throw InputError("--parts", "the points of " + lidar_id_ + " have no times of their own",
                     "leave --parts out");
  if (scan.points.empty()) {
    std::ranges::move(std::exchange(held_, {}), std::back_inserter(ready_));
    ready_.push_back(std::move(sweep));
    return;
  }
  for (Scan& part : split(scan, parts_)) {
    hand_over_imu_until(end_of(part));
    ready_.push_back({lidar_id_, std::move(part)});
  }
}

/// Up to the first sample that is not before `end`.
void SplitSweeps::hand_over_imu_until(Time end) {
  while (!held_.empty() && last_imu_ < end) {
    if (const auto* sample = std::get_if<ImuSample>(&held_.front().data)) last_imu_ = sample->stamp;
    ready_.push_back(std::move(held_.front()));
    held_.pop_front();
  }
}

}  // namespace lidarena::stages
