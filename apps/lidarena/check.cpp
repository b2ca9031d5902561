// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>

#include "apps/lidarena/console.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/base/config_json.hpp"
#include "lidarena/report/web_page.hpp"
#include "lidarena/stages/check_recording.hpp"

namespace lidarena {
namespace {

using evaluation::Finding;
using evaluation::Severity;

struct CheckOptions {
  stages::CheckRequest request;
  std::string recording;
  std::string out;  ///< page; empty: none
};

void print_findings(const std::vector<Finding>& found) {
  for (const Finding& finding : found) {
    fmt::print("{}: {}\n", value_to_json(finding.severity).get<std::string>(), finding.text);
    if (finding.to_s > 0.0)
      fmt::print("    when: {:.2f} to {:.2f} s\n", finding.from_s, finding.to_s);
    if (!finding.remedy.empty()) fmt::print("    remedy: {}\n", finding.remedy);
    for (const auto& [program, keys] : finding.settings) fmt::print("    {}: {}\n", program, keys);
  }
}

int check_verb(const Common& common, const CheckOptions& o) {
  stages::CheckRequest request = o.request;
  request.recording = o.recording;
  Console console(common.quiet);
  const stages::CheckPage report =
      stages::check_recording(request, Parallel(common.threads), console);
  const std::vector<Finding>& found = report.findings;
  const auto faults = std::ranges::count(found, Severity::kFault, &Finding::severity);
  const auto warnings = std::ranges::count(found, Severity::kWarning, &Finding::severity);
  if (common.json) {
    print_json(to_json(static_cast<const stages::CheckReport&>(report)));
  } else {
    print_findings(found);
    fmt::print("{} faults, {} warnings\n", faults, warnings);
  }
  if (!o.out.empty()) {
    report::write_page(o.out, {"Check of " + report.recording, "check", to_json(report), {}});
    console.info("page: " + o.out);
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
  verb->add_option("--out", o->out, "Page to write, with plots: FILE.html");
  verb->add_option("--sensor", o->request.read.sensor, "Id or topic of the LiDAR to check");
  verb->add_option("--imu-topic", o->request.read.imu_topic, "Topic of the IMU to check");
  verb->add_option("--layout", o->request.read.layout, "Fields of a point in raw binary sweeps")
      ->check(CLI::IsMember({"xyz", "xyzi", "xyzt", "xyztr"}));
  verb->add_option("--rate", o->request.read.rate_hz,
                   "Sweeps per second, for a folder without times")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb->add_flag("!--no-motion", o->request.motion,
                 "Leave out what needs a registration of the sweeps: clocks, axes, degenerate "
                 "stretches");
  set_verb(
      *verb, common, [&common, o] { return check_verb(common, *o); }, exit_code);
}

}  // namespace lidarena
