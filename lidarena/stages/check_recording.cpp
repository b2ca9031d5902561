// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/check_recording.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lidarena/base/so3.hpp"
#include "lidarena/dataset/whole_part.hpp"
#include "lidarena/evaluation/map/cloud_comparison.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/stages/recorder.hpp"
#include "lidarena/stages/simulate_dataset.hpp"

namespace lidarena::stages {
namespace {

using evaluation::Finding;
using evaluation::Severity;

constexpr const char* kOdometry = "arena_lo";  // needs no IMU: what it says is the LiDAR's alone
constexpr std::size_t kMaxRows = 2000;         // of a curve

/// Shows the events to the check on their way to the odometry.
class Watched final : public EventSource {
 public:
  Watched(EventSource& events, std::string lidar, std::string imu,
          evaluation::RecordingCheck& check)
      : events_(events), lidar_(std::move(lidar)), imu_(std::move(imu)), check_(check) {}

  std::optional<Event> next() override {
    auto event = events_.next();
    if (!event) return event;
    if (const auto* scan = std::get_if<Scan>(&event->data)) {
      if (event->sensor_id == lidar_) check_.add(*scan);
    } else if (event->sensor_id == imu_) {
      check_.add(std::get<ImuSample>(event->data));
    }
    return event;
  }

 private:
  EventSource& events_;
  std::string lidar_, imu_;
  evaluation::RecordingCheck& check_;
};

/// What was said when the recording was opened and read, as findings.
void add_readers_words(const dataset::Dataset& dataset, std::vector<Finding>& found) {
  const auto add = [&](Severity severity, const char* key, const std::string& text) {
    found.push_back({severity, key, text, 0.0, "", 0.0, 0.0, ""});
  };
  for (const std::string& note : dataset.notes)
    if (note != dataset.report->ended()) add(Severity::kNote, "reading", note);
  for (const std::string& warning : dataset.warnings) {
    const bool is_fault = warning == dataset.imu_fault;
    add(is_fault ? Severity::kFault : Severity::kWarning, is_fault ? "clocks" : "reading", warning);
  }
  for (const std::string& line : dataset.report->lines()) add(Severity::kWarning, "left_out", line);
  if (!dataset.report->ended().empty()) add(Severity::kFault, "damaged", dataset.report->ended());
}

/// Stretches in which the LiDAR alone does not determine the motion.
void add_stretches(const std::vector<dataset::RunEvent>& events, std::vector<Finding>& found) {
  constexpr double kShort_s = 0.5;
  for (const dataset::RunEvent& event : events) {
    const double end = event.t_sensor_s + event.duration_s;
    if (event.kind == dataset::RunEventKind::kDegenerate && event.duration_s >= kShort_s) {
      found.push_back({Severity::kWarning, "degenerate",
                       fmt::format("from {:.1f} to {:.1f} s the sweeps do not determine every "
                                   "direction (a corridor, a plane)",
                                   event.t_sensor_s, end),
                       event.duration_s, "s", event.t_sensor_s, end,
                       "use a method with an IMU; look at walls across the way"});
    } else if (event.kind == dataset::RunEventKind::kDiverged) {
      found.push_back(
          {Severity::kFault, "lidar_lost",
           fmt::format("at {:.1f} s registration of the sweeps alone fails", event.t_sensor_s),
           event.t_sensor_s, "s", event.t_sensor_s, end, "see the findings before it"});
    }
  }
}

/// How far the map agrees with itself.
void add_map(const dataset::Cloud& map, const Parallel& parallel, std::vector<Finding>& found) {
  constexpr double kThick_m = 0.1;
  const evaluation::MapAgreement own = evaluation::map_agreement(map.points, parallel);
  if (own.neighborhoods == 0) return;
  const bool is_thick = own.plane_thickness_m > kThick_m;
  found.push_back({is_thick ? Severity::kWarning : Severity::kNote, "map_agreement",
                   fmt::format("planes of the map of {} are {:.1f} cm thick (mean map entropy "
                               "{:.2f})",
                               kOdometry, 100.0 * own.plane_thickness_m, own.mean_map_entropy),
                   own.plane_thickness_m, "m", 0.0, 0.0,
                   is_thick ? "the map is blurred: see the findings above" : ""});
}

/// Registers the sweeps, and compares the motion with the IMU.
void check_motion(dataset::Dataset& dataset, const LidarInfo& lidar, const ImuInfo* imu,
                  Watched& events, const evaluation::RecordingCheck& check, Trajectory& trajectory,
                  std::vector<Finding>& found, const Parallel& parallel, LogSink& log) {
  const auto made = odometry::make_odometry({kOdometry}, dataset.rig, lidar.id, parallel);
  odometry::RunOptions options;
  options.lidar_id = lidar.id;
  options.scan_count = dataset.scan_count;
  const RunResult run = record_run(*made.odometry, events, options, log);
  while (events.next()) {  // after a divergence
  }
  trajectory = run.files.trajectory;
  if (run.files.events) add_stretches(*run.files.events, found);
  add_map(run.files.map, parallel, found);
  if (imu == nullptr || run.summary.diverged) return;
  const auto alignment = evaluation::align_imu(trajectory, check.samples());
  if (alignment) {
    for (Finding& finding : evaluation::check_alignment(*alignment, lidar, *imu))
      found.push_back(std::move(finding));
  } else {
    found.push_back({Severity::kNote, "imu_alignment",
                     "the body turns too little, or for too short a time, to compare the IMU's "
                     "clock and axes with the LiDAR's",
                     0.0, "", 0.0, 0.0, "record 20 s with turns about two axes"});
  }
}

void fill_curves(const evaluation::RecordingCheck& check, const Trajectory& trajectory,
                 CheckCurves& curves) {
  const std::vector<ImuSample>& samples = check.samples();
  const std::size_t stride = (samples.size() + kMaxRows - 1) / kMaxRows;
  for (std::size_t begin = 0; begin < samples.size(); begin += stride) {
    double gyro = 0.0, accel = 0.0;
    for (std::size_t i = begin; i < std::min(begin + stride, samples.size()); ++i) {
      gyro = std::max(gyro, samples[i].gyro.norm());
      accel = std::max(accel, samples[i].accel.norm());
    }
    curves.imu_t_s.push_back(check.since_start(samples[begin].stamp));
    curves.gyro_rad_s.push_back(gyro);
    curves.accel_m_s2.push_back(accel);
  }
  const std::vector<Time>& sweeps = check.sweeps();
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    curves.sweep_t_s.push_back(check.since_start(sweeps[i]));
    curves.sweep_points.push_back(static_cast<double>(check.points()[i]));
    curves.sweep_gap_s.push_back(i == 0 ? 0.0 : to_seconds(sweeps[i] - sweeps[i - 1]));
  }
  const auto poses = trajectory.poses();
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Eigen::Matrix3d turned =
        poses[i - 1].world_from_body.linear().transpose() * poses[i].world_from_body.linear();
    const Time between = poses[i].stamp - poses[i - 1].stamp;
    curves.pose_t_s.push_back(check.since_start(poses[i - 1].stamp + between / 2));
    curves.lidar_rate_rad_s.push_back(so3::angle(turned) / to_seconds(between));
  }
}

}  // namespace

