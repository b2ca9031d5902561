// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/imu_spline_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>

#include "lidarena/base/angle.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;
using Spline = PoseSplineFlight::Spline;
using Value = Spline::Value;  // x y z of the position, x y z w of the quaternion
constexpr int kControls = PoseSplineFlight::kDegree + 1;  // that one instant depends on
constexpr int kOfControls = 7 * kControls;
constexpr int kLocal = kOfControls + 12;  // unknowns of one instant: controls, two biases each
constexpr int kMaxIterations = 20;
constexpr double kConverged = 1e-5;  // relative change of the residuals' RMS
constexpr Time kGap = std::chrono::milliseconds(200);  // without poses
// A bias changes by no more than about this much from one of its knots to the next.
constexpr double kGyroBiasStep = 0.01, kAccelBiasStep = 0.1;  // rad/s, m/s^2
constexpr double kDamping = 1.0;     // 1/m^2; a pose has 1 / pose_sigma_m^2, 250,000
constexpr double kNormSigma = 1e-3;  // of the quaternion's squared length at a control point
using Local = Eigen::Matrix<double, kLocal, kLocal>;
using LocalVector = Eigen::Matrix<double, kLocal, 1>;
using Rows3 = Eigen::Matrix<double, 3, kLocal>;
using Rows34 = Eigen::Matrix<double, 3, 4>;

/// The vector part of conj(q) p as a matrix times p.
Rows34 left_of(const Vector4d& q) {
  Rows34 m;
  m.leftCols<3>() = q.w() * Matrix3d::Identity();
  m.leftCols<3>() -=
      (Matrix3d() << 0, -q.z(), q.y(), q.z(), 0, -q.x(), -q.y(), q.x(), 0).finished();
  m.col(3) = -q.head<3>();
  return m;
}

/// The vector part of conj(q) p as a matrix times q.
Rows34 right_of(const Vector4d& p) { return -left_of(p); }

/// Pose, velocity and acceleration at one instant, as sums over its control points.
struct Instant {
  std::size_t interval = 0;
  std::array<Spline::Weights, 3> weights;  ///< of the value and its two derivatives
  std::array<Value, 3> values;

  Vector4d q() const { return values[0].tail<4>(); }
  Matrix3d world_from_imu() const { return Quaterniond(q()).normalized().toRotationMatrix(); }
};

/// Sums of squares of one kind of residual.
struct Spread {
  double sum = 0.0;
  std::size_t count = 0;
  void add(const Vector3d& residual) {
    sum += residual.squaredNorm();
    count += 3;
  }
  double rms() const { return count == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(count)); }
};
struct Spreads {
  Spread position, rotation, gyro, accel, gyro_out, accel_out;
};

/// Normal equations, the lower triangle.
class Normal {
 public:
  /// Damped a little (Levenberg), so that an unknown that no measurement shows stays as it is: the
  /// last control points matter next to nothing where the flight ends early in their interval.
  explicit Normal(Eigen::Index unknowns) : right_(Eigen::VectorXd::Zero(unknowns)) {
    for (Eigen::Index i = 0; i < unknowns; ++i) entries_.emplace_back(i, i, kDamping);
  }

  void add(const Local& h, const LocalVector& g, const std::array<Eigen::Index, kLocal>& at) {
    for (int i = 0; i < kLocal; ++i) {
      right_[at[static_cast<std::size_t>(i)]] -= g[i];
      for (int j = 0; j <= i; ++j) {
        if (h(i, j) == 0.0) continue;
        entries_.emplace_back(at[static_cast<std::size_t>(i)], at[static_cast<std::size_t>(j)],
                              h(i, j));
      }
    }
  }
  /// The difference of the three unknowns from `at` on and the next three, of this sigma.
  void add_step(Eigen::Index at, const Vector3d& difference, double sigma) {
    const double weight = 1.0 / (sigma * sigma);
    for (Eigen::Index i = 0; i < 3; ++i) {
      entries_.emplace_back(at + i, at + i, weight);
      entries_.emplace_back(at + i + 3, at + i + 3, weight);
      entries_.emplace_back(at + i + 3, at + i, -weight);
      right_[at + i] += weight * difference[i];
      right_[at + i + 3] -= weight * difference[i];
    }
  }
  Eigen::VectorXd solve() const {
    Eigen::SparseMatrix<double> h(right_.size(), right_.size());
    h.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(h);
    return ldlt.solve(right_);
  }

