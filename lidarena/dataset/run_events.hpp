// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <vector>

namespace lidarena::dataset {

/// What can happen during a run that explains its error.
enum class RunEventKind {
  kFastTurn,
  kFewPoints,
  kDegenerate,
  kDiverged,
  kLoop,
  kImuGap,
  kImuSaturated,
  kImuRestart,
};

struct RunEventInfo {
  RunEventKind kind;
  const char* name;   ///< in events.csv
  const char* label;  ///< for readers
  const char* value;  ///< what RunEvent::value is, with its unit
};

/// Of each kind, in the order of RunEventKind.
constexpr std::array kRunEvents{
    RunEventInfo{RunEventKind::kFastTurn, "fast_turn", "fast turn", "peak rate, deg/s"},
    RunEventInfo{RunEventKind::kFewPoints, "few_points", "few points", "points of the scan, least"},
    RunEventInfo{RunEventKind::kDegenerate, "degenerate", "degenerate", "directions, most"},
    RunEventInfo{RunEventKind::kDiverged, "diverged", "diverged", "scan, counted from 0"},
    RunEventInfo{RunEventKind::kLoop, "loop", "loop closed", "loops accepted"},
    RunEventInfo{RunEventKind::kImuGap, "imu_gap", "gap of the IMU", "longest, s"},
    RunEventInfo{RunEventKind::kImuSaturated, "imu_saturated", "IMU at its limit",
                 "intervals of a scan, most"},
    RunEventInfo{RunEventKind::kImuRestart, "imu_restart", "inertial estimate restarted",
                 "restarts"},
};
constexpr const RunEventInfo& info_of(RunEventKind kind) {
  return kRunEvents.at(static_cast<std::size_t>(kind));
}

struct RunEvent {
  double t_sensor_s = 0.0;  ///< its begin, since the first scan's stamp, as in resources.csv
  double duration_s = 0.0;  ///< 0: an instant
  RunEventKind kind = RunEventKind::kFastTurn;
  double value = 0.0;  ///< see RunEventInfo::value
};

/// Writes an events.csv.
void write_events(const std::filesystem::path& file, const std::vector<RunEvent>& events);
/// Reads it back; throws InputError naming file and line.
std::vector<RunEvent> read_events(const std::filesystem::path& file);

}  // namespace lidarena::dataset
