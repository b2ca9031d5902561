// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/iterated_update.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "lidarena/base/random.hpp"
#include "lidarena/base/so3.hpp"
#include "tests/estimation/random_vector.hpp"

namespace lidarena::estimation {
namespace {

/// A LiDAR point that lies on the plane normal . x = offset in the world.
struct PlanePoint {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;
  double offset = 0.0;
};

/// Points in all directions from a LiDAR at `truth`, each with `sigma` m of noise across its plane.
std::vector<PlanePoint> simulate_points(const InertialState& truth, SequentialRandom& random,
                                        double sigma) {
  std::vector<PlanePoint> seen;
  for (int i = 0; i < 60; ++i) {
    PlanePoint one;
    one.point = random_vector(random, 4.0);
    one.normal = random_vector(random, 1.0).normalized();
    one.offset = one.normal.dot(truth.world_from_lidar() * one.point) + sigma * random.normal();
    seen.push_back(one);
  }
  return seen;
}

NormalEquations<kPointDof> equations(const std::vector<PlanePoint>& seen,
                                     const InertialState& state) {
  NormalEquations<kPointDof> sum;
  for (const PlanePoint& one : seen) {
    const Eigen::Vector3d in_imu = state.imu_from_lidar * one.point;
    const Eigen::Vector3d c = state.rotation().transpose() * one.normal;
    Eigen::Matrix<double, 1, kPointDof> row;
    row << one.normal.transpose(), in_imu.cross(c).transpose(),
        one.point.cross(state.imu_from_lidar.linear().transpose() * c).transpose(), c.transpose();
    const double residual = one.normal.dot(state.world_from_imu() * in_imu) - one.offset;
    sum.add<1>(row, Eigen::Matrix<double, 1, 1>(residual), 1.0);
  }
  return sum;
}

InertialState some_inertial_state(SequentialRandom& random) {
  InertialState state;
  state.position() = random_vector(random, 2.0);
  state.rotation() = so3::exp(random_vector(random, 1.0));
  state.imu_from_lidar.translation() = Eigen::Vector3d(0.01, 0.02, -0.04);
  return state;
}

InertialState::Matrix some_covariance(SequentialRandom& random, double sigma) {
  InertialState::Matrix root;
  for (Eigen::Index i = 0; i < root.size(); ++i) root.data()[i] = random.normal();
  return sigma * sigma *
         (InertialState::Matrix::Identity() +
          0.3 * root * root.transpose() / double{InertialState::kDof});
}

/// -log of the posterior, up to a constant.
double cost(const StateEstimate& prior, const std::vector<PlanePoint>& seen, double variance,
            const InertialState& x) {
  const InertialState::Vector moved = minus(x, prior.state);
  double sum = 0.5 * moved.dot(prior.covariance.ldlt().solve(moved));
  for (const PlanePoint& one : seen) {
    const double r = one.normal.dot(x.world_from_lidar() * one.point) - one.offset;
    sum += 0.5 * r * r / variance;
  }
  return sum;
}

TEST(IteratedUpdate, EndsWhereThePosteriorIsLargest) {
  SequentialRandom random(5, 1);
  for (int round = 0; round < 10; ++round) {
    constexpr double kVariance = 1e-4;
    const InertialState truth = some_inertial_state(random);
    StateEstimate prior;
    prior.covariance = some_covariance(random, 0.1);
    InertialState::Vector error;
    for (Eigen::Index i = 0; i < error.size(); ++i) error[i] = 0.1 * random.normal();
    prior.state = plus(truth, error);
    const auto seen = simulate_points(truth, random, 0.01);
    const auto updated =
        iterated_update(prior, [&](const InertialState& x, bool) { return equations(seen, x); },
                        {.max_iterations = 20, .tolerance = 1e-12, .variance = kVariance});
    EXPECT_EQ(updated.points.count, seen.size());
    const InertialState& x = updated.estimate.state;
    const double best = cost(prior, seen, kVariance, x);
    for (Eigen::Index i = 0; i < InertialState::kDof; ++i) {
      constexpr double kStep = 1e-4;
      const double up =
          cost(prior, seen, kVariance, plus(x, kStep * InertialState::Vector::Unit(i)));
      const double down =
          cost(prior, seen, kVariance, plus(x, -kStep * InertialState::Vector::Unit(i)));
      const double slope = (up - down) / (2.0 * kStep);
      const double curvature = (up + down - 2.0 * best) / (kStep * kStep);
      EXPECT_GT(curvature, 0.0);
      EXPECT_LT(std::abs(slope / curvature), 1e-6) << "distance to the maximum along axis " << i;
    }
  }
}

TEST(IteratedUpdate, ForALinearCaseIsTheKalmanUpdate) {
  // Only the position is measured, along three directions: the textbook gain, with an H of 3 rows.
  SequentialRandom random(6, 1);
  StateEstimate prior;
  prior.covariance = some_covariance(random, 0.1);
  const Eigen::Vector3d measured(0.3, -0.2, 0.1);
  constexpr double kVariance = 0.01;
  const auto updated = iterated_update(
      prior,
      [&](const InertialState& x, bool) {
        NormalEquations<kPointDof> sum;
        for (Eigen::Index i = 0; i < 3; ++i) {
          Eigen::Matrix<double, 1, kPointDof> row = Eigen::Matrix<double, 1, kPointDof>::Zero();
          row[i] = 1.0;
          sum.add<1>(row, Eigen::Matrix<double, 1, 1>(x.position()[i] - measured[i]), 1.0);
        }
        return sum;
      },
      {.max_iterations = 0, .variance = kVariance});
  const Eigen::Matrix<double, InertialState::kDof, 3> cross = prior.covariance.leftCols<3>();
  const Eigen::Matrix3d innovation =
      prior.covariance.topLeftCorner<3, 3>() + kVariance * Eigen::Matrix3d::Identity();
  const Eigen::Matrix<double, InertialState::kDof, 3> gain = cross * innovation.inverse();
  const InertialState::Vector step = gain * measured;
  EXPECT_LT(minus(updated.estimate.state, plus(prior.state, step)).norm(), 1e-12);
  const InertialState::Matrix covariance = prior.covariance - gain * cross.transpose();
  const InertialState::Matrix a = transport(prior.state, step);
  EXPECT_LT((updated.estimate.covariance - a * covariance * a.transpose()).norm(), 1e-12);
}

TEST(IteratedUpdate, SearchesAtTheStartAndAfterConverging) {
  SequentialRandom random(7, 1);
  const InertialState truth = some_inertial_state(random);
  const auto seen = simulate_points(truth, random, 0.0);
  std::vector<bool> searched;
  const auto residuals = [&](const InertialState& x, bool search) {
    searched.push_back(search);
    return equations(seen, x);
  };
  StateEstimate prior;
  prior.state = truth;  // nothing to correct: converged at once, and again after the search
  EXPECT_TRUE(iterated_update(prior, residuals, {}).converged);
  EXPECT_EQ(searched, (std::vector<bool>{true, true}));

  searched.clear();
  const auto restless = [&](const InertialState& x, bool search) {
    searched.push_back(search);
    auto sum = equations(seen, x);
    sum.gradient[0] += 10.0 * static_cast<double>(searched.size() % 2);
    return sum;
  };
  EXPECT_FALSE(iterated_update(prior, restless, {.max_iterations = 3}).converged);
  EXPECT_EQ(searched, (std::vector<bool>{true, false, false, true}))
      << "if none has converged, the last evaluation searches";
}

TEST(IteratedUpdate, WithoutResidualsThePriorStays) {
  StateEstimate prior;
  prior.state.position() = Eigen::Vector3d(1.0, 2.0, 3.0);
  prior.covariance *= 0.1;
  const auto updated = iterated_update(
      prior, [](const InertialState&, bool) { return NormalEquations<kPointDof>{}; }, {});
  EXPECT_EQ(updated.points.count, 0U);
  EXPECT_EQ(updated.estimate.state.position(), prior.state.position());
  EXPECT_EQ(updated.estimate.covariance, prior.covariance);
}

/// Errors of the filter after one second of motion: an initial state drawn from the prior, an IMU
/// with the noise that the filter assumes, and 60 points on known planes every 0.1 s. Returns the
/// normalized estimation error squared of pose (6) and of the whole state (23) at the end.
std::pair<double, double> normalized_errors(std::uint64_t seed) {
  constexpr double kStep = 0.005;
  constexpr double kSigma = 0.02;
  const ImuNoise noise{2e-3, 2e-2, 1e-3, 1e-2};
  SequentialRandom random(seed, 9);
  StateEstimate estimate;
  estimate.covariance = some_covariance(random, 0.03);
  InertialState::Vector drawn;
  for (Eigen::Index i = 0; i < drawn.size(); ++i) drawn[i] = random.normal();
  InertialState truth = plus(estimate.state, estimate.covariance.llt().matrixL() * drawn);
  for (int i = 1; i <= 200; ++i) {
    const double t = kStep * i;
    const Eigen::Vector3d rate(0.5 * std::sin(5.0 * t), 0.3, std::cos(4.0 * t));
    const Eigen::Vector3d force(2.0 * std::sin(6.0 * t), 1.0, 9.8 + std::cos(3.0 * t));
    const double white = 1.0 / std::sqrt(kStep);
    const Eigen::Vector3d gyro = rate + random_vector(random, noise.gyro_density * white);
    const Eigen::Vector3d accel = force + random_vector(random, noise.accel_density * white);
    propagate(truth, rate, force, kStep, Integration::kSecondOrder);
    truth.nav.bias.gyro += random_vector(random, noise.gyro_bias_walk * std::sqrt(kStep));
    truth.nav.bias.accel += random_vector(random, noise.accel_bias_walk * std::sqrt(kStep));
    const InertialState::Matrix f =
        propagate(estimate.state, gyro, accel, kStep, Integration::kSecondOrder);
    estimate.covariance = f * estimate.covariance * f.transpose() + step_noise(noise, kStep);
    if (i % 20 != 0) continue;
    const auto seen = simulate_points(truth, random, kSigma);
    estimate =
        iterated_update(estimate, [&](const InertialState& x, bool) { return equations(seen, x); },
                        {.max_iterations = 5, .tolerance = 1e-9, .variance = kSigma * kSigma})
            .estimate;
  }
  const InertialState::Vector error = minus(truth, estimate.state);
  const Eigen::Matrix<double, 6, 6> pose = estimate.covariance.topLeftCorner<6, 6>();
  return {error.head<6>().dot(pose.ldlt().solve(error.head<6>())),
          error.dot(estimate.covariance.ldlt().solve(error))};
}

TEST(IteratedUpdate, IsConsistentWhenTheNoiseIsAsItIsTold) {
  constexpr int kSeeds = 20;
  double pose = 0.0;
  double all = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const auto [of_pose, of_all] = normalized_errors(seed);
    pose += of_pose / kSeeds;
    all += of_all / kSeeds;
  }
  RecordProperty("nees_pose", std::to_string(pose));
  RecordProperty("nees_state", std::to_string(all));
  // 0.5 % and 99.5 % quantiles of chi-squared with 120 and 460 degrees of freedom, over 20.
  EXPECT_GT(pose, 83.85 / kSeeds);
  EXPECT_LT(pose, 163.65 / kSeeds);
  EXPECT_GT(all, 385.9 / kSeeds);
  EXPECT_LT(all, 542.0 / kSeeds);
}

TEST(ZeroVelocityUpdate, IsTheProductOfTheTwoGaussians) {
  SequentialRandom random(8, 1);
  StateEstimate prior;
  prior.covariance = some_covariance(random, 0.2);
  prior.state.nav.velocity = {0.1, -0.2, 0.05};
  constexpr double kSigma = 0.03;
  InertialState::Matrix information = prior.covariance.inverse();
  for (Eigen::Index i = 0; i < 3; ++i) {
    information(InertialState::kVelocity + i, InertialState::kVelocity + i) +=
        1.0 / (kSigma * kSigma);
  }
  InertialState::Vector gradient = InertialState::Vector::Zero();
  gradient.segment<3>(InertialState::kVelocity) = prior.state.nav.velocity / (kSigma * kSigma);
  const InertialState::Vector step = -information.inverse() * gradient;

  const StateEstimate updated = zero_velocity_update(prior, kSigma);
  EXPECT_LT(minus(updated.state, plus(prior.state, step)).norm(), 1e-9);
  const InertialState::Matrix a = transport(prior.state, step);
  EXPECT_LT((updated.covariance - a * information.inverse() * a.transpose()).norm(), 1e-9);
  EXPECT_LT(updated.state.nav.velocity.norm(), prior.state.nav.velocity.norm());
}

TEST(PoseUpdate, IsTheProductOfTheTwoGaussians) {
  SequentialRandom random(9, 1);
  StateEstimate prior;
  prior.covariance = some_covariance(random, 0.2);
  prior.state.position() = Eigen::Vector3d(1.0, 2.0, 3.0);
  prior.state.rotation() = so3::exp({0.1, -0.2, 0.7});
  constexpr double kShift = 0.03, kTurn = 0.01;
  InertialState::Vector off = InertialState::Vector::Zero();
  off.head<6>() << 0.02, -0.01, 0.03, 0.004, -0.002, 0.003;
  InertialState::Vector weight = InertialState::Vector::Zero();
  weight.head<3>().setConstant(1.0 / (kShift * kShift));
  weight.segment<3>(3).setConstant(1.0 / (kTurn * kTurn));
  const InertialState::Matrix information =
      prior.covariance.inverse() + InertialState::Matrix(weight.asDiagonal());
  const InertialState::Vector step = information.inverse() * weight.cwiseProduct(off);

  const Pose measured = plus(prior.state, off).world_from_imu();
  const StateEstimate updated = pose_update(prior, measured, kShift, kTurn);
  EXPECT_LT(minus(updated.state, plus(prior.state, step)).norm(), 1e-9);
  const InertialState::Matrix a = transport(prior.state, step);
  EXPECT_LT((updated.covariance - a * information.inverse() * a.transpose()).norm(), 1e-9);
}

}  // namespace
}  // namespace lidarena::estimation
