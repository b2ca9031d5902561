// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace lidarena::flight {

/// Uniform B-spline of degree D with values in R^N (de Boor, "A Practical Guide to Splines").
/// Interval k spans [k, k+1) * knot seconds and depends on the control points k .. k+D; control
/// point j has its center at (j - (D-1)/2) * knot. D - 1 times continuously differentiable.
///
/// Weights are not negative and sum to one, so a value lies in the convex hull of its D+1 control
/// points, and a derivative in that of the control points' finite differences: bounds on the
/// differences of control points are bounds on the derivatives at every instant. Straight lines
/// are reproduced; a curve with second derivative below m, sampled at the control points' centers,
/// is approximated within m/2 * kVariance * knot^2 (Taylor expansion; the second moment of the
/// weights is constant).
template <int D, int N>
class UniformSpline {
 public:
  using Value = Eigen::Matrix<double, N, 1>;
  static constexpr double kVariance = (D + 1) / 12.0;    ///< variance of the weights, in knots^2
  static constexpr double kHalfSupport = (D + 1) / 2.0;  ///< half width of the weights, in knots

  /// At least D + 1 control points; knot > 0.
  UniformSpline(const std::vector<Value>& controls, double knot) : rate_(1.0 / knot) {
    static constexpr auto kWeights = basis();
    pieces_.resize(controls.size() - D, Piece::Zero());
    for (std::size_t k = 0; k < pieces_.size(); ++k) {
      for (std::size_t j = 0; j <= D; ++j) {
        for (std::size_t power = 0; power <= D; ++power) {
          pieces_[k].col(static_cast<int>(power)) += kWeights[j][power] * controls[k + j];
        }
      }
    }
  }

  static double center(std::size_t control, double knot) {
    return (static_cast<double>(control) - (D - 1) / 2.0) * knot;
  }

  using Weights = Eigen::Matrix<double, D + 1, 1>;
  /// Weights of the control points of an interval in the derivative of order `Order`, per
  /// second^Order, at `u` in [0, 1] within it.
  template <int Order>
  static Weights weights(double u, double knot) {
    static constexpr auto kWeights = basis();
    Weights value = Weights::Zero();
    for (int j = 0; j <= D; ++j) {
      for (int power = D; power >= Order; --power)
        value[j] = value[j] * u +
                   falling(power, Order) *
                       kWeights[static_cast<std::size_t>(j)][static_cast<std::size_t>(power)];
    }
    return value / std::pow(knot, Order);
  }

  std::size_t intervals() const { return pieces_.size(); }

  /// Position on the spline that belongs to a time.
  struct Place {
    const Eigen::Matrix<double, N, D + 1>* piece;
    double u;  ///< [0, 1] within the piece
  };
  /// The place of time `t` (s), which is clamped to the spline's range.
  Place find(double t) const {
    const double last = static_cast<double>(pieces_.size() - 1);
    const double x = std::clamp(t * rate_, 0.0, last + 1.0);
    const double k = std::min(static_cast<double>(static_cast<std::size_t>(x)), last);
    return {&pieces_[static_cast<std::size_t>(k)], x - k};
  }

  /// Derivative of order `Order` at a place, per second^Order (Horner).
  template <int Order>
  Value derivative(const Place& at) const {
    Value value = falling(D, Order) * at.piece->col(D);
    for (int power = D - 1; power >= Order; --power) {
      value = value * at.u + falling(power, Order) * at.piece->col(power);
    }
    double scale = 1.0;
    for (int i = 0; i < Order; ++i) scale *= rate_;
    return value * scale;
  }

 private:
  using Piece = Eigen::Matrix<double, N, D + 1>;  ///< column i: coefficient of u^i

  /// n (n-1) ... (n-order+1)
  static constexpr double falling(int n, int order) {
    double product = 1.0;
    for (int i = 0; i < order; ++i) product *= n - i;
    return product;
  }

  /// weights[j][i]: coefficient of u^i in the weight of control point j (Cox-de Boor recursion).
  static constexpr std::array<std::array<double, D + 1>, D + 1> basis() {
    std::array<std::array<double, D + 1>, D + 1> weights{};
    weights[0][0] = 1.0;
    for (int degree = 1; degree <= D; ++degree) {
      std::array<std::array<double, D + 1>, D + 1> next{};
      for (int j = 0; j <= degree; ++j) {
        for (int i = 0; i <= degree; ++i) {
          const auto lower = [&](int control, int power) {
            const bool inside = control >= 0 && control < degree && power >= 0;
            return inside
                       ? weights[static_cast<std::size_t>(control)][static_cast<std::size_t>(power)]
                       : 0.0;
          };
          next[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] =
              (lower(j - 1, i - 1) + (degree - j) * lower(j - 1, i) - lower(j, i - 1) +
               (j + 1) * lower(j, i)) /
              degree;
        }
      }
      weights = next;
    }
    return weights;
  }

  std::vector<Piece> pieces_;
  double rate_;  ///< knots per second
};

}  // namespace lidarena::flight
