// SPDX-License-Identifier: BSD-3-Clause
// Tests that arena_lio's covariance matches its errors: normalized estimation error squared (NEES),
// averaged over seeds of all noise. LIDARENA_NEES_SEEDS sets their number; with the default, 3.3 to
// 9.6 of 6 is accepted.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "lidarena/base/so3.hpp"
#include "lidarena/base/time.hpp"
#include "lidarena/odometry/arena_lio/arena_lio.hpp"
#include "tests/odometry/synthetic_room.hpp"

namespace lidarena::odometry::arena_lio {
namespace {

using synthetic::Recording;
using Vector6 = Eigen::Matrix<double, 6, 1>;

int number_of_seeds() {
  const char* given = std::getenv("LIDARENA_NEES_SEEDS");
  return given == nullptr ? 8 : std::max(1, std::atoi(given));
}

/// Normalized squared errors and squared errors; of one flight, or summed over seeds.
struct Errors {
  double pose = 0.0, position = 0.0, attitude = 0.0;
  double meters2 = 0.0, radians2 = 0.0;

  Errors& operator+=(const Errors& e) {
    pose += e.pose;
    position += e.position;
    attitude += e.attitude;
    meters2 += e.meters2;
    radians2 += e.radians2;
    return *this;
  }
};

Errors errors_of(const ScanResult& result, const Pose& truth) {
  const Pose& estimate = result.estimate.world_from_body;
  Vector6 error;
  error << truth.translation() - estimate.translation(),
      so3::log(estimate.linear().transpose() * truth.linear());
  const Eigen::Matrix<double, 6, 6>& p = *result.covariance;
  const Eigen::Vector3d position = error.head<3>();
  const Eigen::Vector3d attitude = error.tail<3>();
  return {error.dot(p.ldlt().solve(error)),
          position.dot(p.topLeftCorner<3, 3>().ldlt().solve(position)),
          attitude.dot(p.bottomRightCorner<3, 3>().ldlt().solve(attitude)), position.squaredNorm(),
          attitude.squaredNorm()};
}

/// LIDARENA_NEES_SECONDS, else 5 s.
double seconds_of_flight() {
  const char* given = std::getenv("LIDARENA_NEES_SECONDS");
  return given == nullptr ? 5.0 : std::atof(given);
}

/// In the room: 1 s at rest, then the flight, with a Mid-360's noise: 2 cm and that of its IMU.
Recording noisy_flight(int seed) {
  Recording recording{.seconds = seconds_of_flight(), .range_noise_m = 0.02, .repeating = false};
  recording.seed = static_cast<std::uint64_t>(seed);
  recording.gyro_noise_density = 2.4e-4;
  recording.accel_noise_density = 1.7e-3;
  return recording;
}

constexpr int kEvery = 5;  // scans

/// Errors at every fifth scan from 1.5 s on.
std::vector<Errors> errors_over(const Recording& recording) {
  Rig rig = synthetic::rig_of(recording);
  rig.imus.front().gyro_noise_density = recording.gyro_noise_density;
  rig.imus.front().accel_noise_density = recording.accel_noise_density;
  const Config config = settings_for(rig.lidars.front());
  ArenaLio odometry(config, rig.lidars.front(), rig.imus.front(), Parallel(1));
  std::optional<StampedPose> first;  // at rest; it shows how the world was leveled
  std::vector<Errors> errors;
  int scans = 0;
  for (const Event& event : synthetic::record(recording)) {
    if (const auto* sample = std::get_if<ImuSample>(&event.data)) {
      odometry.register_imu(*sample);
      continue;
    }
    const ScanResult result = odometry.register_scan(std::get<Scan>(event.data));
    if (!first && result.covariance) first = result.estimate;
    if (++scans % kEvery != 0 || scans < 3 * kEvery) continue;
    const Pose truth = synthetic::truth(recording, first->stamp, result.estimate.stamp);
    errors.push_back(errors_of(result, first->world_from_body * truth));
  }
  return errors;
}

/// Means over the seeds for each of these scans.
std::vector<Errors> mean_errors(int seeds) {
  std::vector<Errors> sums;
  for (int seed = 1; seed <= seeds; ++seed) {
    const std::vector<Errors> errors = errors_over(noisy_flight(seed));
    sums.resize(errors.size());
    for (std::size_t i = 0; i < errors.size(); ++i) sums[i] += errors[i];
  }
  for (Errors& sum : sums) {
    for (double* part : {&sum.pose, &sum.position, &sum.attitude, &sum.meters2, &sum.radians2}) {
      *part /= seeds;
    }
  }
  return sums;
}

double mean_pose(const std::vector<Errors>& errors) {
  double sum = 0.0;
  for (const Errors& e : errors) sum += e.pose / static_cast<double>(errors.size());
  return sum;
}

/// Quantile of chi-square with `dof` degrees of freedom at `z` standard deviations of the normal
/// distribution (Wilson and Hilferty, PNAS 17, 1931; to 1 % for 18 degrees and more).
double chi_square(double dof, double z) {
  const double v = 2.0 / (9.0 * dof);
  return dof * std::pow(1.0 - v + z * std::sqrt(v), 3);
}

TEST(ArenaLioConsistency, TheCovarianceTellsTheErrors) {
  const int seeds = number_of_seeds();
  const std::vector<Errors> errors = mean_errors(seeds);
  ASSERT_GE(errors.size(), 8U);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    fmt::print(
        "{:.1f} s: pose {:.2f} of 6, position {:.2f} of 3, attitude {:.2f} of 3; rms {:.2f} mm, "
        "{:.3f} mrad\n",
        0.1 * kEvery * static_cast<double>(i + 3), errors[i].pose, errors[i].position,
        errors[i].attitude, 1e3 * std::sqrt(errors[i].meters2),
        1e3 * std::sqrt(errors[i].radians2));
  }
  // 99 % interval of chi-square. Only the seeds count as trials: instants of one flight are not
  // independent.
  constexpr double kZ = 2.5758;
  const double mean = mean_pose(errors);
  fmt::print("mean {:.2f}, 99 %: {:.2f} to {:.2f}\n", mean, chi_square(6.0 * seeds, -kZ) / seeds,
             chi_square(6.0 * seeds, kZ) / seeds);
  EXPECT_GT(mean, chi_square(6.0 * seeds, -kZ) / seeds);
  EXPECT_LT(mean, chi_square(6.0 * seeds, kZ) / seeds);
}

TEST(ArenaLioConsistency, TheQuantilesAreThoseOfTheTables) {
  EXPECT_NEAR(chi_square(120.0, -2.5758), 83.85, 0.1);
  EXPECT_NEAR(chi_square(120.0, 2.5758), 163.65, 0.1);
  EXPECT_NEAR(chi_square(18.0, -2.5758), 6.265, 0.07);
  EXPECT_NEAR(chi_square(18.0, 2.5758), 37.156, 0.07);
}

}  // namespace
}  // namespace lidarena::odometry::arena_lio
