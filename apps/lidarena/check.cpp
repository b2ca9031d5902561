// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>

#include "apps/lidarena/console.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/dataset/whole_part.hpp"
#include "lidarena/evaluation/diagnosis/recording_check.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/stages/recorder.hpp"
#include "lidarena/stages/simulate_dataset.hpp"

namespace lidarena {
namespace {

using evaluation::Finding;
using evaluation::Severity;

constexpr const char* kOdometry = "arena_lo";  // needs no IMU: what it says is the LiDAR's alone

struct CheckOptions {
  std::string recording;
  dataset::ReadOptions read{};
  bool motion = true;
};

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

/// Runs an odometry on the recording, and lists what was found on the way.
std::vector<Finding> findings_of(const CheckOptions& o, const Parallel& parallel, LogSink& log) {
  dataset::Dataset dataset = stages::open_any_dataset(o.recording, o.read, parallel);
  dataset::read_whole_part(dataset);
  const LidarInfo* lidar = dataset.rig.find_lidar("");
  if (lidar == nullptr) {
    throw InputError(o.recording, "has several LiDARs, or none", "choose one with --sensor");
  }
  const ImuInfo* imu = dataset.rig.imu_beside(*lidar);
  evaluation::RecordingCheck check;
  Watched events(*dataset.events, lidar->id, imu == nullptr ? "" : imu->id, check);
  std::vector<Finding> found;
  if (o.motion) {
    const auto made = odometry::make_odometry({kOdometry}, dataset.rig, lidar->id, parallel);
    odometry::RunOptions options;
    options.lidar_id = lidar->id;
    options.scan_count = dataset.scan_count;
    const stages::RunResult run = stages::record_run(*made.odometry, events, options, log);
    while (events.next()) {  // after a divergence
    }
    if (run.files.events) add_stretches(*run.files.events, found);
    const bool is_comparable = imu != nullptr && !run.summary.diverged;
    const auto alignment = !is_comparable
                               ? std::nullopt
                               : evaluation::align_imu(run.files.trajectory, check.samples());
    if (alignment) {
      for (Finding& finding : evaluation::check_alignment(*alignment, *lidar, *imu))
        found.push_back(std::move(finding));
    } else if (is_comparable) {
      found.push_back({Severity::kNote, "imu_alignment",
                       "the body turns too little, or for too short a time, to compare the IMU's "
                       "clock and axes with the LiDAR's",
                       0.0, "", 0.0, 0.0, "record 20 s with turns about two axes"});
    }
  } else {
    while (events.next()) {
    }
  }
  for (Finding& finding : check.findings()) found.push_back(std::move(finding));
  add_readers_words(dataset, found);
  std::ranges::stable_sort(found, std::ranges::greater{}, &Finding::severity);
  return found;
}

Json findings_json(const std::vector<Finding>& found) {
  Json list = Json::array();
  for (const Finding& finding : found) {
    list.push_back({{"severity", evaluation::to_string(finding.severity)},
                    {"key", finding.key},
                    {"text", finding.text},
                    {"value", finding.value},
                    {"unit", finding.unit},
                    {"from_s", finding.from_s},
                    {"to_s", finding.to_s},
                    {"remedy", finding.remedy},
                    {"settings", finding.settings}});
  }
  return {{"findings", list}};
}

void print_findings(const std::vector<Finding>& found) {
  for (const Finding& finding : found) {
    fmt::print("{}: {}\n", evaluation::to_string(finding.severity), finding.text);
    if (finding.to_s > 0.0)
      fmt::print("    when: {:.2f} to {:.2f} s\n", finding.from_s, finding.to_s);
    if (!finding.remedy.empty()) fmt::print("    remedy: {}\n", finding.remedy);
    for (const auto& [program, keys] : finding.settings) fmt::print("    {}: {}\n", program, keys);
  }
}

int check_verb(const Common& common, const CheckOptions& o) {
  Console console(common.quiet);
  const std::vector<Finding> found = findings_of(o, Parallel(common.threads), console);
  const auto faults = std::ranges::count(found, Severity::kFault, &Finding::severity);
  const auto warnings = std::ranges::count(found, Severity::kWarning, &Finding::severity);
  if (common.json) {
    print_json(findings_json(found));
  } else {
    print_findings(found);
    fmt::print("{} faults, {} warnings\n", faults, warnings);
  }
  return faults > 0 ? kWorkFailed : kDone;
}

}  // namespace

void add_check(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand(
      "check", "Say what in a recording would spoil a SLAM, and the remedy; needs no truth");
  auto o = std::make_shared<CheckOptions>();
  verb->add_option("recording", o->recording, "Dataset folder, recording or folder of sweeps")
      ->required();
  verb->add_option("--sensor", o->read.sensor, "Id or topic of the LiDAR to check");
  verb->add_option("--imu-topic", o->read.imu_topic, "Topic of the IMU to check");
  verb->add_option("--layout", o->read.layout, "Fields of a point in raw binary sweeps")
      ->check(CLI::IsMember({"xyz", "xyzi", "xyzt", "xyztr"}));
  verb->add_option("--rate", o->read.rate_hz, "Sweeps per second, for a folder without times")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->add_flag("!--no-motion", o->motion,
                 "Leave out what needs a registration of the sweeps: clocks, axes, degenerate "
                 "stretches");
  set_verb(
      *verb, common, [&common, o] { return check_verb(common, *o); }, exit_code);
}

}  // namespace lidarena
