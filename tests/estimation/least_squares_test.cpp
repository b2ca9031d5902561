// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/least_squares.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "lidarena/base/random.hpp"

namespace lidarena::estimation {
namespace {

using Row = Eigen::Matrix<double, 1, 6>;
using Scalar = Eigen::Matrix<double, 1, 1>;

struct Problem {
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd residual;
  Eigen::VectorXd weight;
};

Problem random_problem(int rows) {
  SequentialRandom random(21);
  Problem p{Eigen::MatrixXd(rows, 6), Eigen::VectorXd(rows), Eigen::VectorXd(rows)};
  for (double& x : p.jacobian.reshaped()) x = random.normal();
  for (double& x : p.residual) x = random.normal();
  for (double& x : p.weight) x = random.uniform(0.1, 1.0);
  return p;
}

NormalEquations<6> accumulated(const Problem& p, int threads) {
  return accumulate_normal_equations<6>(
      Parallel(threads), static_cast<std::size_t>(p.residual.size()),
      [&](std::size_t i, NormalEquations<6>& equations) {
        const auto row = static_cast<Eigen::Index>(i);
        equations.add<1>(Row(p.jacobian.row(row)), Scalar(p.residual[row]), p.weight[row]);
      });
}

TEST(NormalEquations, StepIsTheWeightedLeastSquaresSolutionByQr) {
  const Problem p = random_problem(2000);
  const Eigen::VectorXd root = p.weight.cwiseSqrt();
  const Eigen::VectorXd expected = (root.asDiagonal() * p.jacobian)
                                       .colPivHouseholderQr()
                                       .solve(-(root.asDiagonal() * p.residual));
  const NormalEquations<6> equations = accumulated(p, 1);
  EXPECT_LT((equations.solve() - expected).norm(), 1e-12);  // condition about 1, 2000 roundings
  EXPECT_EQ(equations.count, 2000U);
  EXPECT_NEAR(equations.cost, 0.5 * p.weight.dot(p.residual.cwiseAbs2()), 1e-9);
}

TEST(NormalEquations, SumsAreTheSameBitsOnAnyNumberOfThreads) {
  const Problem p = random_problem(5001);
  const NormalEquations<6> one = accumulated(p, 1);
  for (const int threads : {2, 3, 5}) {
    const NormalEquations<6> many = accumulated(p, threads);
    EXPECT_EQ(one.hessian, many.hessian);
    EXPECT_EQ(one.gradient, many.gradient);
    EXPECT_EQ(one.cost, many.cost);
  }
}

TEST(NormalEquations, WithoutResidualsTheStepIsZero) {
  EXPECT_EQ(NormalEquations<6>{}.solve(), (Eigen::Matrix<double, 6, 1>::Zero()));
}

}  // namespace
}  // namespace lidarena::estimation