 private:
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::VectorXd right_;
};

class Fit {
 public:
  Fit(const Trajectory& poses, const std::vector<ImuSample>& samples, const ImuFitConfig& config)
      : poses_(poses),
        samples_(samples),
        config_(config),
        duration_(poses.end_time() - poses.begin_time()) {
    const double length = to_seconds(duration_);
    intervals_ = static_cast<std::size_t>(std::ceil(length / config.knot_s));
    for (std::size_t j = 0; j < intervals_ + PoseSplineFlight::kDegree; ++j)
      controls_.push_back(start_of(Spline::center(j, config.knot_s)));
    // A bias knot belongs to whole intervals, so that one interval depends on two of each bias.
    intervals_per_bias_ =
        std::max<std::size_t>(1, static_cast<std::size_t>(config.bias_knot_s / config.knot_s));
    find_left_out();
    const std::size_t knots = (intervals_ - 1) / intervals_per_bias_ + 2;
    gyro_bias_.assign(knots, Vector3d::Zero());
    accel_bias_.assign(knots, Vector3d::Zero());
  }

  ImuSplineFit solve() {
    int iteration = 0;
    for (; iteration < kMaxIterations; ++iteration) {
      apply(gauss_newton_step());
      const double gyro = gyro_sigma_, accel = accel_sigma_;
      update_weights();
      if (std::abs(gyro_sigma_ - gyro) < kConverged * gyro &&
          std::abs(accel_sigma_ - accel) < kConverged * accel)
        break;
    }
    const Spreads s = spreads();
    ImuSplineFit fit{controls_,
                     config_.knot_s,
                     duration_,
                     s.position.rms(),
                     s.rotation.rms(),
                     {s.gyro.rms(), s.accel.rms()},
                     {s.gyro_out.rms(), s.accel_out.rms()},
                     mean(gyro_bias_),
                     mean(accel_bias_),
                     iteration};
    return fit;
  }

 private:
  static Vector3d mean(const std::vector<Vector3d>& values) {
    Vector3d sum = Vector3d::Zero();
    for (const Vector3d& value : values) sum += value;
    return sum / static_cast<double>(values.size());
  }

  static std::size_t second_of(Time t) {
    return static_cast<std::size_t>(t / std::chrono::seconds(1));
  }
  /// One second of five, unless poses are missing in it.
  void find_left_out() {
    left_out_.resize(second_of(duration_) + 1);
    for (std::size_t i = 0; i < left_out_.size(); ++i)
      left_out_[i] = i % 5 == static_cast<std::size_t>(config_.left_out_second);
    const auto list = poses_.poses();
    for (std::size_t i = 0; i + 1 < list.size(); ++i) {
      if (list[i + 1].stamp - list[i].stamp < kGap) continue;
      const std::size_t end = second_of(list[i + 1].stamp - poses_.begin_time());
      for (std::size_t k = second_of(list[i].stamp - poses_.begin_time()); k <= end; ++k)
        left_out_[k] = false;
    }
  }

  /// The recorded pose next to `t` (s), with the quaternion's sign of the control point before.
  Value start_of(double t) const {
    const auto list = poses_.poses();
    const Time stamp =
        poses_.begin_time() + from_seconds(std::clamp(t, 0.0, to_seconds(duration_)));
    const auto after = std::ranges::lower_bound(list, stamp, {}, &StampedPose::stamp);
    const Pose& pose = (after == list.end() ? list.back() : *after).world_from_body;
    Quaterniond q(pose.linear());
    if (!controls_.empty() && q.coeffs().dot(controls_.back().tail<4>()) < 0.0)
      q.coeffs() = -q.coeffs();
    Value value;
    value << pose.translation(), q.coeffs();
    return value;
  }

  Instant instant(Time t) const {
    const double place = to_seconds(t) / config_.knot_s;
    Instant at;
    at.interval = std::min(static_cast<std::size_t>(std::max(place, 0.0)), intervals_ - 1);
    const double u = place - static_cast<double>(at.interval);
    at.weights = {Spline::weights<0>(u, config_.knot_s), Spline::weights<1>(u, config_.knot_s),
                  Spline::weights<2>(u, config_.knot_s)};
    for (std::size_t order = 0; order < 3; ++order) {
      at.values[order].setZero();
      for (int j = 0; j < kControls; ++j)
        at.values[order] +=
            at.weights[order][j] * controls_[at.interval + static_cast<std::size_t>(j)];
    }
    return at;
  }

