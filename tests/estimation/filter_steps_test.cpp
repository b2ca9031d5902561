// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/estimation/filter_steps.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/so3.hpp"
#include "tests/estimation/random_vector.hpp"

namespace lidarena::estimation {
namespace {

using State = InertialState;

struct Chain {
  std::vector<FilterStep> steps;
  StateEstimate end;
};

/// Predictions through samples of an IMU that turns and accelerates, from an uncertain state.
Chain predictions(std::size_t count) {
  SequentialRandom random(5, 1);
  StateEstimate estimate;
  estimate.state.rotation() = so3::exp(random_vector(random, 1.0));
  estimate.state.nav.velocity = random_vector(random, 2.0);
  State::Matrix root = State::Matrix::Zero();
  for (int i = 0; i < State::kDof; ++i)
    for (int j = 0; j <= i; ++j) root(i, j) = (i == j ? 0.1 : 0.01) * (1.0 + random.normal());
  estimate.covariance = root * root.transpose();
  Chain chain;
  for (std::size_t i = 0; i < count; ++i) {
    FilterStep step{estimate, {}};
    step.transition = propagate(estimate.state, random_vector(random, 1.0),
                                random_vector(random, 5.0), 0.01, Integration::kSecondOrder);
    estimate.covariance = step.transition * estimate.covariance * step.transition.transpose() +
                          step_noise({.gyro_density = 0.1, .accel_density = 1.0}, 0.01);
    step.predicted = estimate;
    chain.steps.push_back(step);
  }
  chain.end = estimate;
  return chain;
}

TEST(FilterSteps, WithoutNewsTheFilterStaysAsItIs) {
  const Chain chain = predictions(5);
  const std::vector<State> states = smoothed(chain.steps, chain.end.state);
  ASSERT_EQ(states.size(), 5U);
  for (std::size_t i = 0; i < states.size(); ++i)
    EXPECT_LT(minus(states[i], chain.steps[i].before.state).norm(), 1e-12);
}

TEST(FilterSteps, NewsAreSharedAsInTheJointDistributionOfAllErrors) {
  // To first order E[e_i | e_n] = Cov(e_i, e_n) Cov(e_n)^-1 e_n, with Cov(e_i, e_n) = P_i Phi^T and
  // Phi the product of the transitions from i to n.
  const Chain chain = predictions(8);
  SequentialRandom random(6, 1);
  State::Vector news;
  for (int i = 0; i < State::kDof; ++i) news[i] = 1e-6 * random.normal();
  const std::vector<State> states = smoothed(chain.steps, plus(chain.end.state, news));
  State::Matrix from_step = State::Matrix::Identity();
  for (std::size_t i = chain.steps.size(); i-- > 0;) {
    from_step = from_step * chain.steps[i].transition;
    const State::Vector expected = chain.steps[i].before.covariance * from_step.transpose() *
                                   chain.end.covariance.ldlt().solve(news);
    EXPECT_LT((minus(states[i], chain.steps[i].before.state) - expected).norm(),
              1e-3 * expected.norm());
  }
}

}  // namespace
}  // namespace lidarena::estimation
