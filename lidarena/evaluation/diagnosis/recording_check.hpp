// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/rig.hpp"
#include "lidarena/base/scan.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/evaluation/diagnosis/imu_alignment.hpp"

/// What in a recording would spoil a SLAM, found without a ground truth.
namespace lidarena::evaluation {

enum class Severity {
  kNote,     ///< worth knowing
  kWarning,  ///< costs accuracy
  kFault,    ///< spoils a run
};
constexpr auto enum_names(Severity) {
  return std::to_array<std::pair<std::string_view, Severity>>(
      {{"note", Severity::kNote}, {"warning", Severity::kWarning}, {"fault", Severity::kFault}});
}

struct Finding {
  static constexpr const char* kTitle = "Finding";
  Severity severity = Severity::kNote;
  std::string key, text;
  double value = 0.0;
  std::string unit;
  double from_s = 0.0, to_s = 0.0;
  std::string remedy;
  std::map<std::string, std::string> settings{};

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("severity", self.severity, "", "");
    v("key", self.key, "", "kind of the finding, such as imu_saturated");
    v("text", self.text, "", "what was found, with its figures");
    v("value", self.value, "", "the figure");
    v("unit", self.unit, "", "of the figure");
    v("from_s", self.from_s, "s", "since the first measurement");
    v("to_s", self.to_s, "s", "0, as from_s: all of the recording");
    v("remedy", self.remedy, "", "");
    v("settings", self.settings, "", "the remedy as keys of programs");
  }
};

/// Looks at the measurements one by one and keeps what the findings need.
class RecordingCheck {
 public:
  void add(const Scan& scan);
  void add(const ImuSample& sample);

  const std::vector<ImuSample>& samples() const { return samples_; }
  const std::vector<Time>& sweeps() const { return scans_; }          ///< their stamps
  const std::vector<std::size_t>& points() const { return points_; }  ///< of each sweep
  /// Since the first measurement, s.
  double since_start(Time time) const;
  double seconds() const;  ///< from the first measurement to the last
  /// Rates, gaps and jitter of stamps; the IMU's range, vibration, bias and the motion at the
  /// start; fast turns; sweeps of few points or without times.
  std::vector<Finding> findings() const;

 private:
  void check_scans(std::vector<Finding>& found) const;
  void check_gaps(const std::vector<Time>& stamps, const char* what, double longest_s,
                  std::vector<Finding>& found) const;
  void check_coverage(std::vector<Finding>& found) const;
  void check_gravity(std::vector<Finding>& found) const;
  void check_range(std::vector<Finding>& found) const;
  void check_vibration(std::vector<Finding>& found) const;
  void check_spectrum(std::vector<Finding>& found) const;
  void check_start(std::vector<Finding>& found) const;
  void check_turns(std::vector<Finding>& found) const;

  std::vector<Time> scans_;
  std::vector<std::size_t> points_;
  std::size_t untimed_ = 0;
  std::vector<ImuSample> samples_;
  std::vector<Time> sample_stamps_;
};

/// Findings of the IMU's clock and axes against the LiDAR's, as motion shows them, beside what the
/// rig states.
std::vector<Finding> check_alignment(const ImuAlignment& alignment, const LidarInfo& lidar,
                                     const ImuInfo& imu);

}  // namespace lidarena::evaluation