  /// Index of the bias knot before an instant, and the share of the one after it.
  std::pair<std::size_t, double> bias_place(const Instant& at, Time t) const {
    const std::size_t knot = at.interval / intervals_per_bias_;
    const double length = static_cast<double>(intervals_per_bias_) * config_.knot_s;
    return {knot, to_seconds(t) / length - static_cast<double>(knot)};
  }
  static Vector3d bias_at(const std::vector<Vector3d>& biases, std::pair<std::size_t, double> at) {
    return (1.0 - at.second) * biases[at.first] + at.second * biases[at.first + 1];
  }

  /// Derivative with respect to the local unknowns, from those with respect to value, first and
  /// second derivative of position (`p`) and quaternion (`q`).
  static Rows3 chained(const Instant& at, const std::array<Matrix3d, 3>& p,
                       const std::array<Rows34, 3>& q) {
    Rows3 rows = Rows3::Zero();
    for (int j = 0; j < kControls; ++j) {
      for (std::size_t order = 0; order < 3; ++order) {
        rows.middleCols<3>(7 * j) += at.weights[order][j] * p[order];
        rows.middleCols<4>(7 * j + 3) += at.weights[order][j] * q[order];
      }
    }
    return rows;
  }
  static void set_bias(Rows3& rows, int first, double share) {
    rows.middleCols<3>(kOfControls + first) = (1.0 - share) * Matrix3d::Identity();
    rows.middleCols<3>(kOfControls + first + 3) = share * Matrix3d::Identity();
  }

  struct Term {
    Vector3d residual;
    Rows3 rows;
  };

  Term position_term(const Instant& at, const Pose& recorded) const {
    const Matrix3d zero = Matrix3d::Zero();
    const Rows34 none = Rows34::Zero();
    return {at.values[0].head<3>() - recorded.translation(),
            chained(at, {Matrix3d::Identity(), zero, zero}, {none, none, none})};
  }
  /// The rotation vector from the recorded rotation to the spline's, to first order.
  Term rotation_term(const Instant& at, const Pose& recorded) const {
    Quaterniond q(recorded.linear());
    if (q.coeffs().dot(at.q()) < 0.0) q.coeffs() = -q.coeffs();
    const double n = at.q().norm();
    const Matrix3d zero = Matrix3d::Zero();
    const Rows34 none = Rows34::Zero();
    const Vector3d residual = 2.0 / n * left_of(q.coeffs()) * at.q();
    const Rows34 to_q = 2.0 / n * left_of(q.coeffs()) - residual * at.q().transpose() / (n * n);
    return {residual, chained(at, {zero, zero, zero}, {to_q, none, none})};
  }
  Term gyro_term(const Instant& at, std::pair<std::size_t, double> bias,
                 const ImuSample& sample) const {
    const Vector4d q = at.q(), dq = at.values[1].tail<4>();
    const double n2 = q.squaredNorm();
    const Vector3d rate = 2.0 / n2 * left_of(q) * dq;
    const Matrix3d zero = Matrix3d::Zero();
    Term term{rate + bias_at(gyro_bias_, bias) - sample.gyro,
              chained(at, {zero, zero, zero},
                      {2.0 / n2 * right_of(dq) - 2.0 / n2 * rate * q.transpose(),
                       2.0 / n2 * left_of(q), Rows34::Zero()})};
    set_bias(term.rows, 0, bias.second);
    return term;
  }
  Term accel_term(const Instant& at, std::pair<std::size_t, double> bias,
                  const ImuSample& sample) const {
    const Vector4d q = at.q();
    const Matrix3d imu_from_world = at.world_from_imu().transpose();
    const Vector3d force = imu_from_world * (at.values[2].head<3>() + Vector3d(0.0, 0.0, kGravity));
    Matrix3d hat;
    hat << 0, -force.z(), force.y(), force.z(), 0, -force.x(), -force.y(), force.x(), 0;
    const Matrix3d zero = Matrix3d::Zero();
    const Rows34 none = Rows34::Zero();
    Term term{force + bias_at(accel_bias_, bias) - sample.accel,
              chained(at, {zero, zero, imu_from_world},
                      {2.0 / q.squaredNorm() * hat * left_of(q), none, none})};
    set_bias(term.rows, 6, bias.second);
    return term;
  }

