// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cstddef>

#include "lidarena/base/parallel.hpp"

namespace lidarena::estimation {

/// Gauss-Newton's normal equations H dx = -g of the cost 1/2 sum w |r + J dx|^2 in N unknowns.
template <int N>
struct NormalEquations {
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;

  Matrix hessian = Matrix::Zero();   ///< sum of w J^T J
  Vector gradient = Vector::Zero();  ///< sum of w J^T r
  double cost = 0.0;                 ///< 1/2 sum of w |r|^2
  std::size_t count = 0;             ///< number of residual blocks

  /// Adds one residual block of R rows with its Jacobian and weight.
  template <int R>
  void add(const Eigen::Matrix<double, R, N>& jacobian, const Eigen::Matrix<double, R, 1>& residual,
           double weight) {
    hessian.noalias() += jacobian.transpose() * (weight * jacobian);
    gradient.noalias() += jacobian.transpose() * (weight * residual);
    cost += 0.5 * weight * residual.squaredNorm();
    ++count;
  }

  NormalEquations& operator+=(const NormalEquations& other) {
    hessian += other.hessian;
    gradient += other.gradient;
    cost += other.cost;
    count += other.count;
    return *this;
  }

  /// The step, by L D L^T decomposition; zero if no residual constrains any direction.
  Vector solve() const { return -hessian.ldlt().solve(gradient); }
};

/// Sums body(i, equations) over i in [0, count); bit-identical for any number of threads.
template <int N, class Body>
NormalEquations<N> accumulate_normal_equations(const Parallel& parallel, std::size_t count,
                                               Body&& body) {
  constexpr std::size_t kGrain = 256;
  return parallel.reduce(
      count, kGrain, NormalEquations<N>{},
      [&](std::size_t begin, std::size_t end) {
        NormalEquations<N> part;
        for (std::size_t i = begin; i < end; ++i) body(i, part);
        return part;
      },
      [](NormalEquations<N>& total, const NormalEquations<N>& part) { total += part; });
}

}  // namespace lidarena::estimation
