// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/diagnosis/imu_alignment.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <vector>

#include "lidarena/base/so3.hpp"

namespace lidarena::evaluation {
namespace {

constexpr double kMinRate = 0.05;  // rad/s RMS
constexpr std::size_t kMinPairs = 20;
constexpr double kMaxOffset_s = 0.5;
constexpr double kGridStep_s = 0.01;
constexpr double kMinSecondAxis = 0.1;  // of the largest singular value

/// The mean angular rate of the body between two poses.
struct Interval {
  Time begin, end;
  Eigen::Vector3d rate;
};

std::vector<Interval> intervals_of(const Trajectory& trajectory) {
  std::vector<Interval> intervals;
  const auto poses = trajectory.poses();
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double seconds = to_seconds(poses[i].stamp - poses[i - 1].stamp);
    const Eigen::Matrix3d turned =
        poses[i - 1].world_from_body.linear().transpose() * poses[i].world_from_body.linear();
    intervals.push_back({poses[i - 1].stamp, poses[i].stamp, so3::log(turned) / seconds});
  }
  return intervals;
}

/// Integral of the rate over time, so that the mean over any interval is a difference.
class RateIntegral {
 public:
  explicit RateIntegral(std::span<const ImuSample> samples)
      : samples_(samples), sums_(samples.size()) {
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const double seconds = to_seconds(samples[i].stamp - samples[i - 1].stamp);
      sums_[i] = sums_[i - 1] + 0.5 * seconds * (samples[i].gyro + samples[i - 1].gyro);
    }
  }

  /// Mean rate from `begin` to `end`; empty outside the samples.
  std::optional<Eigen::Vector3d> mean(Time begin, Time end) const {
    const auto from = at(begin), to = at(end);
    if (!from || !to) return std::nullopt;
    return (*to - *from) / to_seconds(end - begin);
  }

 private:
  std::optional<Eigen::Vector3d> at(Time time) const {
    const auto next = std::ranges::upper_bound(samples_, time, {}, &ImuSample::stamp);
    if (next == samples_.begin() || next == samples_.end()) return std::nullopt;
    const auto i = static_cast<std::size_t>(next - samples_.begin());
    const double share = to_seconds(time - samples_[i - 1].stamp) /
                         to_seconds(samples_[i].stamp - samples_[i - 1].stamp);
    return (1.0 - share) * sums_[i - 1] + share * sums_[i];
  }

  std::span<const ImuSample> samples_;
  std::vector<Eigen::Vector3d> sums_;
};

struct RotationFit {
  Eigen::Matrix3d body_from_imu = Eigen::Matrix3d::Identity();
  double misfit = 0.0;  ///< RMS, rad/s
  double rate = 0.0;    ///< RMS, rad/s
  bool axes_known = false;
  std::size_t pairs = 0;
};

RotationFit fit(std::span<const Interval> intervals, const RateIntegral& gyro, double late_s) {
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> pairs;
  const Time late = from_seconds(late_s);
  Eigen::Vector3d mean_body = Eigen::Vector3d::Zero(), mean_imu = Eigen::Vector3d::Zero();
  for (const Interval& interval : intervals) {
    if (const auto rate = gyro.mean(interval.begin + late, interval.end + late)) {
      pairs.emplace_back(interval.rate, *rate);
      mean_body += interval.rate;
      mean_imu += *rate;
    }
  }
  RotationFit result;
  result.pairs = pairs.size();
  if (pairs.size() < kMinPairs) return result;
  mean_body /= static_cast<double>(pairs.size());
  mean_imu /= static_cast<double>(pairs.size());
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  for (const auto& [body, imu] : pairs)  // without means, which hold the gyroscope's bias
    products += (body - mean_body) * (imu - mean_imu).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(products, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  signs.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  result.body_from_imu = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  const Eigen::Vector3d& s = svd.singularValues();
  result.axes_known = s[1] > kMinSecondAxis * s[0];
  for (const auto& [body, imu] : pairs) {
    const Eigen::Vector3d difference = (body - mean_body) - result.body_from_imu * (imu - mean_imu);
    result.misfit += difference.squaredNorm();
    result.rate += body.squaredNorm();
  }
  result.misfit = std::sqrt(result.misfit / static_cast<double>(pairs.size()));
  result.rate = std::sqrt(result.rate / static_cast<double>(pairs.size()));
  return result;
}

/// The offset with the least misfit, refined by the parabola through its neighbors.
double best_offset(std::span<const Interval> intervals, const RateIntegral& gyro) {
  const int steps = static_cast<int>(kMaxOffset_s / kGridStep_s);
  std::vector<double> misfits;
  for (int i = -steps; i <= steps; ++i) {
    const RotationFit at = fit(intervals, gyro, i * kGridStep_s);
    misfits.push_back(at.pairs < kMinPairs ? 1e9 : at.misfit);
  }
  const auto least = std::ranges::min_element(misfits);
  const double offset = (static_cast<double>(least - misfits.begin()) - steps) * kGridStep_s;
  if (least == misfits.begin() || least + 1 == misfits.end()) return offset;
  const double before = std::pow(*(least - 1), 2), here = std::pow(*least, 2),
               after = std::pow(*(least + 1), 2);
  const double bend = before - 2.0 * here + after;
  return bend > 0.0 ? offset + 0.5 * kGridStep_s * (before - after) / bend : offset;
}

}  // namespace

std::optional<ImuAlignment> align_imu(const Trajectory& trajectory,
                                      std::span<const ImuSample> samples) {
  const std::vector<Interval> intervals = intervals_of(trajectory);
  if (intervals.size() < kMinPairs || samples.size() < 2) return std::nullopt;
  const RateIntegral gyro(samples);
  const double late_s = best_offset(intervals, gyro);
  const RotationFit best = fit(intervals, gyro, late_s);
  if (best.pairs < kMinPairs || best.rate < kMinRate) return std::nullopt;
  ImuAlignment alignment{late_s, 0.0, best.body_from_imu, best.rate, best.misfit, best.axes_known};
  const std::span all(intervals);
  if (intervals.size() >= 3 * kMinPairs) {
    const std::size_t half = intervals.size() / 2;
    alignment.drift_s = best_offset(all.subspan(half), gyro) - best_offset(all.first(half), gyro);
  }
  return alignment;
}

}  // namespace lidarena::evaluation