  /// Calls pose(instant, recorded pose), imu(instant, bias place, sample) for all measurements of
  /// one interval after the other, and end(interval).
  template <class OnPose, class OnImu, class OnEnd>
  void visit(OnPose&& pose, OnImu&& imu, OnEnd&& end) const {
    const auto list = poses_.poses();
    std::size_t next_pose = 0, next_sample = 0;
    for (std::size_t interval = 0; interval < intervals_; ++interval) {
      const auto is_here = [&](Time t) {
        return t >= Time{0} && t <= duration_ && instant_interval(t) == interval;
      };
      for (; next_pose < list.size(); ++next_pose) {
        const Time t = list[next_pose].stamp - poses_.begin_time();
        if (!is_here(t)) break;
        pose(instant(t), list[next_pose].world_from_body);
      }
      for (; next_sample < samples_.size(); ++next_sample) {
        const Time t = samples_[next_sample].stamp - poses_.begin_time();
        if (t < Time{0}) continue;
        if (!is_here(t)) break;
        const Instant at = instant(t);
        imu(at, bias_place(at, t), samples_[next_sample], left_out_[second_of(t)]);
      }
      end(interval);
    }
  }
  std::size_t instant_interval(Time t) const {
    return std::min(static_cast<std::size_t>(to_seconds(t) / config_.knot_s), intervals_ - 1);
  }

  Eigen::Index unknowns() const {
    return static_cast<Eigen::Index>(7 * controls_.size() + 6 * gyro_bias_.size());
  }
  /// Indices of the local unknowns of an interval: its controls, its gyro and its accel biases.
  std::array<Eigen::Index, kLocal> places_of(std::size_t interval) const {
    std::array<Eigen::Index, kLocal> at{};
    for (std::size_t i = 0; i < kOfControls; ++i)
      at[i] = static_cast<Eigen::Index>(7 * interval + i);
    const auto biases = static_cast<Eigen::Index>(7 * controls_.size());
    const auto knot = static_cast<Eigen::Index>(interval / intervals_per_bias_);
    const auto accel = static_cast<Eigen::Index>(3 * gyro_bias_.size());
    for (Eigen::Index i = 0; i < 6; ++i) {
      at[static_cast<std::size_t>(kOfControls + i)] = biases + 3 * knot + i;
      at[static_cast<std::size_t>(kOfControls + 6 + i)] = biases + accel + 3 * knot + i;
    }
    return at;
  }

  Eigen::VectorXd gauss_newton_step() const {
    Normal normal(unknowns());
    Local h = Local::Zero();
    LocalVector g = LocalVector::Zero();
    const auto add = [&](const Term& term, double sigma) {
      h.selfadjointView<Eigen::Lower>().rankUpdate(term.rows.transpose(), 1.0 / (sigma * sigma));
      g.noalias() += term.rows.transpose() * term.residual / (sigma * sigma);
    };
    visit(
        [&](const Instant& at, const Pose& recorded) {
          add(position_term(at, recorded), config_.pose_sigma_m);
          add(rotation_term(at, recorded), config_.pose_sigma_rad);
        },
        [&](const Instant& at, std::pair<std::size_t, double> bias, const ImuSample& sample,
            bool left_out) {
          if (left_out) return;
          add(gyro_term(at, bias, sample), gyro_sigma_);
          add(accel_term(at, bias, sample), accel_sigma_);
        },
        [&](std::size_t interval) {
          add_norms(interval, h, g);
          normal.add(h, g, places_of(interval));
          h.setZero();
          g.setZero();
        });
    add_bias_steps(normal);
    return normal.solve();
  }

  /// Holds a bias where an interval has no samples.
  void add_bias_steps(Normal& normal) const {
    const auto first = static_cast<Eigen::Index>(7 * controls_.size());
    const auto count = static_cast<Eigen::Index>(gyro_bias_.size());
    for (Eigen::Index knot = 0; knot + 1 < count; ++knot) {
      const auto k = static_cast<std::size_t>(knot);
      normal.add_step(first + 3 * knot, gyro_bias_[k + 1] - gyro_bias_[k], kGyroBiasStep);
      normal.add_step(first + 3 * (count + knot), accel_bias_[k + 1] - accel_bias_[k],
                      kAccelBiasStep);
    }
  }