CheckPage check_recording(const CheckRequest& request, const Parallel& parallel, LogSink& log) {
  dataset::Dataset dataset = open_any_dataset(request.recording, request.read, parallel);
  dataset::read_whole_part(dataset);
  const LidarInfo* lidar = dataset.rig.find_lidar("");
  if (lidar == nullptr)
    throw InputError(request.recording.string(), "has several LiDARs, or none",
                     "choose one with --sensor");
  const ImuInfo* imu = dataset.rig.imu_beside(*lidar);
  CheckPage report;
  report.recording = request.recording.string();
  report.lidar = lidar->id;
  if (imu != nullptr) report.imu = imu->id;
  report.topics = dataset.topics;
  evaluation::RecordingCheck check;
  Watched events(*dataset.events, report.lidar, report.imu, check);
  std::vector<Finding>& found = report.findings;
  Trajectory trajectory;
  if (request.motion) {
    check_motion(dataset, *lidar, imu, events, check, trajectory, found, parallel, log);
  } else {
    while (events.next()) {
    }
  }
  for (Finding& finding : check.findings()) found.push_back(std::move(finding));
  add_readers_words(dataset, found);
  std::ranges::stable_sort(found, std::ranges::greater{}, &Finding::severity);
  fill_curves(check, trajectory, report.curves);
  report.seconds = check.seconds();
  report.accel_spectrum = evaluation::spectrum_of(check.samples(), &ImuSample::accel);
  report.gyro_spectrum = evaluation::spectrum_of(check.samples(), &ImuSample::gyro);
  return report;
}

}  // namespace lidarena::stages
