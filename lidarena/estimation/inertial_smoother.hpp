// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>

#include "lidarena/estimation/preintegration.hpp"

namespace lidarena::estimation {

/// A pose of the IMU measured by another method, e.g. scan matching.
struct PoseMeasurement {
  using Information = Eigen::Matrix<double, 6, 6>;
  Pose world_from_imu = Pose::Identity();
  /// Inverse covariance of (rotation in the IMU's frame, position in the world); may be singular.
  Information information = Information::Identity();
};

/// Initial state of a smoother.
struct InertialStart {
  NavState state;
  NavState::Matrix covariance = NavState::Matrix::Identity();
  Eigen::Vector3d gravity{0.0, 0.0, -9.80665};  ///< m/s^2, world; taken as exact
};

/// Fuses poses from scan matching with the IMU: a factor graph of the last few states joined by
/// preintegrated measurements (Shan et al., "LIO-SAM", IROS 2020, section III-B), solved by
/// Gauss-Newton; older states are marginalized into a prior.
class InertialSmoother {
 public:
  /// `lag`: number of measurements that stay in the graph (at least 1).
  explicit InertialSmoother(int lag = 6) : lag_(static_cast<std::size_t>(lag)) {}

  void start(const InertialStart& start);
  /// Adds the state at the end of `since_last` and its measured pose.
  void add(const Preintegration& since_last, const PoseMeasurement& measured);

  const NavState& latest() const { return states_.back(); }
  /// Covariance of the latest state.
  const NavState::Matrix& covariance() const { return covariance_; }
  std::size_t size() const { return states_.size(); }

 private:
  struct Equations {  ///< the unknowns are those of one state after the other
    Eigen::MatrixXd hessian;
    Eigen::VectorXd gradient;
  };

  Equations equations(std::size_t states, std::size_t measurements) const;
  void add_prior(Equations& sum) const;
  void add_motion(std::size_t first, Equations& sum) const;
  void add_measurement(std::size_t state, Equations& sum) const;
  void move(const Eigen::VectorXd& step);
  void marginalize_oldest();

  std::size_t lag_;
  std::deque<NavState> states_;
  std::deque<Preintegration> motions_;        ///< from each state to the next
  std::deque<PoseMeasurement> measurements_;  ///< of each state
  Eigen::Vector3d gravity_ = Eigen::Vector3d::Zero();
  NavState prior_state_;  ///< prior mean of the oldest state
  NavState::Matrix prior_information_ = NavState::Matrix::Identity();
  NavState::Matrix covariance_ = NavState::Matrix::Identity();
};

}  // namespace lidarena::estimation
