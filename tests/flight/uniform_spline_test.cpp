// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/uniform_spline.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/base/random.hpp"
#include "lidarena/flight/spline_fit.hpp"

namespace lidarena::flight {
namespace {

using Spline = UniformSpline<6, 1>;
using Controls = std::vector<Spline::Value>;

Controls sampled(double (*f)(double), double knot, std::size_t count) {
  Controls controls;
  for (std::size_t j = 0; j < count; ++j) {
    controls.emplace_back(f(Spline::center(j, knot)));
  }
  return controls;
}

/// Basis function by the Cox-de Boor recursion, with knots at the integers.
double basis(int degree, int first, double x) {
  if (degree == 0) return first <= x && x < first + 1 ? 1.0 : 0.0;
  return (x - first) / degree * basis(degree - 1, first, x) +
         (first + degree + 1 - x) / degree * basis(degree - 1, first + 1, x);
}

TEST(UniformSpline, IsTheSumOfControlPointsTimesBasisFunctions) {
  SequentialRandom random(7);
  Controls controls;
  for (int j = 0; j < 12; ++j) controls.emplace_back(random.normal());
  const double knot = 0.3;
  const Spline spline(controls, knot);
  for (double x = 0.0; x < static_cast<double>(spline.intervals()); x += 0.037) {
    double expected = 0.0;
    for (int j = 0; j < 12; ++j) {
      expected += controls[static_cast<std::size_t>(j)][0] * basis(6, j - 6, x);
    }
    EXPECT_NEAR(spline.derivative<0>(spline.find(x * knot))[0], expected, 1e-14);
  }
}

TEST(UniformSpline, ReproducesALineAndItsSlopeExactly) {
  const double knot = 0.25;
  const Spline spline(sampled([](double t) { return 2.0 - 3.0 * t; }, knot, 20), knot);
  for (double t = 0.0; t < 3.5; t += 0.01) {
    const auto at = spline.find(t);
    EXPECT_NEAR(spline.derivative<0>(at)[0], 2.0 - 3.0 * t, 1e-13);
    EXPECT_NEAR(spline.derivative<1>(at)[0], -3.0, 1e-12);
    EXPECT_NEAR(spline.derivative<2>(at)[0], 0.0, 1e-11);
  }
}

TEST(UniformSpline, ShiftsAParabolaByHalfItsSecondDerivativeTimesTheVarianceOfTheWeights) {
  const double knot = 0.25;
  const Spline spline(sampled([](double t) { return t * t; }, knot, 20), knot);
  for (double t = 0.0; t < 3.5; t += 0.01) {
    const auto at = spline.find(t);
    EXPECT_NEAR(spline.derivative<0>(at)[0] - t * t, Spline::kVariance * knot * knot, 1e-13);
    EXPECT_NEAR(spline.derivative<2>(at)[0], 2.0, 1e-11);
  }
}

TEST(UniformSpline, AllDerivativesUpToTheFifthAreContinuousAcrossKnots) {
  SequentialRandom random(3);
  Controls controls;
  for (int j = 0; j < 16; ++j) controls.emplace_back(random.normal());
  const Spline spline(controls, 1.0);
  for (std::size_t k = 1; k < spline.intervals(); ++k) {
    const auto right = spline.find(static_cast<double>(k));
    Spline::Place left{right.piece - 1, 1.0};
    EXPECT_NEAR(spline.derivative<0>(left)[0], spline.derivative<0>(right)[0], 1e-13);
    EXPECT_NEAR(spline.derivative<1>(left)[0], spline.derivative<1>(right)[0], 1e-12);
    EXPECT_NEAR(spline.derivative<2>(left)[0], spline.derivative<2>(right)[0], 1e-12);
    EXPECT_NEAR(spline.derivative<3>(left)[0], spline.derivative<3>(right)[0], 1e-11);
    EXPECT_NEAR(spline.derivative<4>(left)[0], spline.derivative<4>(right)[0], 1e-11);
    EXPECT_NEAR(spline.derivative<5>(left)[0], spline.derivative<5>(right)[0], 1e-10);
  }
}

/// Maximum distance between a function and the spline fitted to its samples.
double fit_error(double (*f)(double), double knot) {
  const auto count = static_cast<std::size_t>(3.0 / knot) + 6;
  Controls samples;
  for (std::size_t i = 0; i < count + 2 * kFitReach; ++i) {
    samples.emplace_back(f(Spline::center(i, knot) - static_cast<double>(kFitReach) * knot));
  }
  const Spline spline(controls_through<6>(samples), knot);
  double most = 0.0;
  for (double t = 0.0; t < 2.9; t += 0.0037) {
    most = std::max(most, std::abs(spline.derivative<0>(spline.find(t))[0] - f(t)));
  }
  return most;
}

TEST(SplineFit, ReproducesPolynomialsUpToItsDegree) {
  EXPECT_LT(fit_error([](double t) { return std::pow(t - 1.5, 6) - std::pow(t, 5) + t; }, 0.25),
            1e-11);
  EXPECT_GT(fit_error([](double t) { return std::pow(t - 1.5, 7); }, 0.25), 1e-8);
}

TEST(SplineFit, ErrsByTheSeventhPowerOfTheKnot) {
  const auto wave = [](double t) { return std::sin(4.0 * t + 0.3); };
  const double ratio = fit_error(wave, 0.1) / fit_error(wave, 0.05);
  EXPECT_GT(ratio, 110.0);
  EXPECT_LT(ratio, 260.0);  // between 2^7 and 2^8: the leading term is zero at the centers
}

TEST(UniformSpline, HoldsItsEnds) {
  const Spline spline(sampled([](double t) { return std::sin(t); }, 0.5, 12), 0.5);
  const double end = 0.5 * static_cast<double>(spline.intervals());
  EXPECT_EQ(spline.derivative<0>(spline.find(-1.0)), spline.derivative<0>(spline.find(0.0)));
  EXPECT_EQ(spline.derivative<0>(spline.find(end + 9.0)), spline.derivative<0>(spline.find(end)));
}

}  // namespace
}  // namespace lidarena::flight
