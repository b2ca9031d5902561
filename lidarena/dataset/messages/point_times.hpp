// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/base/scan.hpp"

/// The times of the points of a cloud: their field, unit and origin. Drivers agree on none of
/// these, and a message states only the name and the type of the field.
namespace lidarena::dataset::ros {

/// What a time of 0 is.
enum class TimeOrigin {
  kStamp,       ///< header.stamp
  kEpoch,       ///< the epoch of header.stamp
  kFirstPoint,  ///< unknown (another clock): the first point is taken to be at header.stamp
};

/// How the times of a topic's points are read.
struct PointTimes {
  std::string field;         ///< empty: none is read, the sweeps are untimed
  std::int64_t unit_ns = 1;  ///< nanoseconds per unit
  TimeOrigin origin = TimeOrigin::kStamp;
  Time period{0};  ///< between sweeps; 0: unknown
  bool operator==(const PointTimes&) const = default;
};

/// The values of the time field in one sweep. Counters of 32 bits that wrap within the sweep have
/// negative values before the wrap.
struct SweepTimes {
  std::string field;      ///< empty: the cloud has no such field
  bool is_float = false;  ///< type of the field
  Time stamp{0};          ///< header.stamp
  double low = 0.0;
  double high = 0.0;
};

/// How to read the times, and what to say about them; empty where there is nothing to say.
struct PointTimesVerdict {
  PointTimes times;
  std::string note;
  std::string warning;
};

/// Whether a field of this name may hold the times of points.
bool is_time_name(std::string_view field);

/// Judges the time field of a topic by its first sweeps: their points fill the period between the
/// sweeps. Where no unit makes them do so, the times are not read and a warning has both figures.
PointTimesVerdict judge_point_times(std::string_view topic, std::span<const SweepTimes> sweeps);

/// The same for a single sweep, whose period is not known: a sweep takes between 1 ms and 10 s.
/// Throws InputError (place `place`) when the times are in no unit near the stamp.
PointTimes guess_point_times(const SweepTimes& sweep, std::string_view place);

/// Nanoseconds from header.stamp to a point with the time `value`.
std::int64_t since_stamp(double value, const PointTimes& times, const SweepTimes& sweep);

/// Whether the times of this sweep can be those of a topic that is read by `times`: not all equal,
/// near the stamp, and no longer than three periods.
bool are_plausible(const SweepTimes& sweep, const PointTimes& times, std::size_t points);

/// Sets dt_ns by the `values` of the time field, and the stamp to that of the first point where
/// points are earlier; sorts the points in firing order. Throws InputError (place `place`) when the
/// sweep is longer than 2.1 s.
void set_point_times(Scan& scan, const std::vector<double>& values, const SweepTimes& sweep,
                     const PointTimes& times, std::string_view place);

}  // namespace lidarena::dataset::ros
