// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "lidarena/flight/flight.hpp"

/// Flights in closed form.
namespace lidarena::sensor::testing {

/// Constant velocity and constant body rate from `start`.
class UniformFlight : public flight::Flight {
 public:
  UniformFlight(Pose start, Eigen::Vector3d velocity_world, Eigen::Vector3d rate_body,
                double seconds)
      : start_(std::move(start)),
        velocity_(std::move(velocity_world)),
        rate_(std::move(rate_body)),
        duration_(from_seconds(seconds)) {}

  flight::Motion at(Time t) const override {
    const double s = to_seconds(t);
    const double angle = rate_.norm() * s;
    const Eigen::Vector3d axis = angle == 0.0 ? Eigen::Vector3d::UnitZ() : rate_.normalized();
    flight::Motion motion;
    motion.world_from_body = start_;
    motion.world_from_body.translation() += s * velocity_;
    motion.world_from_body.linear() =
        start_.linear() * Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    motion.velocity_world = velocity_;
    motion.angular_rate_body = rate_;
    return motion;
  }
  Time duration() const override { return duration_; }

 private:
  Pose start_;
  Eigen::Vector3d velocity_;
  Eigen::Vector3d rate_;
  Time duration_;
};

/// At rest for `seconds`.
inline UniformFlight rest(const Pose& pose, double seconds = 10.0) {
  return {pose, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), seconds};
}

/// A sinusoid a sin(w t + p) with its first two derivatives.
struct Wave {
  double amplitude;
  double rate;
  double phase;
  double value(double t) const { return amplitude * std::sin(rate * t + phase); }
  double first(double t) const { return amplitude * rate * std::cos(rate * t + phase); }
  double second(double t) const { return -amplitude * rate * rate * std::sin(rate * t + phase); }
};

/// Position and yaw, pitch, roll (R = Rz Ry Rx) are sinusoids of time.
class SwingingFlight : public flight::Flight {
 public:
  explicit SwingingFlight(double seconds) : duration_(from_seconds(seconds)) {}

  flight::Motion at(Time time) const override {
    const double t = to_seconds(time);
    flight::Motion motion;
    for (int i = 0; i < 3; ++i) {
      motion.world_from_body.translation()[i] = position_[i].value(t);
      motion.velocity_world[i] = position_[i].first(t);
      motion.acceleration_world[i] = position_[i].second(t);
    }
    const double roll = roll_.value(t);
    const double pitch = pitch_.value(t);
    motion.world_from_body.linear() = (Eigen::AngleAxisd(yaw_.value(t), Eigen::Vector3d::UnitZ()) *
                                       Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                                       Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
                                          .toRotationMatrix();
    // Body rate from Euler rates, and its derivative by the product rule.
    const double cr = std::cos(roll), sr = std::sin(roll);
    const double cp = std::cos(pitch), sp = std::sin(pitch);
    const double dr = roll_.first(t), dp = pitch_.first(t), dy = yaw_.first(t);
    const double ddr = roll_.second(t), ddp = pitch_.second(t), ddy = yaw_.second(t);
    motion.angular_rate_body = {dr - dy * sp, dp * cr + dy * cp * sr, -dp * sr + dy * cp * cr};
    motion.angular_acceleration_body = {
        ddr - ddy * sp - dy * dp * cp,
        ddp * cr - dp * dr * sr + ddy * cp * sr - dy * dp * sp * sr + dy * dr * cp * cr,
        -ddp * sr - dp * dr * cr + ddy * cp * cr - dy * dp * sp * cr - dy * dr * cp * sr};
    return motion;
  }
  Time duration() const override { return duration_; }

 private:
  Time duration_;
  Wave position_[3] = {{2.0, 0.9, 0.3}, {1.5, 1.3, -0.4}, {0.5, 2.1, 1.0}};
  Wave yaw_{1.2, 0.8, 0.1};
  Wave pitch_{0.4, 1.7, 0.7};
  Wave roll_{0.5, 1.1, -0.9};
};

inline Pose tilted_pose(const Eigen::Vector3d& position, double roll, double pitch, double yaw) {
  return make_pose(Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX())),
                   position);
}

inline double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }
inline double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

}  // namespace lidarena::sensor::testing