  /// The quaternions of the control points have length one: the spline's own length is free.
  void add_norms(std::size_t interval, Local& h, LocalVector& g) const {
    for (int j = 0; j < kControls; ++j) {
      if (j > 0 && interval + 1 < intervals_) break;  // those of the last interval, all
      const Vector4d q = controls_[interval + static_cast<std::size_t>(j)].tail<4>();
      const double weight = 1.0 / (kNormSigma * kNormSigma);
      h.block<4, 4>(7 * j + 3, 7 * j + 3) += weight * 4.0 * q * q.transpose();
      g.segment<4>(7 * j + 3) += weight * (q.squaredNorm() - 1.0) * 2.0 * q;
    }
  }

  void apply(const Eigen::VectorXd& step) {
    Eigen::Index at = 0;
    for (Value& control : controls_) {
      control += step.segment<7>(at);
      at += 7;
    }
    for (auto* biases : {&gyro_bias_, &accel_bias_}) {
      for (Vector3d& bias : *biases) {
        bias += step.segment<3>(at);
        at += 3;
      }
    }
  }

  Spreads spreads() const {
    Spreads s;
    visit(
        [&](const Instant& at, const Pose& recorded) {
          s.position.add(position_term(at, recorded).residual);
          s.rotation.add(rotation_term(at, recorded).residual);
        },
        [&](const Instant& at, std::pair<std::size_t, double> bias, const ImuSample& sample,
            bool left_out) {
          (left_out ? s.gyro_out : s.gyro).add(gyro_term(at, bias, sample).residual);
          (left_out ? s.accel_out : s.accel).add(accel_term(at, bias, sample).residual);
        },
        [](std::size_t) {});
    return s;
  }
  void update_weights() {
    const Spreads s = spreads();
    gyro_sigma_ = std::max(s.gyro.rms(), 1e-6);
    accel_sigma_ = std::max(s.accel.rms(), 1e-6);
  }

  const Trajectory& poses_;
  const std::vector<ImuSample>& samples_;
  ImuFitConfig config_;
  Time duration_;
  std::size_t intervals_ = 0, intervals_per_bias_ = 1;
  std::vector<bool> left_out_;  ///< per second
  std::vector<Value> controls_;
  std::vector<Vector3d> gyro_bias_, accel_bias_;  ///< at their knots
  double gyro_sigma_ = 0.05, accel_sigma_ = 1.0;  ///< of a sample; the first iteration's
};

}  // namespace

ImuSplineFit fit_imu_spline(const Trajectory& poses, const std::vector<ImuSample>& samples,
                            const ImuFitConfig& config, const std::string& name) {
  if (poses.poses().size() < 2)
    throw InputError(name, fmt::format("has {} pose(s)", poses.poses().size()),
                     "a replay needs at least two");
  constexpr Time kSlack = std::chrono::milliseconds(100);
  if (samples.empty() || samples.front().stamp > poses.begin_time() + kSlack ||
      samples.back().stamp < poses.end_time() - kSlack)
    throw InputError(name, "its IMU samples do not cover its poses",
                     "give both the same clock, or cut the poses");
  return Fit(poses, samples, config).solve();
}

std::string describe(const ImuSplineFit& fit) {
  return fmt::format(
      "spline with knots every {:g} s through {:.1f} s; RMS of the poses {:.1f} mm and {:.3f} deg, "
      "of the gyro {:.4f} rad/s (left out: {:.4f}), of the accelerometer {:.3f} m/s^2 (left out: "
      "{:.3f}), each axis; biases ({:.4f}, {:.4f}, {:.4f}) rad/s and ({:.3f}, {:.3f}, {:.3f}) "
      "m/s^2; {} iterations",
      fit.knot_s, to_seconds(fit.duration), 1e3 * fit.position_rms_m,
      fit.rotation_rms_rad * kDegreesPerRadian, fit.fitted.gyro_rad_s, fit.left_out.gyro_rad_s,
      fit.fitted.accel_m_s2, fit.left_out.accel_m_s2, fit.gyro_bias.x(), fit.gyro_bias.y(),
      fit.gyro_bias.z(), fit.accel_bias.x(), fit.accel_bias.y(), fit.accel_bias.z(),
      fit.iterations);
}

}  // namespace lidarena::flight
