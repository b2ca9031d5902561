// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/diagnosis/recording_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lidarena/base/so3.hpp"
#include "lidarena/evaluation/diagnosis/spectrum.hpp"

namespace lidarena::evaluation {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

Time median_step(const std::vector<Time>& stamps) {
  if (stamps.size() < 2) return Time{0};
  std::vector<Time> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i) steps.push_back(stamps[i] - stamps[i - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

/// Mean magnitude and standard deviation of vectors.
struct Spread {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double deviation = 0.0;
};

template <class Member>
Spread spread_of(std::span<const ImuSample> samples, Member member) {
  Spread spread;
  for (const ImuSample& sample : samples) spread.mean += sample.*member;
  spread.mean /= static_cast<double>(samples.size());
  for (const ImuSample& sample : samples)
    spread.deviation += (sample.*member - spread.mean).squaredNorm();
  spread.deviation = std::sqrt(spread.deviation / static_cast<double>(samples.size()));
  return spread;
}

}  // namespace

void RecordingCheck::add(const Scan& scan) {
  scans_.push_back(scan.stamp);
  points_.push_back(scan.points.size());
  untimed_ += scan.timed ? 0 : 1;
}

void RecordingCheck::add(const ImuSample& sample) {
  samples_.push_back(sample);
  sample_stamps_.push_back(sample.stamp);
}

double RecordingCheck::since_start(Time time) const {
  Time start = Time::max();
  if (!scans_.empty()) start = scans_.front();
  if (!samples_.empty()) start = std::min(start, samples_.front().stamp);
  return to_seconds(time - start);
}

double RecordingCheck::seconds() const {
  double last = 0.0;
  if (!scans_.empty()) last = since_start(scans_.back());
  if (!samples_.empty()) last = std::max(last, since_start(samples_.back().stamp));
  return last;
}

void RecordingCheck::check_gaps(const std::vector<Time>& stamps, const char* what, double longest_s,
                                std::vector<Finding>& found) const {
  const Time step = median_step(stamps);
  std::size_t gaps = 0, longest = 0;
  double jitter = 0.0;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    const Time gap = stamps[i] - stamps[i - 1];
    gaps += 2 * gap > 3 * step ? 1 : 0;
    if (longest == 0 || gap > stamps[longest] - stamps[longest - 1]) longest = i;
    jitter += std::pow(std::min(to_seconds(gap - step) / to_seconds(step), 0.5), 2);
  }
  if (longest == 0) return;
  const double gap_s = to_seconds(stamps[longest] - stamps[longest - 1]);
  if (gaps > 0 && gap_s > 3.0 * to_seconds(step)) {
    found.push_back({gap_s > longest_s ? Severity::kFault : Severity::kWarning,
                     fmt::format("{}_gap", what),
                     fmt::format("{} gaps in the {}, the longest of {:.3g} s", gaps, what, gap_s),
                     gap_s, "s", since_start(stamps[longest - 1]), since_start(stamps[longest]),
                     "record to a faster disk or drop other topics; cut the recording there"});
  }
  const double share = std::sqrt(jitter / static_cast<double>(stamps.size()));
  constexpr double kJitter = 0.2;  // of the period
  if (share > kJitter) {
    found.push_back(
        {Severity::kWarning, fmt::format("{}_jitter", what),
         fmt::format("stamps of the {} jitter by {:.0f} % of their period", what, 100.0 * share),
         share, "", 0.0, 0.0,
         "stamp by the sensor's clock (PTP, PPS), not when a message arrives"});
  }
}

void RecordingCheck::check_scans(std::vector<Finding>& found) const {
  constexpr std::size_t kFew = 500;  // points
  const auto few = std::ranges::count_if(points_, [](std::size_t n) { return n < kFew; });
  if (10 * few > static_cast<std::ptrdiff_t>(points_.size())) {
    found.push_back(
        {Severity::kWarning, "few_points",
         fmt::format("{} of {} sweeps have fewer than {} points", few, points_.size(), kFew),
         static_cast<double>(few), "sweeps", 0.0, 0.0,
         "join sweeps of high rates; check the LiDAR's range limits and its window"});
  }
  if (untimed_ > 0) {
    found.push_back({Severity::kWarning,
                     "no_point_times",
                     fmt::format("{} of {} sweeps have no times of their points and are not "
                                 "de-skewed",
                                 untimed_, scans_.size()),
                     static_cast<double>(untimed_),
                     "sweeps",
                     0.0,
                     0.0,
                     "let the driver publish the points with times, unless the motion within a "
                     "sweep was removed before",
                     {{"KISS-ICP", "data.deskew: false"},
                      {"FAST-LIO2", "preprocess/lidar_type and preprocess/timestamp_unit"}}});
  }
}

/// The IMU must have samples from the first sweep to the last.
void RecordingCheck::check_coverage(std::vector<Finding>& found) const {
  constexpr Time kMissing = std::chrono::seconds(1);
  if (scans_.empty()) return;
  const Time begin = samples_.front().stamp, end = samples_.back().stamp;
  if (begin > scans_.front() + kMissing) {
    found.push_back(
        {Severity::kFault, "imu_begins_late",
         fmt::format("the IMU begins {:.3g} s after the LiDAR", to_seconds(begin - scans_.front())),
         to_seconds(begin - scans_.front()), "s", 0.0, since_start(begin),
         "begin the recording there"});
  }
  if (end + kMissing < scans_.back()) {
    found.push_back(
        {Severity::kFault, "imu_ends_early",
         fmt::format("the IMU ends {:.3g} s before the LiDAR", to_seconds(scans_.back() - end)),
         to_seconds(scans_.back() - end), "s", since_start(end), since_start(scans_.back()),
         "cut the recording there"});
  }
}

void RecordingCheck::check_gravity(std::vector<Finding>& found) const {
  constexpr double kMin = 6.5, kMax = 14.7;  // m/s^2, two thirds and one and a half of gravity
  std::vector<double> sizes;
  for (const ImuSample& sample : samples_) sizes.push_back(sample.accel.norm());
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  if (*middle > kMin && *middle < kMax) return;
  found.push_back(
      {Severity::kFault,
       "no_gravity",
       fmt::format("the accelerations have a median of {:.3g} m/s^2, not of gravity", *middle),
       *middle,
       "m/s^2",
       0.0,
       0.0,
       "record the raw accelerations, +9.8 m/s^2 upwards at rest",
       {{"LIO-SAM", "imuGravity is that of the raw accelerations"}}});
}

void RecordingCheck::check_range(std::vector<Finding>& found) const {
  struct Quantity {
    Eigen::Vector3d ImuSample::*member;
    const char* name;
    double smallest;  ///< range of an IMU, in the unit
    const char* unit;
  };
  for (const Quantity& q : {Quantity{&ImuSample::accel, "acceleration", 15.0, "m/s^2"},
                            Quantity{&ImuSample::gyro, "angular rate", 3.0, "rad/s"}}) {
    for (int axis = 0; axis < 3; ++axis) {
      double most = 0.0;
      for (const ImuSample& s : samples_) most = std::max(most, std::abs((s.*q.member)[axis]));
      if (most < q.smallest) continue;
      // Values pile up at a limit; a peak has more values some steps below its highest than at it.
      constexpr std::size_t kOften = 3;
      constexpr double kEqual = 1e-6, kBelow = 0.01, kFarBelow = 0.1;  // of the highest
      constexpr double kSteps = 3.0;                                   // of the sensor's resolution
      std::vector<Time> at_limit;
      double next = 0.0;  // the highest value below the limit
      for (const ImuSample& s : samples_) {
        const double size = std::abs((s.*q.member)[axis]);
        if (size > (1.0 - kEqual) * most) {
          at_limit.push_back(s.stamp);
        } else {
          next = std::max(next, size);
        }
      }
      const double low = most - std::clamp(kSteps * (most - next), kBelow * most, kFarBelow * most);
      const auto near = std::ranges::count_if(
          samples_, [&](const ImuSample& s) { return std::abs((s.*q.member)[axis]) > low; });
      const std::size_t below = static_cast<std::size_t>(near) - at_limit.size();
      if (at_limit.size() < kOften || at_limit.size() < below) continue;
      found.push_back({Severity::kFault, "imu_saturated",
                       fmt::format("the {} about axis {} is at {:.4g} {} in {} samples: the end of "
                                   "the sensor's range",
                                   q.name, "xyz"[axis], most, q.unit, at_limit.size()),
                       most, q.unit, since_start(at_limit.front()), since_start(at_limit.back()),
                       "set a larger range of the IMU, or damp its mount"});
    }
  }
}

/// Differences of second order are the upper quarter of the spectrum; their share in all motion
/// around the mean of a tenth of a second says how much of it is vibration.
void RecordingCheck::check_vibration(std::vector<Finding>& found) const {
  constexpr double kStrong = 3.0;  // m/s^2 RMS
  double rough = 0.0;
  for (std::size_t i = 1; i + 1 < samples_.size(); ++i) {
    const Eigen::Vector3d bend =
        samples_[i].accel - 0.5 * (samples_[i - 1].accel + samples_[i + 1].accel);
    rough += bend.squaredNorm() / 1.5;  // of white noise: its variance
  }
  if (samples_.size() < 3) return;
  const double rms = std::sqrt(rough / static_cast<double>(samples_.size() - 2));
  if (rms < kStrong) return;
  const double rate = 1.0 / to_seconds(median_step(sample_stamps_));
  found.push_back({Severity::kWarning,
                   "vibration",
                   fmt::format("the accelerometer vibrates by {:.3g} m/s^2 RMS near half its rate "
                               "({:.0f} Hz); it may alias",
                               rms, 0.5 * rate),
                   rms,
                   "m/s^2",
                   0.0,
                   0.0,
                   "damp the mount, or let the IMU filter below half its rate",
                   {{"FAST-LIO2", fmt::format("mapping/acc_cov: {:.2g}", rms * rms / rate)},
                    {"LIO-SAM", fmt::format("imuAccNoise: {:.2g}", rms / std::sqrt(rate))}}});
}

/// Lines of the accelerometer's spectrum, and power that rises towards half the rate.
void RecordingCheck::check_spectrum(std::vector<Finding>& found) const {
  constexpr double kStrong = 1.0;  // m/s^2 RMS
  constexpr double kRise = 4.0, kTop_rms = 0.3;
  const Spectrum spectrum = spectrum_of(samples_, &ImuSample::accel);
  for (const Peak& peak : peaks_of(spectrum)) {
    found.push_back({peak.rms > kStrong ? Severity::kWarning : Severity::kNote, "vibration_line",
                     fmt::format("the accelerometer vibrates at {:.1f} Hz by {:.2g} m/s^2 RMS; a "
                                 "tone above half its rate shows at another frequency",
                                 peak.frequency_hz, peak.rms),
                     peak.frequency_hz, "Hz", 0.0, 0.0,
                     peak.rms > kStrong ? "balance the propellers, damp the mount" : ""});
  }
  if (spectrum.empty()) return;
  const double rise = rise_to_nyquist(spectrum);
  const double half_rate = spectrum.frequency_hz.back();
  double power = 0.0;  // of the highest tenth
  for (std::size_t i = spectrum.density.size() * 9 / 10; i < spectrum.density.size(); ++i)
    power += spectrum.density[i] * spectrum.frequency_hz.front();
  if (rise < kRise || std::sqrt(power) < kTop_rms) return;
  found.push_back({Severity::kWarning, "may_alias",
                   fmt::format("the accelerometer's power rises {:.0f} times towards half its rate "
                               "({:.0f} Hz): vibration may alias",
                               rise, half_rate),
                   rise, "", 0.0, 0.0,
                   "let the IMU filter below half its rate, or raise its rate"});
}

void RecordingCheck::check_start(std::vector<Finding>& found) const {
  constexpr Time kFirst = std::chrono::milliseconds(500);
  constexpr double kTurning = 0.1;  // rad/s
  constexpr double kShaking = 0.5;  // m/s^2
  constexpr double kBias = 0.02;    // rad/s, of a MEMS gyroscope that needs a calibration
  const auto end = std::ranges::find_if(samples_, [&](const ImuSample& sample) {
    return sample.stamp > samples_.front().stamp + kFirst;
  });
  const std::span first(samples_.data(), static_cast<std::size_t>(end - samples_.begin()));
  if (first.size() < 10) return;
  const Spread gyro = spread_of(first, &ImuSample::gyro);
  const Spread accel = spread_of(first, &ImuSample::accel);
  const bool moves = gyro.mean.norm() + gyro.deviation > kTurning || accel.deviation > kShaking;
  if (moves) {
    found.push_back({Severity::kWarning, "start_in_motion",
                     fmt::format("the recording begins in motion: {:.3g} rad/s, accelerations "
                                 "scatter by {:.3g} m/s^2 in the first half second",
                                 gyro.mean.norm() + gyro.deviation, accel.deviation),
                     gyro.mean.norm(), "rad/s", 0.0, 0.5,
                     "begin at rest for two seconds; methods that take gravity and biases from "
                     "the first samples begin tilted"});
  } else if (gyro.mean.norm() > kBias) {
    found.push_back({Severity::kWarning, "gyro_bias",
                     fmt::format("the gyroscope shows {:.3g} rad/s at rest", gyro.mean.norm()),
                     gyro.mean.norm(), "rad/s", 0.0, 0.5,
                     "calibrate the gyroscope; methods that initialize at rest remove it"});
  }
}

void RecordingCheck::check_turns(std::vector<Finding>& found) const {
  constexpr double kFast = std::numbers::pi;  // rad/s: 18 degrees in a sweep of 0.1 s
  const ImuSample* fastest = nullptr;
  std::size_t fast = 0;
  for (const ImuSample& sample : samples_) {
    fast += sample.gyro.norm() > kFast ? 1 : 0;
    if (fastest == nullptr || sample.gyro.norm() > fastest->gyro.norm()) fastest = &sample;
  }
  if (fast < 5) return;
  const double rate = kDegrees * fastest->gyro.norm();
  const double at = since_start(fastest->stamp);
  found.push_back({Severity::kWarning, "fast_turn",
                   fmt::format("the body turns at up to {:.0f} deg/s, at {:.1f} s", rate, at), rate,
                   "deg/s", std::max(0.0, at - 0.5), at + 0.5,
                   "turn more slowly, or use a method with an IMU"});
}

std::vector<Finding> RecordingCheck::findings() const {
  constexpr double kLongestScanGap_s = 1.0, kLongestImuGap_s = 0.1;
  std::vector<Finding> found;
  check_gaps(scans_, "lidar", kLongestScanGap_s, found);
  check_scans(found);
  if (samples_.empty()) return found;
  check_gaps(sample_stamps_, "imu", kLongestImuGap_s, found);
  constexpr double kLowRate_hz = 90.0;
  const double rate_hz = 1.0 / std::max(1e-9, to_seconds(median_step(sample_stamps_)));
  if (rate_hz < kLowRate_hz) {
    found.push_back({Severity::kWarning, "imu_rate",
                     fmt::format("the IMU has {:.3g} samples a second", rate_hz), rate_hz, "Hz",
                     0.0, 0.0, "set the IMU to 100 Hz or more"});
  }
  check_coverage(found);
  check_gravity(found);
  check_range(found);
  check_vibration(found);
  check_spectrum(found);
  check_start(found);
  check_turns(found);
  return found;
}

std::vector<Finding> check_alignment(const ImuAlignment& alignment, const LidarInfo& lidar,
                                     const ImuInfo& imu) {
  constexpr double kVeryLate_s = 0.1, kVeryTurned = 15.0 / kDegrees;
  constexpr double kMaxMisfit = 0.5;    // of the rate; beyond, the two do not see one motion
  constexpr double kSmallMisfit = 0.1;  // of the rate; below, small differences are seen, too
  const bool is_fine = alignment.misfit_rad_s < kSmallMisfit * alignment.rate_rad_s;
  const double smallest_late_s = is_fine ? 0.005 : 0.015, smallest_drift_s = is_fine ? 0.005 : 0.02;
  const double smallest_turn = (is_fine ? 1.0 : 4.0) / kDegrees;
  std::vector<Finding> found;
  if (alignment.misfit_rad_s > kMaxMisfit * alignment.rate_rad_s) {
    found.push_back({Severity::kFault, "imu_disagrees",
                     fmt::format("the gyroscope does not show the LiDAR's rotation: they differ by "
                                 "{:.3g} of {:.3g} rad/s RMS at best",
                                 alignment.misfit_rad_s, alignment.rate_rad_s),
                     alignment.misfit_rad_s, "rad/s", 0.0, 0.0,
                     "check that the IMU is on the LiDAR's body, its unit, and both clocks"});
    return found;
  }
  const double late = alignment.late_s;
  const double turned =
      so3::angle(alignment.body_from_imu.transpose() * imu.body_from_imu.linear());
  found.push_back({Severity::kNote, "imu_alignment",
                   fmt::format("as the motion shows it, the IMU's stamps are {:.1f} ms late, its "
                               "clock moves by {:.1f} ms from the first half to the second{}",
                               1e3 * late, 1e3 * alignment.drift_s,
                               alignment.axes_known
                                   ? fmt::format(", its axes are {:.2f} deg from where the "
                                                 "recording states them",
                                                 kDegrees * turned)
                                   : ", and its axes are not known, as the body turns about one"),
                   1e3 * late, "ms", 0.0, 0.0, ""});
  if (std::abs(late) > smallest_late_s) {
    found.push_back(
        {std::abs(late) > kVeryLate_s ? Severity::kFault : Severity::kWarning,
         "imu_delay",
         fmt::format("the IMU's stamps are {:.3f} s {} the LiDAR's", std::abs(late),
                     late > 0.0 ? "behind" : "ahead of"),
         late,
         "s",
         0.0,
         0.0,
         "synchronize the clocks (PTP), or shift the IMU's stamps",
         {{"FAST-LIO2", fmt::format("common/time_offset_lidar_to_imu: {:.3f}", late)},
          {"LIO-SAM",
           fmt::format("has no key: shift the stamps of imuTopic by {:.3f} s", -late)}}});
  }
  if (std::abs(alignment.drift_s) > smallest_drift_s) {
    found.push_back({Severity::kWarning, "clock_drift",
                     fmt::format("the IMU's clock drifts by {:.3f} s from the first half to the "
                                 "second",
                                 alignment.drift_s),
                     alignment.drift_s, "s", 0.0, 0.0, "synchronize the clocks (PTP)"});
  }
  if (alignment.axes_known && turned > smallest_turn) {
    const Eigen::Quaterniond q(alignment.body_from_imu);
    const Eigen::Matrix3d r =
        alignment.body_from_imu.transpose() * lidar.body_from_lidar.linear();  // imu_from_lidar
    found.push_back(
        {turned > kVeryTurned ? Severity::kFault : Severity::kWarning,
         "imu_mounting",
         fmt::format("the IMU is turned by {:.1f} deg from where the recording states it: the "
                     "motion shows body_from_imu = {:.4f}, {:.4f}, {:.4f}, {:.4f} (qx qy qz qw)",
                     kDegrees * turned, q.x(), q.y(), q.z(), q.w()),
         kDegrees * turned,
         "deg",
         0.0,
         0.0,
         "state the mounting in /tf_static or the method's file",
         {{"FAST-LIO2",
           fmt::format("mapping/extrinsic_R: [{:.4f}, {:.4f}, {:.4f}, {:.4f}, {:.4f}, {:.4f}, "
                       "{:.4f}, {:.4f}, {:.4f}]",
                       r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1),
                       r(2, 2))},
          {"LIO-SAM", "extrinsicRot and extrinsicRPY: the same nine numbers, transposed"}}});
  }
  return found;
}

}  // namespace lidarena::evaluation
