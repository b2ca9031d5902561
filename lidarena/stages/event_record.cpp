// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/event_record.hpp"

#include <algorithm>
#include <numbers>

#include "lidarena/base/angle.hpp"
#include "lidarena/base/so3.hpp"

namespace lidarena::stages {

namespace {

using dataset::RunEventKind;

constexpr Time kPause = std::chrono::milliseconds(100);

}  // namespace

void EventRecord::add_span(RunEventKind kind, Span span) {
  std::vector<Span>& spans = spans_[static_cast<std::size_t>(kind)];
  if (spans.empty() || span.begin - spans.back().end >= kPause) return spans.push_back(span);
  Span& last = spans.back();
  last.end = std::max(last.end, span.end);
  last.value = kind == RunEventKind::kFewPoints ? std::min(last.value, span.value)
                                                : std::max(last.value, span.value);
}

void EventRecord::add_instant(RunEventKind kind, Time at, double value) {
  spans_[static_cast<std::size_t>(kind)].push_back({at, at, value});
}

void EventRecord::add_turn(Time begin, Time end, double rate_rad_s) {
  const double rate = kDegreesPerRadian * rate_rad_s;
  if (rate > kFastTurnDegS) add_span(RunEventKind::kFastTurn, {begin, end, rate});
}

void EventRecord::add_counted(RunEventKind kind, const odometry::ScanCounters::Count& count,
                              Time at, std::uint64_t& known) {
  if (!count || *count <= known) return;
  add_instant(kind, at, static_cast<double>(*count - known));
  known = *count;
}

void EventRecord::add(const ImuSample& sample) {
  if (last_sample_) {
    const Time since = sample.stamp - *last_sample_;
    if (since <= Time{0}) return;  // out of order
    if (since > kImuGap) {
      add_span(RunEventKind::kImuGap, {*last_sample_, sample.stamp, to_seconds(since)});
    } else {
      add_turn(*last_sample_, sample.stamp, sample.gyro.norm());
    }
  }
  last_sample_ = sample.stamp;
}

void EventRecord::add(const Scan& scan, const odometry::ScanResult& result) {
  const odometry::ScanCounters& counters = result.counters;
  const Time end = end_of(scan);
  const auto add = [&](RunEventKind kind, std::uint64_t value) {
    add_span(kind, {scan.stamp, end, static_cast<double>(value)});
  };
  const std::uint64_t directions = counters.degenerate_directions.value_or(0);
  if (result.status == odometry::ScanStatus::kTooFewPoints)
    add(RunEventKind::kFewPoints, counters.points.value_or(scan.points.size()));
  if (result.status == odometry::ScanStatus::kDegenerate || directions > 0)
    add(RunEventKind::kDegenerate, std::max<std::uint64_t>(directions, 1));
  if (const std::uint64_t saturated = counters.imu_saturated.value_or(0); saturated > 0)
    add(RunEventKind::kImuSaturated, saturated);
  add_counted(RunEventKind::kLoop, counters.loops, end, loops_);
  add_counted(RunEventKind::kImuRestart, counters.imu_restarts, end, restarts_);

  const StampedPose& estimate = result.estimate;
  const bool is_pose = estimate.world_from_body.matrix().allFinite();
  if (result.status == odometry::ScanStatus::kDiverged || !is_pose)
    add_instant(RunEventKind::kDiverged, end, static_cast<double>(scans_));
  ++scans_;
  if (last_sample_ || !is_pose) return;
  if (last_estimate_ && estimate.stamp > last_estimate_->stamp) {
    const double angle = so3::angle(last_estimate_->world_from_body.linear().transpose() *
                                    estimate.world_from_body.linear());
    add_turn(last_estimate_->stamp, estimate.stamp,
             angle / to_seconds(estimate.stamp - last_estimate_->stamp));
  }
  last_estimate_ = estimate;
}

std::vector<dataset::RunEvent> EventRecord::events(Time first_scan) const {
  std::vector<dataset::RunEvent> events;
  for (const dataset::RunEventInfo& info : dataset::kRunEvents) {
    for (const Span& span : spans_[static_cast<std::size_t>(info.kind)])
      events.push_back({to_seconds(span.begin - first_scan), to_seconds(span.end - span.begin),
                        info.kind, span.value});
  }
  std::ranges::stable_sort(events, {}, &dataset::RunEvent::t_sensor_s);
  return events;
}

}  // namespace lidarena::stages
