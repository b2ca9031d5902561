// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/messages/point_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/firing_order.hpp"

namespace lidarena::dataset::ros {
namespace {

struct Unit {
  std::int64_t ns;
  const char* name;
};
constexpr std::array kUnits{Unit{1'000'000'000, "seconds"}, Unit{1'000'000, "milliseconds"},
                            Unit{1'000, "microseconds"}, Unit{1, "nanoseconds"}};

/// Shares of the period that the points of a sweep may fill. Units differ by 1000, so that at most
/// one of them is in this range.
constexpr double kMinShare = 0.05;
constexpr double kMaxShare = 1.3;
/// Below it the sweep is short enough to mention: a wrong rate, or a narrow field of view.
constexpr double kFullShare = 0.6;
/// A stamp may be up to this far from the times of its points: a sweep and its transport.
constexpr double kNearNs = 1e9;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// What the sweeps have in common.
struct Summary {
  double span = 0.0;       ///< median of high - low of those that have any, in the field's unit
  double low = 0.0;        ///< median
  double high = 0.0;       ///< median
  double period_ns = 0.0;  ///< median between stamps; 0: unknown
  bool advances = false;   ///< the values grow from sweep to sweep, as the stamps do
};

Summary summary_of(std::span<const SweepTimes> sweeps) {
  std::vector<double> spans, lows, highs, periods, steps;
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    const SweepTimes& sweep = sweeps[i];
    if (sweep.high > sweep.low) spans.push_back(sweep.high - sweep.low);
    lows.push_back(sweep.low);
    highs.push_back(sweep.high);
    if (i == 0) continue;
    const Time period = sweep.stamp - sweeps[i - 1].stamp;
    if (period > Time{0}) periods.push_back(static_cast<double>(period.count()));
    steps.push_back(sweep.low - sweeps[i - 1].low);
  }
  Summary summary{0.0, median(lows), median(highs), periods.empty() ? 0.0 : median(periods), false};
  if (!spans.empty()) summary.span = median(spans);
  summary.advances = !steps.empty() && median(steps) > 0.5 * summary.span && summary.span > 0.0;
  return summary;
}

/// The unit in which the points fill the period; the usual one of the field's type if it does.
std::optional<Unit> unit_by_period(const Summary& summary) {
  for (const Unit& unit : kUnits) {
    const double share = summary.span * static_cast<double>(unit.ns) / summary.period_ns;
    if (share >= kMinShare && share <= kMaxShare) return unit;
  }
  return std::nullopt;
}

const Unit& usual_unit(const SweepTimes& sweep) {
  return sweep.is_float ? kUnits.front() : kUnits.back();
}

/// Times that count from 0 to 1 over a sweep.
bool is_normalized(const SweepTimes& sweep, const Summary& summary) {
  return sweep.is_float && summary.span > 0.9 && summary.span <= 1.0 &&
         std::abs(summary.low) < 0.1 && summary.high <= 1.0;
}

std::string share_text(const Summary& summary, double unit_ns) {
  return fmt::format("the points of a sweep span {:.4g} s, sweeps come every {:.4g} s",
                     summary.span * unit_ns * 1e-9, summary.period_ns * 1e-9);
}

/// Sets the origin of the times, whose unit is known, and says where it is another clock.
void set_origin(const Summary& summary, std::span<const SweepTimes> sweeps, const std::string& what,
                PointTimesVerdict& verdict) {
  const auto unit_ns = static_cast<double>(verdict.times.unit_ns);
  if (!summary.advances && std::max(std::abs(summary.low), std::abs(summary.high)) * unit_ns <
                               kNearNs + summary.period_ns) {
    return;  // relative to the stamp
  }
  std::vector<double> offsets;
  for (const SweepTimes& sweep : sweeps) {
    offsets.push_back(sweep.low * unit_ns - static_cast<double>(sweep.stamp.count()));
  }
  const double offset_ns = median(offsets);
  verdict.times.origin =
      std::abs(offset_ns) < kNearNs ? TimeOrigin::kEpoch : TimeOrigin::kFirstPoint;
  if (verdict.times.origin == TimeOrigin::kEpoch) return;
  if (!verdict.warning.empty()) verdict.warning += ". ";
  verdict.warning += fmt::format(
      "{} is on another clock than header.stamp: they differ by {:.6g} s; only the differences "
      "within a sweep are used, its first point is taken to be at header.stamp",
      what, std::abs(offset_ns) * 1e-9);
}

/// Takes the unit that fills the period, and says so where it is not the usual one (absolute times
/// have the unit that their epoch shows).
void set_unit(const Unit& unit, const Unit& usual, const Summary& summary, const std::string& what,
              PointTimesVerdict& verdict) {
  const auto unit_ns = static_cast<double>(unit.ns);
  verdict.times.unit_ns = unit.ns;
  if (unit.ns != usual.ns && !summary.advances) {
    verdict.note =
        fmt::format("{} is taken to be in {}: {}", what, unit.name, share_text(summary, unit_ns));
  }
  if (summary.span * unit_ns < kFullShare * summary.period_ns) {
    verdict.warning = fmt::format("{}, in {}: {}; is the unit right, and is every sweep recorded?",
                                  what, unit.name, share_text(summary, unit_ns));
  }
}

}  // namespace

bool is_time_name(std::string_view field) {
  std::string name(field);
  std::ranges::transform(name, name.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static constexpr std::array kNames{"t", "ts", "dt", "stamp", "toffset", "t_offset"};
  return std::ranges::find(kNames, name) != kNames.end() || name.find("time") != std::string::npos;
}

PointTimesVerdict judge_point_times(std::string_view topic, std::span<const SweepTimes> sweeps) {
  PointTimesVerdict verdict;
  const auto untimed = [&](const std::string& why) {
    verdict.times = {};
    verdict.warning = fmt::format("{}: {}; its sweeps are not de-skewed by time", topic, why);
    return verdict;
  };
  if (sweeps.empty() || sweeps.front().field.empty()) return untimed("the points carry no times");
  const SweepTimes& first = sweeps.front();
  const std::string what = fmt::format("{}: field '{}'", topic, first.field);
  const Summary summary = summary_of(sweeps);
  if (summary.span == 0.0) {
    return untimed(fmt::format("field '{}' has one value in all points of a sweep, {}", first.field,
                               summary.low));
  }
  if (summary.period_ns == 0.0) {
    verdict.times = guess_point_times(first, topic);
    return verdict;
  }
  verdict.times = {first.field, usual_unit(first).ns, TimeOrigin::kStamp,
                   Time{std::llround(summary.period_ns)}};
  if (const auto unit = unit_by_period(summary)) {
    set_unit(*unit, usual_unit(first), summary, what, verdict);
  } else if (is_normalized(first, summary)) {
    verdict.times.unit_ns = std::llround(summary.period_ns);
    verdict.note =
        fmt::format("{} runs from 0 to 1 over a sweep; it is taken to be in periods of {:.4g} s",
                    what, summary.period_ns * 1e-9);
  } else {
    const Unit& usual = usual_unit(first);
    return untimed(fmt::format(
        "field '{}' is not a time in s, ms, us or ns: in {}, {}; write it in {}", first.field,
        usual.name, share_text(summary, static_cast<double>(usual.ns)), usual.name));
  }
  set_origin(summary, sweeps, what, verdict);
  return verdict;
}

namespace {

/// Units (ns) in which `duration` can be that of a sweep; all units if all returns have the same
/// time.
std::vector<std::int64_t> units_of(double duration) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  if (duration == 0.0) return {kSecond, 1'000, 1};
  if (duration < 10.0) return {kSecond};
  if (duration >= 1e3 && duration < 1e6) return {1'000};
  if (duration >= 1e6 && duration < 10e9) return {1};
  return {};
}

}  // namespace

PointTimes guess_point_times(const SweepTimes& sweep, std::string_view place) {
  constexpr double kFarNs = 10e9;
  if (!sweep.is_float) return {sweep.field};  // ns since header.stamp
  for (const std::int64_t unit_ns : units_of(sweep.high - sweep.low)) {
    const auto ns = static_cast<double>(unit_ns);
    const bool may_be_relative = std::max(std::abs(sweep.low), std::abs(sweep.high)) * ns < kFarNs;
    const bool may_be_absolute =
        std::abs(sweep.low * ns - static_cast<double>(sweep.stamp.count())) < kFarNs;
    if (!may_be_relative && !may_be_absolute) continue;
    // Both are possible only near time 0; there the name of the field decides.
    const bool absolute = may_be_absolute && (!may_be_relative || sweep.field == "timestamp");
    return {sweep.field, unit_ns, absolute ? TimeOrigin::kEpoch : TimeOrigin::kStamp};
  }
  throw InputError(place,
                   fmt::format("field '{}' runs from {} to {} in one scan, which is not a time "
                               "near the stamp {} ns in s, us or ns",
                               sweep.field, sweep.low, sweep.high, sweep.stamp.count()),
                   "record with a driver that writes times in s, us or ns");
}

/// Whole units are converted as integers: an absolute time in ns exceeds the 53 bits of a double.
std::int64_t since_stamp(double value, const PointTimes& times, const SweepTimes& sweep) {
  if (times.origin == TimeOrigin::kFirstPoint) {
    return std::llround((value - sweep.low) * static_cast<double>(times.unit_ns));
  }
  auto whole = static_cast<std::int64_t>(value);
  if (static_cast<double>(whole) > value) --whole;
  const double rest = value - static_cast<double>(whole);
  std::int64_t ns = whole * times.unit_ns;
  if (rest > 0.0) ns += std::llround(rest * static_cast<double>(times.unit_ns));
  return times.origin == TimeOrigin::kEpoch ? ns - sweep.stamp.count() : ns;
}

bool are_plausible(const SweepTimes& sweep, const PointTimes& times, std::size_t points) {
  constexpr std::size_t kOneFiring = 256;  // at most so many points have one time
  if (sweep.low == sweep.high && points > kOneFiring) return false;
  constexpr double kFar = 1e18;  // in any unit, beyond what 64 bits hold of nanoseconds
  if (std::abs(sweep.low) * static_cast<double>(times.unit_ns) > 4.0 * kFar) return false;
  if (std::abs(sweep.high) * static_cast<double>(times.unit_ns) > 4.0 * kFar) return false;
  const auto first = static_cast<double>(since_stamp(sweep.low, times, sweep));
  const auto last = static_cast<double>(since_stamp(sweep.high, times, sweep));
  const auto period = static_cast<double>(times.period.count());
  const double longest = std::min(period > 0.0 ? 3.0 * period : 2e9,
                                  static_cast<double>(std::numeric_limits<std::int32_t>::max()));
  return last - first <= longest && std::abs(first) < 2.0 * kNearNs;
}

void set_point_times(Scan& scan, const std::vector<double>& values, const SweepTimes& sweep,
                     const PointTimes& times, std::string_view place) {
  const std::int64_t shift = std::min<std::int64_t>(since_stamp(sweep.low, times, sweep), 0);
  if (since_stamp(sweep.high, times, sweep) - shift > std::numeric_limits<std::int32_t>::max()) {
    throw InputError(place, "a scan is longer than 2.1 s", "split it into shorter scans");
  }
  scan.stamp += Time{shift};
  for (std::size_t i = 0; i < values.size(); ++i) {
    scan.points[i].dt_ns = static_cast<std::int32_t>(since_stamp(values[i], times, sweep) - shift);
  }
  sort_in_firing_order(scan.points);
}

}  // namespace lidarena::dataset::ros
